"""Lines above the numbers of a table: names of joints and axes in one line, or in several.

Tables of spreadsheets and of data frames name a column `nose_x`. Vicon, OptiTrack, Theia,
DeepLabCut and Visual3D have names of joints in one line and X, Y, Z below them; Qualisys has
MARKER_NAMES and no axes. What else stands above says the rate and the unit.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from radhar_cli.files.clocks import TIME_WORDS
from radhar_cli.motion.recorded.image_landmarks import two_dimensional
from radhar_cli.motion.recorded.recording import MAX_JOINTS, RATES, motion_file_error
from radhar_cli.readers.text_table import LOST, TextTable, is_number

MOST_LINES = 60  # above the numbers
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "inches": 0.0254}
UNITS |= {"meters": 1.0, "metres": 1.0, "centimeters": 0.01, "millimeters": 0.001}
_UNIT_LAST = re.compile(r"[ _]*[(\[]?(?<![a-z])(?P<unit>mm|cm|m)[)\]]?$", re.I)
_AXIS_LAST = re.compile(
    r"^(?P<name>.+?)(?:[ _.:\-]*(?:position|pos|location|translation))?"
    r"[ _.:\-\[(]*(?P<axis>[xyz])[\])]?(?:[ _]?[(\[]?(?:mm|cm|m)[)\]]?)?$",
    re.I,
)
_CONFIDENCE = re.compile(
    r"^(?P<name>.+?)[ _.:\-\[(]*(?:visibility|vis|confidence|conf|likelihood|score|v|c"
    r"|trackingstate|tracking_state|state|tracked)[\])]?$",
    re.I,
)
_AXIS_FIRST = re.compile(r"^(?P<axis>[xyz])[ _.:\-]*(?P<name>.+)$", re.I)
_AXIS_ALONE = re.compile(
    r"^(?:(?P<axis>[xyz])\d*|[tr](?P<turn>[xyz]))(?:[ _]?[(\[]?(?:mm|cm|m)[)\]]?)?$", re.I
)
_TIME = re.compile(
    r"^(?:(?:sensor|unix|frame|video|elapsed|device)?[ _]?time(?:s|[ _]?stamps?)?|elapsed|date"
    r"|datetime|date[ _]time|t|sec|secs|seconds)"
    r"(?:[ _(\[]*(?:(?P<unit>s|ms|us|µs|ns|usec|msec|milliseconds|microseconds)|sec|secs|seconds)"
    r"[)\]]?)?$",
    re.I,
)
_RATE = re.compile(
    r"(?:export|capture|camera|data)?[ _]*(?:frame[ _]*rate|fps|frequency|sampl(?:e|ing)[ _]*"
    r"(?:rate|frequency)|data[ _]*rate|^rate)(?:[ _(\[]*hz[)\]]?)?[\s:=,;\t\"]+"
    r"(?P<rate>\d+(?:\.\d+)?)",
    re.I,
)
_LENGTH_UNIT = re.compile(
    r"(?:length[ _]*)?units?[\s:=,;\t\"]+(?P<unit>millimeters|centimeters|met(?:er|re)s|mm|cm|m)\b",
    re.I,
)
_NAME_ROWS = ("name", "markername", "markernames", "bodyparts", "bodypart", "joint", "joints")
_TURNS = frozenset({"rotation", "quaternion", "orientation", "velocity", "acceleration", "error"})
_TURNS |= frozenset({"meanmarkererror", "markerquality", "residual", "linearvelocity"})


class Heading(NamedTuple):
    """Names, places of joints, rate and unit above the numbers of a table of a row a frame."""

    begin: int  # row of the first numbers
    names: list[str] | None
    places: list[tuple[int, int, int]]  # columns x, y, z of each joint
    time: int | None = None  # column
    time_unit: str | None = None
    confidences: Sequence[int | None] = ()  # columns of which 0 is a lost joint
    unit: float | None = None  # m
    rate: float | None = None  # frames per second
    width: int | None = None  # cells that a row must have


def find_heading(table: TextTable) -> Heading | None:
    """Find names of joints and axes above the numbers of a table.

    Args:
        table: Rows of cells.

    Returns:
        None where the first line has numbers already.

    Raises:
        MotionFileError: No joint has x, y and z.
    """
    lines = [n for n, row in enumerate(table.rows[:MOST_LINES]) if _is_filled(row)]
    first = lines[0] if lines else 0
    axes = next((n for n in lines[1:] if _has_axes(table.rows[n])), None)
    for number in lines:
        row = table.rows[number]
        if number == axes:
            return _of_axes(table, number)
        # Numbers of bones, as OptiTrack has them, are above the axes.
        if _is_numeric(row) and sum(map(bool, map(str.strip, row))) > 3 and axes is None:
            return None if number == first else _above_numbers(table, number)
        if _joints_of_names(row)[0]:
            return _of_names(table, number)
    row = table.rows[first]
    _refuse_pixels([_clean(cell) for cell in row], table.where)
    raise motion_file_error(
        table.place(first),
        "should name its columns, such as time, nose_x, nose_y, nose_z; it has "
        + ", ".join(name[:20] for name in row[:8]),
    )


def rate_above(table: TextTable, begin: int) -> float | None:
    """Frames per second that lines above a row say; None where none does."""
    lines = [" , ".join(cell.strip() for cell in row) for row in table.rows[:begin]]
    matches = [match for line in lines for match in _RATE.finditer(line)]
    matches.sort(key=lambda match: "export" not in match[0].lower())
    for match in matches:
        if RATES[0] <= float(match["rate"]) <= RATES[1]:
            return float(match["rate"])
    for row, following in zip(table.rows[:begin], table.rows[1:begin], strict=False):
        words = [cell.strip() for cell in following if cell.strip()]
        if [cell.strip().lower() for cell in row if cell.strip()] == ["trajectories"] and words:
            return float(words[0]) if is_number(words[0]) else None
    return None


def unit_above(table: TextTable, begin: int) -> float | None:
    """Length of a unit that lines above a row say, m; None where none does."""
    for row in table.rows[:begin]:
        match = _LENGTH_UNIT.search(" , ".join(cell.strip() for cell in row))
        if match:
            return UNITS[match["unit"].lower().replace("metre", "meter")]
        units = {cell.strip(" ()[]").lower() for cell in row} & {"m", "cm", "mm"}
        words = [cell for cell in row if cell.strip()]
        if len(units) == 1 and len(words) > 5 and _are_units(row):
            return UNITS[units.pop()]
    return None


def find_time(names: Sequence[str]) -> tuple[int | None, str | None]:
    """Column of the instants of a line of names, and their unit where it is named."""
    time, unit = None, None
    for number, name in enumerate(names):
        match = _TIME.match(name)
        if match:
            time, unit = number, match["unit"] and match["unit"].lower()
    return time, TIME_WORDS.get(unit or "")


def _clean(cell: str) -> str:
    return cell.strip().lstrip("\ufeff")


def _is_filled(row: Sequence[str]) -> bool:
    """Whether a row is neither empty nor a comment."""
    return any(cell.strip() for cell in row) and not row[0].startswith(("#", "%"))


def _is_numeric(row: Sequence[str]) -> bool:
    """Whether the cells of a row are numbers, but for lost ones and an instant."""
    words = [cell.strip() for cell in row]
    is_text = [not is_number(word) and word.lower() not in LOST for word in words]
    return any(map(is_number, words)) and sum(is_text) <= 1 and not any(is_text[2:])


def _are_units(row: Sequence[str]) -> bool:
    """Whether a row has units of length alone."""
    words = [cell.strip(" ()[]").lower() for cell in row if cell.strip()]
    return bool(words) and sum(word in UNITS for word in words) > 0.8 * len(words)


def _has_axes(row: Sequence[str]) -> bool:
    """Whether a row has the axes of several joints: X, Y, Z, X, Y, Z."""
    return sum(bool(_AXIS_ALONE.match(_clean(cell))) for cell in row) > 3


def _above_numbers(table: TextTable, begin: int) -> Heading:
    """Heading of numbers below a line of names without axes, as Qualisys writes them.

    Raises:
        MotionFileError: No line above has as many names as there are joints.
    """
    width = len(_trim(table.rows[begin]))
    for row in filter(None, reversed(table.rows[:begin])):
        label, *names = [_clean(cell) for cell in row]
        names = [name for name in names if name]
        plain = re.sub(r"[^a-z]", "", label.lower())
        if plain in ("markernames", "names", "markers", "joints") and width >= 3 * len(names) > 0:
            before = width - 3 * len(names)
            places = [
                (before + 3 * n, before + 3 * n + 1, before + 3 * n + 2) for n in range(len(names))
            ]
            return Heading(
                begin,
                names,
                places,
                1 if before == 2 else None,
                unit=unit_above(table, begin),
                rate=rate_above(table, begin),
            )
    raise motion_file_error(
        table.place(begin),
        "has numbers; a line above them should name the columns, such as nose_x, nose_y, nose_z",
    )


def _trim(row: Sequence[str]) -> list[str]:
    """Cells of a row without the empty ones at its end."""
    cells = [*row]
    while cells and not cells[-1].strip():
        cells.pop()
    return cells


def _joints_of_names(
    row: Sequence[str],
) -> tuple[dict[str, dict[str, int]], dict[str, dict[str, int]]]:
    """Columns {name: {axis: column}} of the joints of a line of names: complete ones, and all."""
    parts: dict[str, dict[str, int]] = {}
    for number, cell in enumerate(row):
        name = _clean(cell)
        if _TIME.match(name):
            continue
        match = _AXIS_LAST.match(name) or _AXIS_FIRST.match(name)
        if match and match["name"].strip(" _.:-"):
            joint = match["name"].strip(" _.:-")
            parts.setdefault(joint, {}).setdefault(match["axis"].lower(), number)
    return {name: axes for name, axes in parts.items() if set(axes) == set("xyz")}, parts


def _refuse_pixels(names: Sequence[str], where: str) -> None:
    """Refuse columns that have x and y of a joint, but no z."""
    complete, parts = _joints_of_names(names)
    pairs = [name for name, axes in parts.items() if {"x", "y"} <= set(axes)]
    if pairs and not complete:
        raise motion_file_error(where, two_dimensional(f"{pairs[0][:30]} has x and y, but no z"))


def _of_names(table: TextTable, number: int) -> Heading:
    """Heading of columns that are named by joint and axis in one line."""
    names = [_clean(cell) for cell in table.rows[number]]
    complete, _ = _joints_of_names(names)
    _require_joints(complete, table.where)
    time, time_unit = find_time(names)
    matches = [(n, _CONFIDENCE.match(name)) for n, name in enumerate(names)]
    confidences = {m["name"].strip(" _.:-"): n for n, m in matches if m}
    units = [_UNIT_LAST.search(names[axes["x"]]) for axes in complete.values()]
    is_same = len({unit and unit["unit"].lower() for unit in units}) == 1
    unit = units[0] if is_same else None
    has_units = number + 1 < len(table.rows) and _are_units(table.rows[number + 1])
    begin = number + 1 + has_units
    return Heading(
        begin,
        None if all(name.isdigit() for name in complete) else [*complete],
        [(axes["x"], axes["y"], axes["z"]) for axes in complete.values()],
        time,
        time_unit,
        [confidences.get(name) for name in complete],
        UNITS[unit["unit"].lower()] if unit else unit_above(table, begin),
        rate_above(table, number),
        len(names),
    )


def _require_joints(joints: Mapping[str, object], where: str) -> None:
    """Refuse more joints than a recording may have."""
    if len(joints) > MAX_JOINTS:
        raise motion_file_error(where, f"has {len(joints)} joints; should have 1 to {MAX_JOINTS}")


def _of_axes(table: TextTable, number: int) -> Heading:
    """Heading of a line of axes, above which a line names the joints."""
    axes = [_AXIS_ALONE.match(_clean(cell)) for cell in table.rows[number]]
    above = [table.rows[n] for n in range(number) if _is_filled(table.rows[n])]
    turned = {column for row in above for column in _columns_of_turns(row)}
    letters = [
        "" if match is None or column in turned else (match["axis"] or "").lower()
        for column, match in enumerate(axes)
    ]
    starts = [n for n in range(len(letters) - 2) if letters[n : n + 3] == ["x", "y", "z"]]
    if not starts:
        raise motion_file_error(table.where, two_dimensional("columns are X and Y, without Z"))
    names = _name_joints(above, starts, table, number)
    columns: dict[str, tuple[int, int, int]] = {}
    for start, name in zip(starts, names, strict=True):
        columns.setdefault(name, (start, start + 1, start + 2))
    _require_joints(columns, table.where)
    begin = number + 1
    while begin < len(table.rows) and (
        not _is_filled(table.rows[begin]) or _are_units(table.rows[begin])
    ):
        begin += 1
    headings = [_clean(cell) for cell in table.rows[number]]
    time, time_unit = find_time(headings[: starts[0]])
    confidences = [
        start + 3
        if headings[start + 3 : start + 4] and _is_confidence(headings[start + 3])
        else None
        for start, *_ in columns.values()
    ]
    return Heading(
        begin,
        [*columns],
        [*columns.values()],
        time,
        time_unit,
        confidences,
        unit_above(table, begin),
        rate_above(table, number),
    )


def _is_confidence(heading: str) -> bool:
    """Whether a column is a confidence by its own name."""
    return bool(_CONFIDENCE.match(f"joint_{heading}")) and len(heading) > 1


def _columns_of_turns(row: Sequence[str]) -> list[int]:
    """Columns that a line calls rotations or errors; an empty cell is called as the one before."""
    word, columns = "", []
    for column, cell in enumerate(row):
        word = re.sub(r"[^a-z]", "", cell.lower()) or word
        if word in _TURNS:
            columns.append(column)
    return columns if len(columns) > 3 else []


def _name_joints(
    above: Sequence[Sequence[str]], starts: Sequence[int], table: TextTable, number: int
) -> list[str]:
    """Names of the joints whose axes begin at some columns.

    A line that calls itself names comes first, then the one of the most different words.

    Raises:
        MotionFileError: No line above has a name for each.
    """
    best: tuple[int, list[str]] = (1, [])
    for row in above:
        cells = [_clean(cell) for cell in row]
        names = [next((cell for cell in reversed(cells[: n + 1]) if cell), "") for n in starts]
        if any(not name or is_number(name) for name in names):
            continue
        label = next((cell for cell in cells[: starts[0]] if cell), "")
        is_labelled = re.sub(r"[^a-z]", "", label.lower()) in _NAME_ROWS
        best = max(best, (1000 * is_labelled + len({*names}), names), key=lambda pair: pair[0])
    if not best[1]:
        raise motion_file_error(
            table.place(number), "has X, Y, Z; a line above should name the joint of each three"
        )
    return best[1]
