"""The Glasgow set: six activities of people in front of an FMCW radar at 5.8 GHz.

Files are named `KPppAaaRrr.dat`: activity K, person, activity once more, repetition; case and
zeros vary. The same number in two campaigns counts as one person, even if
there were two, and is in one part of a split.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from radhar_cli.capture.importing import import_capture
from radhar_cli.capture.recipes.recipe import (
    BY_PERSON,
    NoSettings,
    SetRecipe,
    Take,
    as_name,
    find_files,
)
from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.settings import CaptureSettings

ACTIVITIES = ("walking", "sitting_down", "standing_up", "picking_up", "drinking", "falling")


def list_takes(folder: Path, settings: NoSettings) -> Iterator[Take]:
    """List a take for each file, whose name tells activity and person."""
    for file in find_files(folder, r"([1-6])P(\d+)A(\d+)R(\d+)\.dat"):
        first, person, second = (int(number) for number in file.match.groups()[:3])
        name = as_name(str(Path(file.inner).with_suffix("")))
        write = partial(write_take, file.path, first, second, f"P{person:02d}")
        yield Take(name, (file.path,), write)


def write_take(path: Path, first: int, second: int, person: str, out: Path) -> None:
    """Import a file.

    Raises:
        CaptureError: its name says two activities, or it is damaged.
    """
    if first != second:
        raise CaptureError(f"{path.name}: names activity {first} and activity {second}")
    import_capture([path], out, CaptureSettings(label=ACTIVITIES[first - 1], person=person))


RECIPE = SetRecipe(
    source="Radar signatures of human activities, University of Glasgow, "
    "doi 10.5525/gla.researchdata.848",
    licence="cc-by-4.0",
    holds="17 GB, 6 activities, some 70 persons in 7 campaigns",
    tested="files written by this layout",
    layout="1P36A01R01.dat, in folders of campaigns or not",
    list_takes=list_takes,
    config={
        "maps": ["rtm", "stft"],
        "recordings": {"window_s": 5.0, "hop_s": 5.0},
        "processing": {
            "clutter": "highpass",
            "highpass": {"order": 4, "cutoff_hz": 3.75, "remove_mean": False},
            "range_window": "rectangular",
            "range_sum": "gated",
            "gate_m": [3.75, 11.25],
            "gate_sum": "magnitude",
            "window_s": 0.2,
            "overlap_fraction": 0.95,
            "stft_fft_length": 800,
        },
        "image": {"kind": "cfar", "size_px": 256},
        "split": BY_PERSON,
    },
    count=1754,
)
