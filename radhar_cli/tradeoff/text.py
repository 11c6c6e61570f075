"""tradeoff.md: conditions and tables."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import inf
from typing import Any

Record = Mapping[str, Any]
Column = tuple[str, Callable[[Record], str]]
ENGINES = ("budget", "precision", "engine")


def markdown(
    title: str,
    command: str,
    figure: str,
    records: Sequence[Record],
    conditions: Mapping[str, Any],
) -> str:
    """The whole report."""
    parts = [
        f"# What accuracy costs: {title}",
        f"`{command}`",
        f"![time against error]({figure})",
        _conditions(conditions),
        "## Engine, budget, precision",
        _table(_ENGINE, (one for one in records if one["group"] in ENGINES)),
        "## Physics and transforms that are left out",
        "Time is that of the switch on; errors are those of data without it against data with it. "
        "Noise corner and interference line are added to the config's noise, on both sides.",
        _table(_SWITCH, (one for one in records if one["group"] == "switch")),
        "## Image size and kind of map",
        "Images of another size are resized to the config's before they are compared.",
        _table(
            _IMAGE, (one for one in records if one["group"] in ("image size", "image kind", "map"))
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _conditions(conditions: Mapping[str, Any]) -> str:
    count = conditions["scenes"]
    scenes = "1 scene" if count == 1 else f"{count} scenes, one an activity,"
    return (
        f"{scenes} drawn from the config; errors without "
        "noise against the exact cube in float64, the worst scene's unless it says median. Times "
        f"of one process, {conditions['rounds']} rounds interleaved; ratios to the default (or "
        "what is named) on the same scenes in the same moment, with quartiles. A sample is "
        "everything from the scene to levels and entropy; its echo is paths and slow-time signal "
        "alone."
    )


def _number(name: str, digits: int) -> Callable[[Record], str]:
    def text(one: Record) -> str:
        value = one[name]
        if value is None:
            return ""
        return "exact" if value == -inf else f"{value:.{digits}f}"

    return text


def _share(one: Record) -> str:
    value = one["pixels_changed"]
    return "" if value is None else f"{100 * value:.3g} %"


def _ratio(name: str) -> Callable[[Record], str]:
    def text(one: Record) -> str:
        if one[name] is None:
            return "refused"
        return f"{one[name]:.2f} ({one[name + '_low']:.2f} to {one[name + '_high']:.2f})"

    return text


_SAMPLE = ("sample ms", _number("sample_ms", 1))
_TIME = ("time", _ratio("time_ratio"))
_CHANGED = ("pixels changed", _share)
_ENGINE: tuple[Column, ...] = (
    ("setting", lambda one: one["setting"] + (" (default)" if one["default"] else "")),
    _SAMPLE,
    _TIME,
    ("echo time", _ratio("echo_ratio")),
    ("signal error dB", _number("signal_error_db", 1)),
    ("median dB", _number("signal_error_median_db", 1)),
    ("measured dB", _number("measured_error_db", 1)),
    ("map error dB", _number("map_error_db", 4)),
    ("SSIM", _number("ssim", 6)),
    _CHANGED,
)
_SWITCH: tuple[Column, ...] = (
    ("switch", lambda one: str(one["setting"])),
    _TIME,
    ("over that of", lambda one: str(one["time_over"])),
    ("signal dB, median", _number("signal_error_median_db", 1)),
    ("worst", _number("signal_error_db", 1)),
    ("map dB", _number("map_error_db", 2)),
    ("SSIM", _number("ssim", 4)),
    ("PSNR dB", _number("psnr_db", 1)),
    _CHANGED,
)
_IMAGE: tuple[Column, ...] = (
    ("group", lambda one: str(one["group"])),
    ("setting", lambda one: str(one["setting"])),
    _SAMPLE,
    _TIME,
    ("SSIM", _number("ssim", 6)),
    ("PSNR dB", _number("psnr_db", 1)),
    _CHANGED,
)


def _table(columns: Sequence[Column], records: Iterable[Record]) -> str:
    rows = ([text(one) for _, text in columns] for one in records)
    lines = [[name for name, _ in columns], ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
