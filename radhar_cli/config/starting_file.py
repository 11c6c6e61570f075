"""A config to start from, out of the schema: every key, its default, and its meaning."""

import inspect
import json
import os
import re
from collections.abc import Collection, Iterator
from contextlib import suppress
from decimal import Decimal
from itertools import takewhile
from pathlib import Path
from textwrap import wrap
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError

from radhar_cli.config.built_in_radars import device_of
from radhar_cli.config.data_set import Config
from radhar_cli.config.documents import (
    BASE,
    PRESETS,
    cfg_text,
    find_preset,
    name_of_radar,
    name_of_written,
    read_on_bases,
)
from radhar_cli.config.identity import yaml_text
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.detection import Chain
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_cfg import BoardHeader, parse_ti_cfg
from radhar_cli.readers.ti.ti_elements import fitting_devices
from radhar_cli.readers.ti.ti_l_sdk import IWRL6844
from radhar_cli.schema.annotations import ByModel, annotations, section
from radhar_cli.schema.section import Section

WIDTH = 100
PEOPLE_CHAINS = "people_tracking", "people_counting"
MAPS_OF_BOARDS = ("stft", "range_doppler", "range_azimuth", "points")
# Boards by the platform that TI's visualizer names in a comment of its .cfg.
PLATFORMS = {
    "xwr14xx": "IWR1443BOOST",
    "xwr16xx": "IWR1642BOOST",
    "xwr18xx": "IWR1843BOOST",
    "xwr68xx": "IWR6843ISK",
    "xwr68xx_aop": "IWR6843AOP",
}
HEAD = """\
# Every key with its default, which holds too where a key is left out; `base: other.yaml` takes
# what is left out from another file.
"""
NUMBERS = """\
# A number of a scene may be drawn: {uniform: [low, high]}, {normal: [mean, sd], min: a, max: b},
# {choice: [a, b]}, {vary: [nominal, fraction]}; under motion and timing it may also differ:
# {per_activity: {default: 2, walking: 1}}.
"""
MINIMAL = """\
# A short config, ready for `radhar generate`; `radhar config init FILE` writes one with every key.
seed: 1                                   # same config, seed and versions: same bytes
samples_per_class: 20
activities: [walking, punching, sitting_down, walking_to_falling]  # all: the twelve
duration_s: 6
radar:
  carrier_hz: 24e9
  bandwidth_hz: 1e9                       # range resolution c/2B: 0.15 m
  prf_hz: 3500                            # radial speeds up to +-10.7 m/s
subject:
  height_m: {uniform: [1.5, 1.9]}         # drawn for each sample; any number may be
snr_db: {choice: [30, 20, 10]}
maps: [rtm, stft]                         # range-time map, Doppler-time map
image: {size_px: 128, dynamic_range_db: 50}
split: {train: 0.7, validation: 0.15, test: 0.15}
"""


def as_commented_yaml(kind: type[Section]) -> str:
    """Write the text of a config file with every key, its default and its description.

    It reads back as `kind()`.
    """
    head = HEAD + (NUMBERS if kind is Config else "")
    return re.sub("\n{3,}", "\n\n", "\n".join((head, *_lines(kind), "")))


def _lines(kind: type[Section], left_out: Collection[str] = ()) -> Iterator[str]:
    plain = {name: field.default for name, field in kind.model_fields.items()}
    defaults = plain | kind.model_construct().model_dump(mode="json")  # nothing filled in for null
    descriptions, about = kind.descriptions(), annotations(kind)
    for name, field in kind.model_fields.items():
        if field.exclude or name in left_out:
            continue
        if field.is_required():
            yield from _comment_lines(f"{descriptions.get(name, '')} Required.")
            yield f"{name}:"
            continue
        members = [field.annotation, *get_args(field.annotation)]
        inner = section(field)
        value, comment = defaults[name], _comment(members, descriptions.get(name, ""))
        comment = f"{comment} {_by_model(about[name])}".strip()
        if inner is None or not (value is None or isinstance(value, dict)):
            yield from _key(name, value, comment)
            continue
        assert issubclass(inner, Section)
        yield ""
        yield from _comment_lines((inspect.getdoc(inner) or "").partition("\n\n")[0])
        mark = ""
        if value is None:
            yield from _key(name, value, f"{comment} Or, instead of this line:")
            mark = "# "
        yield f"{mark}{name}:"
        yield from (f"{mark}  {line}" for line in _lines(inner) if line)
        yield from _alternatives(name, inner)
        yield ""


def _by_model(about: tuple[Any, ...]) -> str:
    """Describe null by each model of motion; "" where no plain default depends on it."""
    values = next((one.values for one in about if isinstance(one, ByModel)), {})
    plain = {model: as_text(value) for model, value in values.items() if _is_plain(value)}
    if not plain or len(plain) < len(values):
        return ""
    return f"null is {', '.join(f'{value} ({model})' for model, value in plain.items())}."


def _is_plain(value: object) -> bool:
    return isinstance(value, str | int | float)


def _alternatives(name: str, kind: type[Section]) -> Iterator[str]:
    """Lines, all of them comments, of other sections that may stand in the place of one."""
    common = set(kind.model_fields) - {"waveform"}
    for other in kind.ALTERNATIVES:
        dropped = sorted(common - set(other.model_fields))
        text = (inspect.getdoc(other) or "").partition("\n\n")[0]
        yield from _comment_lines(f"Or: {text} It has no {', '.join(dropped)}.")
        yield f"# {name}:"
        yield from (f"#   {line}" for line in _lines(other, common) if line)


def _comment(members: list[Any], description: str) -> str:
    choices = [get_args(one) for one in members if get_origin(one) is Literal]
    if get_origin(members[0]) is tuple or sum(map(len, choices)) < 2:
        return description
    values = " | ".join(as_text(value) for one in choices for value in one)
    return f"{values}. {description}".strip()


def _comment_lines(text: str) -> Iterator[str]:
    return (f"# {line}" for line in wrap(text, WIDTH - 8, break_on_hyphens=False))


def _key(name: str, value: object, comment: str) -> Iterator[str]:
    line = f"{name}: {as_text(value)}"
    if comment and len(line) + len(comment) + 8 > WIDTH:
        yield from _comment_lines(comment)
        comment = ""
    yield f"{line}  # {comment}" if comment else line


def as_text(value: object) -> str:
    """Return a value as YAML, on a line; numbers as engineers write them, 77e9."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{as_text(k)}: {as_text(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return f"[{', '.join(map(as_text, value))}]"
    if isinstance(value, float):
        number = Decimal(repr(value)).normalize().to_eng_string()
        return number.lower().replace("e+", "e")
    if isinstance(value, str) and re.fullmatch(r"[A-Za-z_]+[0-9]*", value):
        return value
    return json.dumps(value)


def of_board(cfg: str, folder: Path) -> str:
    """Write the text of a short config for the TI board that a .cfg describes, or a known radar.

    Args:
        cfg: path of the .cfg, or the name of a radar that radhar knows.
        folder: folder of the new config, from which the path in it is seen.

    Raises:
        ConfigError: the .cfg cannot be read.
        CaptureError: the .cfg is not one that boards of radhar can run.
    """
    if (preset := f"boards/{name_of_written(cfg) or cfg.lower()}") in PRESETS:
        return of_preset(preset)  # a radar whose numbers stand in its config
    text = cfg_text(cfg, Path(), "--radar")
    board = parse_ti_cfg(text, cfg)
    timing = board.timing
    device, chain = _likely_device(board, text), board.firmware or "best"
    path = os.path.relpath(Path(cfg).resolve(), folder.resolve())
    if name := name_of_radar(cfg):
        device, path = device_of(name), name
    maps = ", ".join(_maps_of_board(text, device, timing.period_s, chain))
    position = "" if board.pose else ", position_m: [0, 0, 1]"
    range_end = timing.farthest_m
    speed = timing.fastest_mps
    nearest, farthest = min(1.5, range_end / 3), min(3.0, range_end / 1.5)
    activities = "punching, kicking, grabbing, sitting_down, standing_up"
    duration_s = max(3.0, 2 * timing.period_s)
    if chain in PEOPLE_CHAINS:  # which see persons move through a room
        nearest, farthest = min(2.0, range_end / 3), min(5.0, range_end / 1.5)
        activities = "walking, walking_to_falling, sitting_down, standing_up, punching"
        duration_s = 5.0
    antennas = f"{len(timing.order)} transmitters and {len(timing.receivers)} receivers"
    notes = "".join(f"# {note}\n" for note in _notes_on_points(board, device, chain))
    return f"""# {antennas}; {1 / timing.period_s:.4g} frames a second of {timing.loops} loops;
# ranges to {range_end:.3g} m, speeds of +-{speed:.3g} m/s. What comes out: docs/guide/boards.md
{notes}radar: {{device: {device}, cfg: {json.dumps(path)}{position}}}
samples_per_class: 20
activities: [{activities}]
duration_s: {duration_s:g}
motion: {{place: {{range_m: {{uniform: [{nearest:.2g}, {farthest:.2g}]}}}}}}
body: {{scatterers: surfaces}}
cloud: {{chain: {chain}}}  # {_describe_chain(chain, board)}
maps: [{maps}]
split: {{train: 0.7, validation: 0.15, test: 0.15}}
"""


def _notes_on_points(board: BoardHeader, device: str, chain: Chain) -> Iterator[str]:
    """Note why the points of a board are few, or all at one height."""
    if chain in ("sdk1", "sdk3") and any(board.detection.grouping):
        clouds = f"{device.lower()}_clouds"
        others = f" or --radar {clouds}" * (name_of_radar(clouds) is not None)
        yield (
            "peak grouping is on (cfarCfg or peakGrouping): expect 1 to 3 points a person; "
            f"cloud.chain: best{others} has more"
        )
    array = DEVICES[device].array
    if max(board.timing.order) < len(array.tx) and max(board.timing.receivers) < len(array.rx):
        heights = {array.tx[t][1] + array.rx[r][1] for t, r in board.timing.antennas_of_channels}
        if len(heights) == 1:
            yield "the elements that the file uses lie in one row: points have no heights (z = 0)"


def starting_notes(text: str) -> list[str]:
    """Return the comments in front of a short config of a board."""
    return [line.removeprefix("# ") for line in takewhile(_is_comment, text.splitlines())]


def _is_comment(line: str) -> bool:
    return line.startswith("#")


def _describe_chain(chain: Chain, board: BoardHeader) -> str:
    """Describe the reason for a chain, and the other chains, for a comment."""
    if chain == "best":
        reasons = board.why_no_chain or ("the file has no detection that is simulated",)
        return f"as the data allow: {reasons[0]}"
    return "as the firmware makes points; best: fewer, finer ones"


def describe_written(name: str) -> str:
    """Return the first line of the config of a radar whose frames stand in it (WRITTEN_RADARS)."""
    text = PRESETS[f"boards/{name}"].read_text(encoding="utf-8")
    return text.partition("\n")[0].removeprefix("# ").rstrip(".")


def describe_preset(name: str) -> str:
    """Return the first line of comment of a config that comes with radhar; "" without any."""
    lines = PRESETS[name].read_text(encoding="utf-8").splitlines()
    return next((line.removeprefix("# ").rstrip(".") for line in lines if _is_comment(line)), "")


def of_preset(name: str) -> str:
    """Write the text of a config that comes with radhar, one of configs/.

    A config that needs no other file is written as it is. Otherwise its base is merged into it, the
    .cfg of its board stands in it as text, and of its comments the first remain.

    Args:
        name: name in PRESETS, its last part, or the path in a clone, `configs/human/room.yaml`.

    Raises:
        ConfigError: there is no such config; names one like it.
    """
    preset = find_preset(name)
    if preset is None:
        listed = f"should be one of {len(PRESETS)}; radhar config list shows them"
        hint = did_you_mean(name.removeprefix("configs/"), PRESETS, listed)
        raise ConfigError(f"--preset {json.dumps(name)[:120]}: {hint}")
    path = PRESETS[preset]
    text = path.read_text(encoding="utf-8")
    as_written, _ = parse_yaml(text, str(path))
    radar = as_written.get("radar") or {}
    if BASE not in as_written and ("cfg" not in radar or name_of_radar(radar["cfg"])):
        return text
    head = "".join(takewhile(lambda line: line.startswith("#"), text.splitlines(keepends=True)))
    return f"{head}\n{yaml_text(read_on_bases(path, {})[0])}"


def _likely_device(board: BoardHeader, text: str) -> str:
    """Name a device that a .cfg says it is for, or that its software, band and elements are for.

    TI's visualizer writes the device as a comment: `% Platform:xWR16xx`.
    """
    platform = re.search(r"^%\s*Platform:\s*(\w+)", text, re.MULTILINE | re.IGNORECASE)
    likely = PLATFORMS.get(platform[1].lower() if platform else "") or _usual_device(board)
    fitting = fitting_devices(board)
    return likely if likely in fitting or not fitting else fitting[0]


def _usual_device(board: BoardHeader) -> str:
    """Name the device that is usual with software and frequency of a .cfg."""
    if board.timing.start_hz < 70e9 and board.family is not Family.L_SDK:
        return "IWR6843ISK"
    by_family = {
        Family.L_SDK: IWRL6844 if len(board.timing.receivers) > 3 else "IWRL6432BOOST",
        Family.MCU_PLUS: "AWR2944EVM",
        Family.SDK_3: "IWR1843BOOST",  # which xWR14xx does not have
        Family.PEOPLE_3D: "IWR1843BOOST",
        Family.PEOPLE: "IWR1642BOOST",
    }
    return by_family.get(board.family, "IWR1443BOOST")


def _maps_of_board(cfg: str, device: str, period_s: float, chain: Chain) -> tuple[str, ...]:
    """Choose maps of MAPS_OF_BOARDS that a board makes; all of them if the device does not fit.

    That it does not fit is said when the config is read.
    """
    radar = {"device": device, "cfg": cfg}
    document = {"radar": radar, "maps": ["rtm"], "duration_s": max(3.0, 2 * period_s)}
    with suppress(ValidationError):
        more = {"processing": {"clutter": "none"}, "cloud": {"chain": chain}}
        config = Config.model_validate(document | more)
        return tuple(one for one in MAPS_OF_BOARDS if one in possible_maps(config)) or ("rtm",)
    return MAPS_OF_BOARDS
