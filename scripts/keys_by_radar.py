"""Write docs/reference/keys.md: what each key of a config does with each kind of radar.

    python scripts/keys_by_radar.py

Every key of the schema gets other values than its default. Either what is made of a sample changes
(effect), or the config is refused with a line on that key (refused), or a warning names the key
(warned). A key that does nothing in silence is an error, and so is a warning of one that acts.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, NamedTuple, TypeAlias, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ValidationError

from radhar_cli.config.acting import FRAMES
from radhar_cli.config.data_set import Config
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.dataset.build import build
from radhar_cli.errors import RadharError
from radhar_cli.motion.human.two_link import OutOfReachError
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.warnings import config_warnings
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.products.table import plan_images, products
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO, RAW_PROFILES
from radhar_cli.schema.annotations import (
    ABOVE_ZERO,
    GIVEN,
    NeedsAnyKey,
    NeedsKey,
    OfRadar,
    Unless,
    at,
    conditions,
    section,
    sections,
)
from radhar_cli.schema.section import PerActivity

PAGE = Path(__file__).resolve().parents[1] / "docs/reference/keys.md"
CFG = """
channelCfg 15 7 0
adcCfg 2 1
adcbufCfg 0 1 0 1
profileCfg 0 77 17 7 40 0 0 100 1 64 2499 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
chirpCfg 1 1 0 0 0 0 0 4
chirpCfg 2 2 0 0 0 0 0 2
frameCfg 0 2 12 0 50 1 0
cfarCfg 0 2 8 4 3 0 1130
"""
FOR_ANY_DEVICE = CFG.replace("cfarCfg 0 2 8 4 3 0 1130\n", "")
SUBFRAMES = CFG.replace(
    "frameCfg 0 2 12 0 50 1 0",
    "advFrameCfg 2 0 0 1 0\nsubFrameCfg 0 0 0 3 12 25 0 1 1 25\nsubFrameCfg 1 0 0 3 16 25 0 1 1 25",
)
RADARS: dict[str, dict[str, Any]] = {
    "fmcw": {
        **{"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 200},
        **{"chirp_s": 4e-5, "adc_rate_hz": 2.5e6},
    },
    "sfcw": {
        **{"waveform": "sfcw", "carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 200},
        **{"steps": 64, "dwell_s": 1e-6},
    },
    "cw": {"waveform": "cw", "carrier_hz": 10e9, "prf_hz": 200},
    "impulse": {
        **{"waveform": "impulse", "carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 200},
        **{"profile_m": [0, 6], "profile_samples": 300},
    },
    "board": {"device": "IWR1443BOOST", "cfg": CFG},
    "frames": {
        **{"frame": {"chirps": 12, "period_s": 0.05}, "carrier_hz": 24e9, "prf_hz": 1000},
        **{"bandwidth_hz": 250e6, "adc_rate_hz": 1e6, "chirp_s": 64e-6},
        "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]},
    },
    "sfcw_frames": {
        **{"waveform": "sfcw", "frame": {"chirps": 12, "period_s": 0.05}, "carrier_hz": 24e9},
        **{"bandwidth_hz": 250e6, "steps": 64, "dwell_s": 1e-6, "prf_hz": 1000},
        "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]},
    },
    "cw_frames": {
        **{"waveform": "cw", "frame": {"chirps": 12, "period_s": 0.05}, "carrier_hz": 24e9},
        **{"prf_hz": 1000, "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]}},
    },
}
BASE: dict[str, Any] = {
    "activities": ["punching"],
    "samples_per_class": 2,
    "split": {"train": 0.5, "validation": 0.5},
    "motion": {"range_m": 2.5},
    "image": {"size_px": 16},
    "on_invalid": "keep",
}
NAMES_OF_TAGS = {
    "<board>": "radar.cfg",
    "<frames>": "radar.frame",
    "<sfcw_frames>": "radar.frame of waveform: sfcw",
    "<cw_frames>": "radar.frame of waveform: cw",
}
FILES_OF_A_DATA_SET = ("output.", "split.", "samples_per_class", "image.colour_map")
MODELS = ("human", "paper")
SOME_LABELS = ("S1", "S3", "S5", "S8", "S12")
NOT_OF_A_MODEL = ("motion.model", "motion.folder")
OF_PEOPLE = ("subject.", "motion.", "timing.")
# What a key of which another one makes use says, where any value will do.
SOME: dict[str, Any] = {
    "snr_db": 20.0,
    "wall": {},
    "people": [{"motion": {"range_m": 4, "cross_range_m": 1.2}}],
    "room.faces": {"floor": "concrete"},
    "room.back_wall_m": 3.5,
    "receiver.channel_gain_db": 1.0,
    "radar.beam": {},
    "receiver.noise_figure_db": 60.0,
    "receiver.noise_corner_hz": 30.0,
}
BACK_AND_MORE = {"back": "concrete", "left": "concrete", "ceiling": "concrete"}
SMALL_CFAR = {"image.kind": "cfar", "image.cfar": {"guard": [1, 1], "training": [3, 3]}}
# Situations in which a key matters, beside what its annotations say: {key: {other key: value}}.
SITUATIONS: dict[str, dict[str, Any]] = {
    "radar.device": {"radar.cfg": FOR_ANY_DEVICE},
    "radar.subframe": {"radar.cfg": SUBFRAMES},
    "cloud.boundary_box": {"radar.cfg": f"{CFG}boundaryBox -1 1 0.5 2 0 0.2\n"},
    "radar.dwell_s": {"receiver.noise_figure_db": 60.0, "snr_db": None},
    "radar.tx_m": {"radar.array": {}, "maps": ["stft"]},
    "radar.rx_m": {"radar.array": {}, "maps": ["stft"]},
    "radar.frame.interval_s": {"radar.prf_hz": None, "maps": ["stft"]},
    "radar.frame.period_s": {"maps": ["stft"]},
    "engine.fallback": {"engine.tolerance_db": -400.0},
    "on_invalid": {"wall": {"center_m": [2.5, 0, 1.25]}},
    "snr_reference": {"wall": {"center_m": [1, 0, 1.25]}},
    "room.faces.": {"room.box_m": {"x": [-1, 6]}},
    "room.reflectors.": {"room.reflectors": [{}]},
    "receiver.tones.": {"receiver.tones": [{"doppler_hz": 20, "off_s": 0.1, "on_s": 0.1}]},
    "cloud.quantise": {"cloud.chain": "board"},
    "radar.output": {"maps": ["stft"]},
    "wall.center_m": {"wall": {}},
    "room.box_m": {"room.faces": {"back": "concrete"}, "room.box_m": {"x": [-1, 6]}},
    "room.box_m.": {"room.faces": BACK_AND_MORE, "room.box_m": {"x": [-1, 6]}},
    "image.cfar.": SMALL_CFAR,
    "image.kind": {"image.cfar": SMALL_CFAR["image.cfar"]},
    "image.cadence_limit_hz": {"duration_s": 1.0, "maps": ["stft_cadence"]},
    "output.column_labels": {"maps": ["stft"]},
    "output.power": {"maps": ["stft"]},
    "processing.range_sum": {"maps": ["stft"]},
    "wall.layers": {"wall.echoes": "exact", "engine.kind": "cube"},
    "engine.motion_in_chirp": {"engine.kind": "cube"},
    "motion.walking.lane_start": {"motion.walking.lane_m": 3.0},
}
# Those of a kind of radar alone, in place of the others.
SITUATIONS_OF: dict[str, dict[str, dict[str, Any]]] = {
    "cw_frames": {
        "radar.frame.interval_s": {
            "radar.frame.interval_s": 1e-3,
            "radar.prf_hz": None,
            "maps": ["stft"],
        },
    },
}
# Keys that only change together: {key: other keys and their values}.
TOGETHER: dict[str, dict[str, Any]] = {
    "radar.frame.interval_s": {"radar.frame.chirps": 12},
    "radar.frame.period_s": {"radar.frame.chirps": 12},
    "radar.tx_m": {"radar.rx_m": [0.4, 0.1, 1.5]},
    "radar.rx_m": {"radar.tx_m": [0.4, -0.1, 1.5]},
    "split.by": {"split.subjects": 2},
    "split.train": {"split.validation": 0.0},
    "split.validation": {"split.train": 0.0},
    "split.test": {"split.validation": 0.0},
    "split.subjects": {"split.by": "subject"},
    "classes": {"activities": ["own"]},
}
# Values that no rule finds: {key: values}.
VALUES: dict[str, tuple[Any, ...]] = {
    "radar.waveform": ("sfcw", "cw", "impulse", "fmcw"),
    "activities": (["kicking"],),
    "classes": ({"own": {"sequence": ["punching"]}},),
    "people": (SOME["people"],),
    "maps": (["rtm"], ["stft"], ["points"]),
    "wall.layers": ([{"thickness_m": 0.1, "eps_r": 4.0}],),
    "wall.size_m": ([0.3, 5.0, 2.5],),
    "wall.rays": ("straight", "refracted"),
    "room.reflectors": ([{}],),
    "room.back_wall_m": (3.5,),
    "room.faces": ({"floor": "concrete"},),
    "processing.window_s": (0.1, 0.0016),
    "processing.savgol.frame": (7,),
    "cloud.pfa": (0.05,),
    "on_invalid": ("error",),
    "body.points_per_segment": (3,),
    "motion.falling.direction": ("backward",),
    "subject.weight_kg": (90.0,),
    "split.by": ("subject",),
    "split.train": (1.0,),
    "split.validation": (1.0,),
    "split.test": (0.5,),
    "split.subjects": (2,),
    "receiver.tones": ([{"doppler_hz": 20}],),
    "receiver.noise_figure_db": (60.0,),
    "radar.carrier_hz": (9e9, 2.1e9),
    "radar.tx_m": ([0.3, -0.2, 1.4],),
    "radar.rx_m": ([0.3, 0.2, 1.4],),
    "radar.frame.interval_s": (5e-4,),
    "radar.frame.period_s": (0.04, 0.1),
    "radar.profile_m": ([0, 5.5],),
    "radar.array": ({}, {"rx": [[0, 0], [1, 0], [2, 1]]}),
    "radar.array.tx": ([[0, 0.5]], [[0, 0], [4, 0], [2, 1]], [[1, 0], [4, 0], [2, 1]]),
    "radar.array.rx": (
        [[0, 0], [1, 0], [2, 1]],
        [[0, 0], [1, 0], [2, 0], [4, 0]],
    ),
    "radar.half_power_deg": ([20.0, 20.0],),
    "radar.half_wavelength_m": (0.0018,),
    "radar.steps": (100,),
    "radar.cfg": (CFG.replace(" 64 2499", " 60 2499"),),
    "processing.gate_m": (0.7, [1.0, 3.0]),
    "processing.range_fft_length": (128,),
    "processing.highpass.cutoff_hz": (5.0,),
    "processing.stft_fft_length": (128,),
    "processing.savgol": ({"order": 3, "frame": 7},),
    "processing.fsst_hop_pulses": (2, 5),
    "image.size_px": (20,),
    "image.colour_map": ("gray",),
    "image.doppler_limits_mps": ([-0.5, 0.5], [-3.0, 3.0]),
    "image.range_limits_m": ([1.0, 3.0],),
    "image.cfar.guard": ([2, 1],),
    "image.cfar.training": ([2, 2],),
    "wall.center_m": ([1.2, 0.0, 1.25],),
    "room.box_m": ({"x": [-1, 5.5]},),
    "room.box_m.x": ([-1.0, 5.5],),
    "room.box_m.y": ([-2.5, 3.0],),
    "output.products": (["frames"], ["torso_track"]),
    "output.license": ("mit",),
    "recordings": ({},),
    "radars": ({"other": {}},),
    "radar_name": ("other",),
    "other_radars": ({"other": {}},),
    "room.faces.floor": ("brick",),
}


class Outcome(NamedTuple):
    """What a key with other values does, and what was tried."""

    word: Literal["effect", "refused", "warned", "nothing", "warned, yet acts"]
    what: str


Outcomes: TypeAlias = dict[str, dict[str, Outcome]]


def with_key(document: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """A document with another value under a dotted key."""
    name, _, rest = key.partition(".")
    inner = document.get(name)
    if rest and isinstance(inner, list):
        place, _, rest = rest.partition(".")
        items = [*inner]
        items[int(place)] = with_key(items[int(place)], rest, value)
        return {**document, name: items}
    inner = inner if isinstance(inner, dict) else {}
    return {**document, name: with_key(inner, rest, value) if rest else value}


def leaves() -> list[str]:
    """Dotted keys of the schema that hold values, and sections that may be null."""
    found = []
    for key, field in fields(Config):
        inner = section(field)
        if get_origin(field.annotation) is tuple:
            inner = None
        whole = inner is None or getattr(inner, "REPEATS", False) or key == "recordings"
        if not key.startswith(("recordings.", "stream")) and (whole or field.default is None):
            found.append(key)
    return found


def fields(kind: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """(dotted key, field) of a model and its sections."""
    for name, field in kind.model_fields.items():
        yield prefix + name, field
        many = get_origin(field.annotation) is tuple
        known = set[str]()
        for inner in sections(field):
            if getattr(inner, "REPEATS", False):
                continue
            for key, inner_field in fields(inner, f"{prefix}{name}.{'0.' if many else ''}"):
                if key not in known:
                    yield key, inner_field
                known.add(key)


def base_of(radar: str) -> dict[str, Any]:
    """The config of a radar: every map that it makes, with noise."""
    document = {
        **BASE,
        "radar": RADARS[radar],
        "duration_s": 0.1 if radar in FRAMES else 0.5,
    }
    document["maps"] = ["rtm"] if radar == "impulse" else ["stft"]
    if radar == "impulse":
        document["processing"] = {"range_sum": "gated"}
    made = possible_maps(Config.model_validate(document))
    return document | {"maps": [name for name in made if name != "cube"]}


def contexts(radar: str, key: str) -> Iterator[dict[str, Any]]:
    """Configs in which a key should act with a radar, as far as its conditions can be met."""
    base = situated = base_of(radar)
    for whose, situation in (SITUATIONS | SITUATIONS_OF.get(radar, {})).items():
        if key == whose or (whose.endswith(".") and key.startswith(whose)):
            for other, value in situation.items():
                situated = with_key(situated, other, value)
    tried = list[dict[str, Any]]()
    for document in (with_conditions(situated, key), with_conditions(base, key), base):
        if document not in tried:
            tried.append(document)
            yield document


def with_conditions(document: dict[str, Any], key: str) -> dict[str, Any]:
    """A document with what its annotations say that a key needs."""
    for condition in conditions(Config, key):
        config = valid(document)
        value_at = None if config is None else partial(at, config)
        if isinstance(condition, Unless | OfRadar):
            continue
        if value_at is not None and not condition.holds(value_at):
            need = condition.choices[0] if isinstance(condition, NeedsAnyKey) else condition
            if isinstance(need, NeedsKey) and need.key != key:
                document = with_key(document, need.key, required(need))
    if key.startswith("processing.gate"):
        document = document | {"maps": [one for one in document["maps"] if "fsst" not in one]}
    if key == "image.clipped":
        document = document | {"maps": ["rtm"]}
    return document


def reachable(config: Config, key: str) -> bool:
    """Whether a config has the item of a list that a key lies in."""
    try:
        at(config, key)
    except IndexError:
        return False
    return True


def required(condition: NeedsKey) -> Any:
    """A value with which a condition holds."""
    if GIVEN in condition.values or ABOVE_ZERO in condition.values:
        return SOME[condition.key]
    return condition.values[0]


UNKNOWN = "Extra inputs are not permitted"  # as pydantic says it of a key


class Refusal(NamedTuple):
    """Why a config is refused: what is said, and of which keys or sections."""

    text: str
    faults: tuple[tuple[str, str], ...]  # (key, what would be right)

    def blames(self, key: str) -> bool:
        """Whether a fault is a key's: by key, or of its section by name; or the remedy names it."""
        name = key.rpartition(".")[2]
        return any(
            one == key
            or one.startswith(f"{key}.")
            or (key.startswith(f"{one}.") and (name in right or UNKNOWN in right))
            or key in right
            for one, right in self.faults
        )


@cache
def _valid(text: str) -> Config | Refusal:
    try:
        return Config.model_validate(json.loads(text))
    except ValidationError as error:
        return Refusal(str(error), tuple(_faults(error)))


def _faults(error: ValidationError) -> Iterator[tuple[str, str]]:
    """Faults of a config, but for values of a wrong type, which say nothing of radars."""
    for item in error.errors(include_url=False):
        if item["type"] == "across":
            for problem in item["ctx"]["problems"]:
                yield problem.key, problem.right
        elif not item["type"].endswith("_type"):
            tags = [name for name in item["loc"] if str(name).startswith("<")]  # of the radar
            key = ".".join(str(name) for name in item["loc"] if name not in tags)
            names = [NAMES_OF_TAGS.get(tag, f"radar.waveform: {tag}") for tag in tags]
            yield key, " with ".join((item["msg"], *names))


def valid(document: Mapping[str, Any]) -> Config | None:
    """The config of a document, if it is accepted."""
    found = _valid(json.dumps(document))
    return found if isinstance(found, Config) else None


def other_values(key: str, field: Any, now: Any) -> list[Any]:
    """Values of a key that differ from the one it has."""
    if key in VALUES:
        return list(VALUES[key])
    kinds = [field.annotation, *_inside(field.annotation)]
    literals = [one for kind in kinds if get_origin(kind) is Literal for one in get_args(kind)]
    if literals:
        return [one for one in literals if one != now]
    if isinstance(now, bool):
        return [not now]
    if sections(field):
        return [{}] if now is None else [None]
    if isinstance(now, tuple):
        plain = [getattr(one, "nominal", one) for one in now]
        first, *others = plain
        return [[first + 0.3, *others], [*plain[:-1], plain[-1] + 0.3], [first - 0.1, *others]]
    number = getattr(now, "nominal", now)
    if isinstance(number, int):
        return [number + 1, max(number - 1, 1), 2 * number, number + 2, 3]
    if isinstance(number, float):
        near = [1.1 * number + 0.1, 0.8 * number, number - 0.3]
        return [*near, 1.5 * number, 1.01 * number, number - 1, number + 1]
    return [1, 2.0, 5.0, "x"]


def _inside(kind: Any) -> Iterator[Any]:
    for one in get_args(kind):
        yield one
        yield from _inside(one)


def outcome(radar: str, key: str, field: Any) -> Outcome:
    """What a key does with a radar."""
    refusals, silent, warned = list[tuple[Any, bool]](), list[Any](), None
    for document in contexts(radar, key):
        config = _valid(json.dumps(document))
        if isinstance(config, Refusal):
            whole = key.partition(".0.")[0]
            refusals.append((config.text, config.blames(key) or config.blames(whole)))
            continue
        if not reachable(config, key):
            continue
        for value in other_values(key, field, at(config, key)):
            changed = with_key(document, key, value)
            for other, another in TOGETHER.get(key, {}).items():
                changed = with_key(changed, other, another)
            found = _valid(json.dumps(changed))
            if isinstance(found, Refusal):
                refusals.append((found.text, found.blames(key)))
                continue
            if _same(at(found, key), at(config, key)):
                continue
            said = [one for one in config_warnings(found) if "no effect" in one and names(one, key)]
            acts = differs(document, changed, key)
            if said and acts:
                return Outcome("warned, yet acts", f"{value}: {said[0]}")
            if acts:
                return Outcome("effect", str(value))
            if said:
                warned = warned or said[0]
                continue
            silent.append(value)
    if warned is not None:
        return Outcome("warned", warned)
    if silent:
        return Outcome("nothing", f"{silent}")
    named = [value for value, named in refusals if named]
    return Outcome("refused", f"{named[:1]}") if named else Outcome("nothing", f"{refusals[:3]}")


def _same(one: Any, other: Any) -> bool:
    """Whether two values are equal, or differ by what counts as rounding."""
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= 1e-8 * abs(other)
    return bool(one == other)


def names(warning: str, key: str) -> bool:
    """Whether a warning is of a key, or of a section that it lies in."""
    named = warning.split(" ", 1)[0]
    return key == named or key.startswith(f"{named}.") or named.startswith(f"{key}.")


def differs(document: Mapping[str, Any], changed: Mapping[str, Any], key: str) -> bool:
    """Whether other samples, or another data set, are made of two documents."""
    make = digests_of_files if key.startswith(FILES_OF_A_DATA_SET) else digests
    before = _known(make.__name__, json.dumps(document))
    after = make(changed)
    return any(one != other for one, other in zip(before, after, strict=False))


_held: dict[tuple[str, str], tuple[list[str], Iterator[str]]] = {}


def _known(kind: str, text: str) -> Iterator[str]:
    """Digests of a document that were made before, and then those that are still to be made."""
    if (kind, text) not in _held:
        make = digests_of_files if kind == "digests_of_files" else digests
        _held[kind, text] = [], make(json.loads(text))
    made, following = _held[kind, text]
    yield from made
    for one in following:
        made.append(one)
        yield one


def digests(document: Mapping[str, Any]) -> Iterator[str]:
    """Digests of what is made of the first sample, what takes least time first."""
    config = Config.model_validate(document)
    try:
        scene = draw_valid_scene(config, config.chosen_activities[0], 0)[0]
        table = products(scene.config)
        first = next(one for one in ("cube", "range_signals", "signal") if one in table)
        steps = [[first]]
        asked = plan_images(config).requested
        images = [name for name in asked if name.startswith("image:") and "points" not in name]
        steps += [images]
        steps += [[name] for name in ("rtm", "stft") if name in config.maps]
        steps += [[name for name in asked if name not in images]]
        if "cube" not in table:
            steps += [["raw_echo"]]
        raw = RAW_PROFILES if "profiles" in table else RAW_ECHO
        for names_of_step in steps:
            made = record(scene, names_of_step, [raw])
            yield digest([made[name] for name in names_of_step])
    except RadharError as error:
        yield str(error)


def digests_of_files(document: Mapping[str, Any]) -> Iterator[str]:
    """Digest of the files of a data set."""
    with TemporaryDirectory() as folder:
        place = Path(folder) / "set"
        try:
            few = {"maps": document["maps"][:2]}
            build(Config.model_validate({**document, **few}), place, 1, Quiet())
        except RadharError as error:
            yield str(error)
            return
        files = [one for one in sorted(place.rglob("*")) if one.is_file()]
        files = [one for one in files if ".radhar" not in one.parts and one.name != "config.yaml"]
        yield digest([(str(one.relative_to(place)), one.read_bytes()) for one in files])


class Quiet:
    """Progress that nobody watches."""

    def stage(self, name: str, total: int, done: int) -> None: ...

    def advance(self, samples: int) -> None: ...

    def say(self, message: str) -> None: ...


def digest(value: Any) -> str:
    """Digest of all numbers and texts in something that was made."""
    found = hashlib.sha256()
    _feed(found, value)
    return found.hexdigest()


def _feed(found: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        found.update(str(value.dtype).encode() + np.ascontiguousarray(value).tobytes())
    elif isinstance(value, bytes):
        found.update(value)
    elif isinstance(value, (list, tuple)):
        for one in value:
            _feed(found, one)
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            _feed(found, getattr(value, name))
    else:
        found.update(repr(value).encode() if isinstance(value, (int, float, str, complex)) else b"")


def outcomes_of_radars() -> Outcomes:
    """{key: {radar: what it does}} of all keys but those of people."""
    known = dict(fields(Config))
    return {
        key: {radar: outcome(radar, key, known[key]) for radar in RADARS}
        for key in leaves()
        if not key.startswith(OF_PEOPLE)
    }


def outcomes_of_people() -> Outcomes:
    """{key: {model of motion: what it does to positions}} of keys of people, whatever the radar."""
    known = dict(fields(Config))
    return {
        key: {model: _outcome_of_person(model, key, known[key]) for model in MODELS}
        for key in leaves()
        if key.startswith(OF_PEOPLE) and key not in NOT_OF_A_MODEL
    }


def _outcome_of_person(model: str, key: str, field: Any) -> Outcome:
    """What a key does to the positions of people, in all that they can do."""
    document = _movements(model)
    for other, value in SITUATIONS.get(key, {}).items():
        document = with_key(document, other, value)
    config, said, tried = Config.model_validate(document), None, []
    for value in other_values(key, field, _plain(at(config, key))):
        changed = with_key(document, key, value)
        found = _valid(json.dumps(changed))
        if isinstance(found, Refusal):
            tried.append(f"{value} is refused: {found.text}")
            continue
        said = next((one for one in config_warnings(found) if names(one, key)), None)
        chosen = config.chosen_activities
        users = [one for one in chosen if found.depends_on(one, key)]
        for activity in users or [one for one in chosen if one.label in SOME_LABELS]:
            before = _positions(json.dumps(document), activity.slug)
            after = _positions(json.dumps(changed), activity.slug)
            if not np.array_equal(before, after):
                return Outcome("warned, yet acts" if said else "effect", f"{value} {activity.slug}")
        if said:
            return Outcome("warned", said)
        tried.append(str(value))
    return Outcome("nothing", ", ".join(tried))


def _movements(model: str) -> dict[str, Any]:
    """The twelve, and of people every movement there is, each after what leads to it."""
    document: dict[str, Any] = {"duration_s": 8.0, "motion": {"model": model}, "maps": ["stft"]}
    if model == "human":
        first = {"seated": ["sitting_down"], "lying": ["falling"]}
        alone = "lying", "turning_over", "sitting"
        document["classes"] = {
            f"own_{name}": {
                "sequence": [*([] if name in alone else first.get(one.before, [])), name]
            }
            for name, one in MOVEMENTS.items()
            if name != NOBODY
        }
    return document


@cache
def _positions(text: str, slug: str) -> Any:
    config = _valid(text)
    assert isinstance(config, Config)
    activity = next(one for one in config.chosen_activities if one.slug == slug)
    scene = draw_scene(config, activity, 0)
    try:
        motion, t = motion_of(scene.people[0]), np.linspace(0, 7.9, 80)
        return np.concatenate([motion.positions(t).ravel(), motion.cross_sections(t).ravel()])
    except (RadharError, OutOfReachError) as error:
        return np.array(str(error))


def _plain(value: Any) -> Any:
    """A number that is drawn, or differs by activity, at its middle."""
    if isinstance(value, PerActivity):
        value = value.per_activity["default"]
    return getattr(value, "nominal", value)


def page(of_radars: Outcomes, of_motion: Outcomes) -> str:
    """docs/reference/keys.md.

    Raises:
        RadharError: a key does nothing in silence, or is warned of and acts.
    """
    wrong = [
        f"{key} with {name}: {one.word} ({one.what})"
        for found in (of_radars, of_motion)
        for key, row in found.items()
        for name, one in row.items()
        if one.word not in ("effect", "refused", "warned")
    ]
    if wrong:
        raise RadharError("\n".join(wrong))
    rows = [_row(key, found) for key, found in of_radars.items()]
    of_people = [_row(key, found) for key, found in of_motion.items()]
    return "\n".join(
        [
            *("# What every key does", "", *INTRODUCTION, ""),
            *(_head("key", tuple(RADARS)), *rows, ""),
            *("## People", "", *OF_MOTION, "", _head("key", MODELS), *of_people, ""),
        ]
    )


def _head(first: str, names: tuple[str, ...]) -> str:
    return f"| {first} | {' | '.join(names)} |\n| --- {'| --- ' * len(names)}|"


def _row(key: str, found: Mapping[str, Outcome]) -> str:
    return f"| `{key}` | {' | '.join(one.word for one in found.values())} |"


INTRODUCTION = (
    "After this page you know which keys act with which radar. `scripts/keys_by_radar.py` writes",
    "it from the schema, and a test keeps it true. Each key gets other values than its default,",
    "in a config in which what it needs is there, as far as a radar has that: either what is",
    "made of a sample changes (effect), or the config is refused for that key, or with it as the",
    "remedy (refused), or a warning says that the key has no effect and why (warned). Keys of",
    "`classes`, `stream` and of motion files are not in the tables. [The keys](config.md) has what",
    "each means.",
)
OF_MOTION = (
    "What keys of people do to their positions and radar cross-sections, whatever the radar, by",
    "`motion.model`, in the twelve activities and every movement of sequences.",
)


def main() -> None:
    """Write the page, unless a key does nothing in silence."""
    PAGE.write_text(page(outcomes_of_radars(), outcomes_of_people()))


if __name__ == "__main__":
    main()
