"""Arrays in half of their bytes, where nothing of them is lost."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

# Largest numbers between which values 150 dB and more below the largest keep their digits.
LEAST, MOST = float(np.finfo(np.float32).tiny) * 1e15, float(np.finfo(np.float32).max)


def in_single(values: NDArray[Any]) -> NDArray[Any]:
    """Convert values to float32 or complex64, unless the largest lies beyond LEAST or MOST."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest > 0 and not LEAST <= largest <= MOST:
        return values
    return values.astype(np.complex64 if np.iscomplexobj(values) else np.float32)
