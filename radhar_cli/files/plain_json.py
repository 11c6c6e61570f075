"""Values as JSON can hold them."""

import math
from pathlib import Path


def plain(value: object) -> object:
    """Convert a value to types that JSON has: tuples to lists, paths to text, NaN and inf to null.

    Mappings and sequences are converted to any depth, their keys to text; other types are kept.
    """
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value
