"""Whether the data sets of several radars are of the same scenes."""

import numpy as np

from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.scene_fields import ASPECT

OF_PEOPLE = ("subject.", "motion.", "timing.", "classes.", "people.")


def differing_columns(first: Dataset, other: Dataset) -> list[str]:
    """Names of columns that two radars of the same scenes should have alike and do not.

    These are classes, samples, splits, and the columns of /scene of people and their room.
    """
    names = ("sample_key", "label", "split", "labels", "person_label")
    pairs = {name: (getattr(first, name), getattr(other, name)) for name in names}
    keys = [{field.key: field.name for field in data.fields} for data in (first, other)]
    common = [
        key
        for key in keys[0]
        if key in keys[1] and key.startswith(OF_PEOPLE) and not key.endswith(ASPECT.key)
    ]
    pairs |= {
        f"scene/{keys[0][key]}": (first.scene[keys[0][key]], other.scene[keys[1][key]])
        for key in common
    }
    if "subject" in first.scene and "subject" in other.scene:
        pairs["scene/subject"] = first.scene["subject"], other.scene["subject"]
    return ["classes"] * (first.classes != other.classes) + [
        name for name, (a, b) in pairs.items() if not _equal(a, b)
    ]


def _equal(a: object, b: object) -> bool:
    """Whether two columns, or nothing, are equal; NaN equals NaN."""
    if a is None or b is None:
        return a is b
    x, y = (np.asarray(one[:]) for one in (a, b))  # type: ignore[index]
    return x.shape == y.shape and np.array_equal(x, y, equal_nan=x.dtype.kind == "f")
