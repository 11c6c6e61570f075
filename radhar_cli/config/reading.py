"""Read a YAML config, apply ``--set`` overrides, and describe its problems."""

import difflib
import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from radhar_cli.config.classes import FilesConfig
from radhar_cli.config.data_set import Config, ConfigOfRecordings
from radhar_cli.config.documents import (
    BASE,
    FILE_OF_CFG,
    OTHER_NAMES,
    Places,
    Source,
    advice_on_radars,
    cfg_text,
    find_config,
    name_of_cfg,
    read_on_bases,
)
from radhar_cli.config.motion import EARLIER_KEYS
from radhar_cli.config.motion_files import resolve_files
from radhar_cli.config.radar import (
    KINDS_WITH_FRAMES,
    RADARS,
    AnyRadar,
    ArrayRadar,
    FmcwRadar,
    class_of_radar,
)
from radhar_cli.config.sequence import PART_TAGS, SequenceConfig
from radhar_cli.config.several_radars import (
    NAME_KEY,
    OTHERS_KEY,
    RADARS_KEY,
    RadarDocument,
    documents_of_radars,
    file_of_cfg,
    problems_of_radars,
    radar_names,
)
from radhar_cli.config.units import (
    key_in_our_unit,
    number_in_another_unit,
    unit_of,
    value_with_unit,
)
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.files.untrusted import escaped
from radhar_cli.schema.annotations import range_of, sections
from radhar_cli.schema.number import FORMS
from radhar_cli.schema.section import PerActivity, Problem

S = TypeVar("S", bound=BaseModel)

_UNION_TAGS = {
    *("<same>", "<per_activity>"),
    *("<movements>", "<recordings>"),
    *("<material>", "<dielectric>"),
    *("<word>", "<power>"),
    *PART_TAGS,
    *(f"<{radar.kind}>" for radar in RADARS),
}
_CLASS_KINDS: dict[str, type[BaseModel]] = {"sequence": SequenceConfig, "files": FilesConfig}
Options: TypeAlias = dict[str, str]
MAX_MISTAKES = 20
MAX_VALUE, MAX_ADVICE = 200, 500  # characters of value and advice in a message

_CHANNELS = "is not there: channels come with radar.cfg or radar.frame (docs/guide/boards.md)"
_PEOPLE = (
    "is not there: `people` has others in a scene (docs/guide/scenes.md); several persons of a "
    "data set are split: {by: subject, subjects: 4}"
)
_SUBJECTS = "is called subjects: split: {by: subject, subjects: 4}"
_UNMEASURED = (
    *("squat", "reach_deg", "free_arm", "kneel_s", "look_deg", "recline_from"),
    *("step_asymmetry", "speed_ripple", "speed_ripple_asymmetry"),
)
_DOPPLER_TIME = (
    *("spectrogram", "micro_doppler", "microdoppler"),
    *("doppler_time", "time_doppler", "dtm"),
)
ABSENT = {
    **dict.fromkeys(("receivers", "transmitters", "channels", "antennas", "mimo"), _CHANNELS),
    **dict.fromkeys(("persons", "targets", "subjects"), _PEOPLE),
    **dict.fromkeys(("point_cloud", "pointcloud", "cloud"), "is called points"),
    **dict.fromkeys(("range_angle", "range_azimuth_map", "ra"), "is called range_azimuth"),
    **dict.fromkeys(("rd", "rdm", "range_doppler_map"), "is called range_doppler"),
    **dict.fromkeys(("doppler_angle", "angle_doppler"), "is called doppler_azimuth"),
    **dict.fromkeys(("angle_time", "time_angle", "range_angle_time"), "is called azimuth_time"),
    **dict.fromkeys(_DOPPLER_TIME, "is called stft"),
    **dict.fromkeys(("cvd", "cadence", "cadence_velocity", "stft_cvd"), "is called stft_cadence"),
    **dict.fromkeys(("range_time", "time_range"), "is called rtm"),
    "rise_overlap": "is now a dwell_s below 0",
    **dict.fromkeys(("stride_jitter", "width_jitter_m"), "now follows speed_variation"),
    **dict.fromkeys(_UNMEASURED, "is not there any more: nothing measured depends on it"),
}

_OF_LAYERS = "is a key of layers: wall.layers: [{material: concrete}], or wall.eps_r"
_OF_SEVERAL = "goes with radars: {front: {aspect: {...}}} (docs/guide/several_radars.md)"
_OF_FRAME = "is a key of frame: radar.frame: {chirps: 64, interval_s: 250e-6, period_s: 0.05}"
_OF_ARRAY = "is a key of array: radar.array: {tx: [[0, 0]], rx: [[0, 0], [1, 0]]}"
_BESIDE_FRAME = "is a key of radar, beside frame"
MISPLACED = {
    "wall.material": _OF_LAYERS,
    "wall.thickness_m": _OF_LAYERS,
    "radar.aspect": _OF_SEVERAL,
    **dict.fromkeys(("radar.chirps", "radar.interval_s", "radar.period_s"), _OF_FRAME),
    **dict.fromkeys(("radar.tx", "radar.rx"), _OF_ARRAY),
    **dict.fromkeys(
        ("radar.frame.prf_hz", "radar.frame.chirp_s", "radar.frame.adc_rate_hz"), _BESIDE_FRAME
    ),
    **dict.fromkeys(("split.persons", "split.people", "split.participants"), _SUBJECTS),
    "radar.profile_step_m": "is (to - from)/profile_samples of profile_m: [from, to]",
    "radar.array.half_wavelength_m": "is a key of radar, beside array: radar.half_wavelength_m",
}

PERSONS = "person", "people", "participant", "user", "volunteer"  # other words for subjects
_MISSING = object()  # the value of a key that is not there
MOVED_KEYS = {earlier: key for key, earlier in EARLIER_KEYS.items()}


class Override(NamedTuple):
    """A key whose value comes from elsewhere than a config file.

    Attributes:
        key: dotted.
        text: the value, as YAML.
        option: of the command line, which messages name instead of the file: `--tolerance`.
    """

    key: str
    text: str
    option: str

    @classmethod
    def parse(cls, text: str) -> "Override":
        """An override of the form ``radar.prf_hz=128``, as `--set` takes it."""
        key, equals, value = text.partition("=")
        key = key.strip()
        if not equals or not all(key.split(".")):
            raise ConfigError(
                f"--set {text}: should be key=value with a dotted key, such as radar.prf_hz=128"
            )
        return cls(OTHER_NAMES.get(key, key), value, f"--set {key}")


Overrides: TypeAlias = Iterable[str | Override] | Mapping[str, Any]


def load_config(
    config: str | Path | Mapping[str, Any],
    overrides: Overrides = (),
    kind: type[Config] = Config,
) -> Config:
    """Read a data set's config file, and its bases, and apply overrides.

    Args:
        config: YAML file, or the name of a config that radhar comes with, such as `human/room`, or
            the plain values of one, whose files are named from the current folder.
        overrides: {"radar.prf_hz": 128}, or texts such as ``radar.prf_hz=128``, as `--set` takes
            them.
        kind: class of the config.

    Returns:
        The config, in which the files of classes are found and have their checksums.

    Raises:
        ConfigError: unreadable file, bad YAML, or a value out of place; the message names the
            file (that or one under it, `base`), the line, the key, the value and what would be
            right.
    """
    configs = load_radars(config, overrides, kind)
    if len(configs) == 1:
        return next(iter(configs.values()))
    source = _source(config)
    _, places, options = _read_values(source, overrides)
    where = _locate(_name_of(source), RADARS_KEY, places, options)
    raise ConfigError(f"{where}: {ask_for_one_radar([*configs])}")


def ask_for_one_radar(names: Iterable[str]) -> str:
    """Describe the choice of one of several radars, where one is needed."""
    *earlier, last = names
    return (
        f"has several radars, {', '.join(earlier)} and {last}; should be one here: "
        f"--set {NAME_KEY}={earlier[0]}"
    )


def load_radars(
    config: str | Path | Mapping[str, Any],
    overrides: Overrides = (),
    kind: type[Config] = Config,
) -> dict[str, Config]:
    """Read the config of each radar of a data set's config file, as `load_config` reads one.

    Args:
        config: YAML file, name, or plain values, as of `load_config`.
        overrides: {"radars.side.yaw_deg": 30}, or texts, as of `load_config`.
        kind: class of the configs.

    Returns:
        {name of the radar: config} of the file's `radars`, in the order of the alphabet, which all
        have the same people; of a file with a single `radar`, or of which `radar_name` chooses one
        radar, {"": config}.

    Raises:
        ConfigError: as `load_config`; a mistake that all radars share is told once.
    """
    source = _source(config)
    folder = find_config(source).parent if isinstance(source, Path) else Path()

    def with_files(config: Config, located: tuple[Places, Options]) -> Config:
        if kind is ConfigOfRecordings:
            config = config.model_copy(update={"people": ()})  # which nobody has checked
            config._places = located

        def refuse(key: str, value: object, right: str) -> ConfigError:
            problem = Problem(key, value, right)
            name = _name_of(source)
            return ConfigError(_locate(name, key, *located) + _value_and_advice(problem))

        return resolve_files(config, folder, refuse)

    return _load_radars(source, overrides, kind, with_files)


def _source(config: str | Path | Mapping[str, Any]) -> Path | Mapping[str, Any]:
    """Take the source of a config: a file, or plain values.

    Raises:
        ConfigError: it is neither.
    """
    if isinstance(config, Mapping):
        return config
    if isinstance(config, (str, Path)):
        return Path(config)
    raise ConfigError(
        f"config = {_short(repr(config))}: should be the path of a YAML file, a name that `radhar "
        "config list` has, or a mapping such as {'snr_db': 5}"
    )


def _name_of(source: Source) -> str:
    """Name of a config in messages: that of its file, or "config"."""
    return str(source) if isinstance(source, Path) else "config"


def _load_radars(
    source: Source,
    overrides: Overrides,
    kind: type[Config],
    finish: Callable[[Config, tuple[Places, Options]], Config],
) -> dict[str, Config]:
    """Read the config of each radar, and finish it with the places and options of its keys."""
    document, places, options = _read_values(source, overrides)
    if document.get(RADARS_KEY) is None:
        config = validated(kind, document, _name_of(source), places, options)
        return {"": finish(config, (places, options))}
    configs, mistakes = dict[str, Config](), dict[str, None]()
    documents = _documents_of_radars(document, _name_of(source), places, options)
    for name, of_name in documents.items():
        try:
            of_radar = of_name.places(places)
            values = {key: value for key, value in of_name.values.items() if key != OTHERS_KEY}
            config = validated(kind, values, _name_of(source), of_radar, options, of_name)
            configs[name] = finish(config, (of_radar, options))
        except ConfigError as error:
            mistakes |= dict.fromkeys(str(error).splitlines())
    if mistakes:
        raise ConfigError("\n".join([*mistakes][:MAX_MISTAKES]))
    radars = {name: config.radar for name, config in configs.items()}
    for name, config in configs.items():  # checked in configs of their own
        others = {other: radar for other, radar in radars.items() if other != name}
        configs[name] = config.model_copy(update={OTHERS_KEY: others})
    chosen = document.get(NAME_KEY)
    return configs if chosen is None else {"": configs[chosen]}


def _documents_of_radars(
    document: dict[str, Any], where: str, places: Places, options: Mapping[str, str]
) -> dict[str, RadarDocument]:
    """Make the document of each radar of one that has `radars`.

    Raises:
        ConfigError: an entry of `radars` is none.
    """
    mistakes = dict.fromkeys(  # of what all radars have, each once
        _locate(where, problem.key, places, options) + _value_and_advice(problem)
        for problem in problems_of_radars(document)
    )
    if mistakes:
        raise ConfigError("\n".join([*mistakes][:MAX_MISTAKES]))
    return documents_of_radars(document)


def as_config(config: Config | str | Path | Mapping[str, Any]) -> Config:
    """Return a config as it is, or read another one.

    Raises:
        ConfigError: as `load_config`.
    """
    return config if isinstance(config, Config) else load_config(config)


def load_section(kind: type[S], source: Source, overrides: Overrides = ()) -> S:
    """Read a file that holds one `kind` of config, or its defaults, and apply overrides.

    Args:
        kind: class of the config.
        source: YAML file, or plain values; None for the defaults.
        overrides: as of `load_config`.

    Raises:
        ConfigError: as `load_config`.
    """
    document, places, options = _read_values(source, overrides)
    where = ", ".join(dict.fromkeys(options.values())) or "the defaults"
    where = where if source is None else _name_of(source)
    return validated(kind, document, where, places, options)


def load_sections(path: Path, overrides: Overrides = ()) -> dict[str, Config]:
    """Read a data set's config file as `load_radars`, without looking for its motion files.

    Args:
        path: YAML file.
        overrides: as of `load_radars`.

    Raises:
        ConfigError: as `load_radars`.
    """
    return _load_radars(path, overrides, Config, lambda config, _: config)


def _refuse_other_radar(document: Mapping[str, Any], override: Override) -> None:
    """Refuse an override of a key of one of `radars` that the config does not have."""
    first, *rest = override.key.split(".")
    names = radar_names(document)
    if first == RADARS_KEY and len(rest) > 1 and names and rest[0] not in names:
        raise ConfigError(
            f"{override.option}: {rest[0]} is none of the config's radars; "
            f"{did_you_mean(rest[0], names, 'it has ' + ', '.join(names))}"
        )


def _parse_overrides(overrides: Overrides) -> list[Override]:
    """Parse texts as `--set` takes them, or {key: value}, whose messages name the key alone.

    Raises:
        ConfigError: a text is no override, or a value cannot be written as YAML.
    """
    if isinstance(overrides, str):
        raise ConfigError(
            f"overrides = {_short(repr(overrides))}: should be a list of such texts, or a mapping "
            "such as {'snr_db': 5}"
        )
    if not isinstance(overrides, Mapping):
        return [Override.parse(one) if isinstance(one, str) else one for one in overrides]
    parsed = []
    for key, value in overrides.items():
        try:
            parsed.append(Override(OTHER_NAMES.get(key, key), json.dumps(value), "overrides"))
        except (TypeError, ValueError):
            raise ConfigError(
                f"{key} = {_short(repr(value))}: should be a plain value, as YAML has it"
            ) from None
    return parsed


def _read_values(source: Source, overrides: Overrides) -> tuple[dict[str, Any], Places, Options]:
    """Read the plain values of a config, their places, and the options that gave some of them."""
    parsed = _parse_overrides(overrides)
    of_base: dict[str, Any] = {}
    for override in parsed:
        if override.key == BASE:
            _apply(of_base, override)
    document, places = read_on_bases(source, of_base)
    options: Options = {}
    for override in parsed:
        if override.key == BASE:
            continue
        _refuse_other_radar(document, override)
        _apply(document, override)
        places = {k: v for k, v in places.items() if not _within(k, override.key)}
        if _is_cfg(names := override.key.split(".")):
            key = FILE_OF_CFG if names[0] == "radar" else file_of_cfg(names[1])
            places[key] = name_of_cfg(parse_yaml(override.text, override.option)[0])
        options[override.key] = override.option
    return document, places, options


def read_values(path: Path, overrides: Overrides = ()) -> dict[str, Any]:
    """Read the plain values of a config file and its bases under overrides, unchecked.

    Of several radars they are those of the chosen one.

    Args:
        path: YAML file.
        overrides: as of `load_config`.

    Raises:
        ConfigError: a file cannot be read, or is no YAML.
    """
    document, places, options = _read_values(path, overrides)
    if document.get(RADARS_KEY) is None:
        return document
    documents = _documents_of_radars(document, str(path), places, options)
    names = radar_names(document)
    chosen = document.get(NAME_KEY, names[0] if len(names) == 1 else None)
    if chosen is None:
        where = _locate(str(path), RADARS_KEY, places, options)
        raise ConfigError(f"{where}: {ask_for_one_radar(names)}")
    return documents[chosen].values


def config_of_values(values: dict[str, Any], folder: Path) -> Config:
    """Make a config of plain values, whose messages name keys but no file.

    Args:
        values: as `read_values` returns them, changed or not.
        folder: folder from which files of motion are named.

    Raises:
        ConfigError: they are no config.
    """

    def refuse(key: str, value: object, right: str) -> ConfigError:
        return ConfigError(f"{key}{_value_and_advice(Problem(key, value, right))}")

    try:
        config = validated(Config, values, "", {})
    except ConfigError as error:
        lines = str(error).splitlines()
        raise ConfigError("\n".join(line.removeprefix(": ") for line in lines)) from None
    return resolve_files(config, folder, refuse)


def validated(
    kind: type[S],
    document: Any,
    where: str,
    places: Places,
    options: Mapping[str, str] = {},
    written: RadarDocument | None = None,
) -> S:
    """Turn a parsed document into a config.

    Args:
        kind: class of the config.
        document: plain values, as a YAML file has them.
        where: file that messages name for keys without a place.
        places: {dotted key: file:line} of its keys, and of those of files under it.
        options: {dotted key: option} of keys that an option of the command line gives.
        written: places of the document's keys in a file of several radars; None in others.

    Raises:
        ConfigError: the document is no such config; a line for each of MAX_MISTAKES mistakes.
    """
    try:
        return kind.model_validate(document)
    except ValidationError as error:
        items = _mistakes_alone(error, document)
        mistakes = dict.fromkeys(
            _locate(where, _key_in_file(problem.key, written), places, options)
            + _value_and_advice(problem)
            if not _is_of_cfg(problem)
            else places.get(FILE_OF_CFG, "radar.cfg") + problem.right.removeprefix("radar.cfg")
            for problem in islice(_problems_of(kind, items, document, written), MAX_MISTAKES)
        )
        more = len(items) - MAX_MISTAKES
        messages = [*mistakes, f"{where}: and {more} more"] if more > 0 else [*mistakes]
        raise ConfigError("\n".join(messages)) from None


def _key_in_file(key: str, written: RadarDocument | None) -> str:
    """Dotted key that the file has for one of a document."""
    return key if written is None else written.key_in_file(key)


def _is_of_cfg(problem: Problem) -> bool:
    """Whether a mistake is one of a line of a .cfg, and not of the config."""
    return not problem.key and problem.right.startswith("radar.cfg:")


def with_overrides(document: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Change a document, in place, by texts ``key.sub=value``, and return it.

    Raises:
        ConfigError: a text is no key=value, or its value is no YAML.
    """
    for text in overrides:
        _apply(document, Override.parse(text))
    return document


def _apply(document: dict[str, Any], override: Override) -> None:
    """Write the value of an override into the document."""
    names = override.key.split(".")
    place = document
    for name in names[:-1]:
        inner = place.get(name)
        if isinstance(inner, list) and names[0] == "classes":
            inner = {"files": inner}  # the short form of a class of files
        place[name] = place = inner if isinstance(inner, dict) else {}
    value, _ = parse_yaml(override.text, override.option)
    if _is_cfg(names):
        value = cfg_text(value, Path(), override.option)
    place[names[-1]] = value


def _is_cfg(names: list[str]) -> bool:
    """Whether a key, by its names, is that of a TI .cfg: of `radar` or of one of `radars`."""
    return names == ["radar", "cfg"] or (
        len(names) == 3 and names[0] == RADARS_KEY and names[2] == "cfg"
    )


def _within(key: str, parent: str) -> bool:
    return key == parent or key.startswith(parent + ".")


# Pydantic's terms of Python in terms of YAML.
_WORDING = {
    "model_type": "should be a mapping of keys",
    "dict_type": "should be a mapping of keys",
    "tuple_type": "should be a list: [a, b]",
    "missing": "is required",
}


_FORM_OF_TWO = {
    "uniform": "[low, high]",
    "normal": "[mean, standard deviation]",
    "vary": "[nominal, fraction]",
}


def _mistakes_alone(error: ValidationError, document: Any) -> list[Any]:
    """Pydantic's errors, without those that only follow from another one.

    Pydantic counts a list's valid items alone, and takes a class without `files` for one of
    movements.
    """
    items = error.errors(include_url=False)
    parents = {item["loc"][:n] for item in items for n in range(len(item["loc"]))}

    def follows(item: Any) -> bool:
        if item["type"] == "too_short" and item["loc"] in parents:
            return bool(len(item["input"]) >= item["ctx"]["min_length"])
        names = _document_path(item["loc"], document)
        return (
            item["type"] == "extra_forbidden"
            and len(names) == 3
            and _kinds_of_class(names, document) == []
            and names[-1] in FilesConfig.model_fields
        )

    return [item for item in items if not follows(item)]


def _kinds_of_class(names: list[int | str], document: Any) -> list[type[BaseModel]] | None:
    """Kinds that a class of the document may be by its keys; None outside of `classes`."""
    if names[:1] != ["classes"] or len(names) < 3:
        return None
    its_keys = document["classes"].get(names[1])
    if isinstance(its_keys, (list, tuple)):  # the short form of a class of files
        return [FilesConfig]
    return [kind for key, kind in _CLASS_KINDS.items() if key in (its_keys or ())]


def _problems_of_missing(
    key: str, names: list[Any], beside: object, lacking: int, radar: type[AnyRadar]
) -> Iterator[Problem]:
    """Problem of a value that is missing, of lists that of the first one.

    Args:
        key: dotted key of the value.
        names: parts of the key.
        beside: list or mapping that lacks it.
        lacking: number of values that are missing beside each other.
        radar: kind of radar, which its section is named by.
    """
    if names[-2:-1] and names[-2] in _FORM_OF_TWO:
        form = f"should be {_FORM_OF_TWO[str(names[-2])]}"
        yield Problem(key.removesuffix(f".{names[-1]}"), beside, form)
    elif isinstance(beside, list | tuple):
        if str(names[-1]) == str(len(beside)):
            few = f"should be a list of {len(beside) + lacking} values, not of {len(beside)}"
            yield Problem(key.removesuffix(f".{names[-1]}"), beside, few)
    else:
        place = f" with {radar.named}" if names[:1] == ["radar"] else ""
        yield Problem(key, _MISSING, f"{_WORDING['missing']}{place}")


def _problems_of(
    kind: type[BaseModel],
    items: Iterable[Any],
    document: Any,
    written: RadarDocument | None = None,
) -> Iterator[Problem]:
    items = list(items)
    for item in items:
        if item["type"] == "across":
            yield from item["ctx"]["problems"]
            continue
        names = _document_path(item["loc"], document)
        key = ".".join(str(name) for name in names)
        if item["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
            beside = () if written is None else written.known_beside(key)
            advice = _unknown(kind, names, item["input"], document, beside)
            if written is not None and advice.startswith("is unknown with "):
                advice += f" ({RADARS_KEY}.{written.name})"  # others may be of that kind
            yield Problem(key, item["input"], advice)
        elif item["type"] == "missing" and _kinds_of_class(names, document) == []:
            right = "should have a `sequence` of movements, or `files` of motion"
            yield Problem(key.removesuffix(".sequence"), item["input"], right)
        elif called := _our_word(names, item):
            yield Problem(key, item["input"], called)
        else:
            message = _WORDING.get(item["type"], item["msg"])
            radar = next((r for r in RADARS if f"<{r.kind}>" in item["loc"]), FmcwRadar)
            if item["type"] == "missing":
                lacking = sum(
                    one["type"] == "missing" and one["loc"][:-1] == item["loc"][:-1]
                    for one in items
                )
                yield from _problems_of_missing(key, names, item["input"], lacking, radar)
                continue
            if item["type"] == "tuple_type" and _holds_sections(kind, names, document):
                message = "should be a list of sections: [{}, {}]"
            if names == ["radar", "waveform"]:
                message = f"{message} with {radar.named}"
                if radar.kind == "board":
                    message += "; cfg: null leaves out that of a base, or of what all radars have"
            if key == "radar" and item["type"] == "wrong" and isinstance(item["input"], dict):
                yield Problem("radar.waveform", item["input"].get("waveform"), message)
                continue
            message = message.removeprefix("Tuple ").replace(" after validation", "")
            if not message.startswith(("should", "'")):
                message = message[0].lower() + message[1:]
                message = message.removeprefix("input ")
            message += _advice_on_frequency(names, item)
            yield Problem(key, item["input"], _advice_on_number(kind, names, item, message))


def _our_word(names: list[int | str], item: Any) -> str | None:
    """Advice on a map by another name, such as RDM, or a split by persons; None without any."""
    plain = re.sub("[- ]", "_", str(item["input"]).lower())
    if names == ["split", "by"] and plain.rstrip("s") in PERSONS:
        return "should be subject: split: {by: subject, subjects: 4}"
    if names[:1] != ["maps"]:
        return None
    return ABSENT.get(plain) or (f"is called {plain}" if f"'{plain}'" in item["msg"] else None)


def _advice_on_frequency(names: list[int | str], item: Any) -> str:
    """Return the advice that a frequency below its least one is in Hz, not in GHz or MHz; or ""."""
    key, value = ".".join(str(name) for name in names), item["input"]
    least = item.get("ctx", {}).get("ge")
    if item["type"] != "greater_than_equal" or unit_of(key) != "hz" or not 0 < value < least:
        return ""
    prefix, power = ("G", 9) if names[-1] == "carrier_hz" else ("M", 6)
    return f" Hz ({value:g} {prefix}Hz is {value:g}e{power})"


def _advice_on_number(
    kind: type[BaseModel], names: list[int | str], item: Any, message: str
) -> str:
    """Advice on a text in the place of a number: the number in our unit, or its range."""
    value = item["input"]
    if isinstance(value, dict) and "per_activity" in value and "number" in message:
        return f"has no per_activity, it is the same for every activity: {message}"
    if not isinstance(value, str) or "number" not in message:
        return message
    if names[-2:-1] in (["normal"], ["vary"]) and names[-1] == 1:
        return message  # no number of the key itself
    if len(names) > 2 and names[-2] in FORMS:
        names = names[:-2]
    key = ".".join(str(name) for name in names)
    with_unit = value_with_unit(key, value)
    if with_unit is not None:
        return with_unit
    reach = range_of(kind, re.sub(r"\.\d+\b", "", key))
    return f"{message}, {reach}" if reach else message


def _document_path(location: tuple[int | str, ...], document: Any) -> list[int | str]:
    """Drop from a pydantic location the tags of unions, which are no keys of the document."""
    names: list[int | str] = []
    place = document
    for name in location:
        if isinstance(place, dict) and name in place:
            place = place[name]
        elif isinstance(place, (list, tuple)) and isinstance(name, int):
            place = place[name] if name < len(place) else None
        elif name in _UNION_TAGS or (
            isinstance(name, str) and (not isinstance(place, dict) or "[" in name)
        ):
            continue  # a tag, or pydantic's own name of a union's member
        else:
            place = None
        names.append(name)
    return names


def _unknown(
    kind: type[BaseModel],
    names: list[int | str],
    value: object,
    document: Any,
    beside: tuple[str, ...],
) -> str:
    """Advice on an unknown key; `beside` are names that may stand there and are no fields."""
    if misplaced := MISPLACED.get(".".join(map(str, names))):
        return misplaced
    if issubclass(kind, Config) and (absent := ABSENT.get(str(names[-1]))):
        return absent
    of_person = names[2:] if names[:1] == ["people"] else names
    if moved := MOVED_KEYS.get(".".join(map(str, of_person))):
        return f"is now {moved}"
    place = _section_around(kind, names, document)
    places = _kinds_of_class(names, document) if len(names) == 3 else None
    if places is None:
        places = [] if place is None else [place]
    elif len(places) > 1:
        if names[-1] in _CLASS_KINDS:
            return "should be left out: a class has a `sequence` or `files`, not both"
        places = [FilesConfig]
    elif not places:
        places = [*_CLASS_KINDS.values()]
    if not places:
        return "is an unknown key"
    if elsewhere := _why_of_another(places[0], str(names[-1])):
        return elsewhere
    if (
        issubclass(kind, Config)
        and len(names) > 1
        and names[-1] in {*Config.model_fields} - {*beside}
    ):
        return (
            f"is not a key of {'.'.join(map(str, names[:-1]))}: {names[-1]} stands at the top level"
        )
    known = [*(name for one in places for name in one.model_fields), *beside]
    paths = [path for listed in _paths_of_groups(places[0]).values() for path in listed]
    if in_our_unit := key_in_our_unit(str(names[-1]), value, [*known, *paths]):
        return f"is an unknown key; {in_our_unit}"
    if deeper := _keys_of_groups(str(names[-1]), places[0]):
        return f"is an unknown key; did you mean {' or '.join(map(repr, deeper))}?"
    with_unit = [key for key in known if unit_of(key) and key.rpartition("_")[0] == names[-1]]
    if with_unit:
        return f"is an unknown key; did you mean {with_unit[0]!r}?"
    return "is an unknown key; " + did_you_mean(
        str(names[-1]), known, f"known here: {', '.join(known)}"
    )


def _section_of(field: FieldInfo, value: Any) -> type[BaseModel] | None:
    """Section that a field holds: of several that it may, the one that its value tells."""
    kinds = sections(field)
    return class_of_radar(value) if len(kinds) > 1 else next(iter(kinds), None)


def _section_around(
    kind: type[BaseModel], names: list[int | str], document: Any
) -> type[BaseModel] | None:
    """Section that a key of the document lies in; None below a key that is no section."""
    place: type[BaseModel] | None = kind
    for name in names[:-1]:
        document = document.get(name) if isinstance(document, dict) else None
        if isinstance(name, str):  # no place in a list of sections
            field = place.model_fields.get(name) if place else None
            place = _section_of(field, document) if field else None
    return place


def _keys_of_groups(name: str, section: type[BaseModel]) -> list[str]:
    """Find the keys most like a name in the groups of a section, as "walking.speed_mps"."""
    leaves = _paths_of_groups(section)
    if difflib.get_close_matches(name, section.model_fields, n=1, cutoff=0.6):
        return []
    near = difflib.get_close_matches(name, leaves, n=1, cutoff=0.75)
    return leaves[near[0]] if near else []


def _paths_of_groups(section: type[BaseModel]) -> dict[str, list[str]]:
    """{last name: dotted keys that end with it} of the groups of a section."""
    paths: dict[str, list[str]] = {}
    for group, field in section.model_fields.items():
        for leaf in dict.fromkeys(leaf for kind in sections(field) for leaf in kind.model_fields):
            paths.setdefault(leaf, []).append(f"{group}.{leaf}")
    return paths


def _why_of_another(kind: type[BaseModel], key: str) -> str | None:
    """Describe the radars that have a key which this kind does not know; None if none has it."""
    if not issubclass(kind, AnyRadar):
        return None
    if key == "frame" and not issubclass(kind, ArrayRadar):
        *others, last = KINDS_WITH_FRAMES
        waveforms = f"{', '.join(others)} and {last}"
        return f"should be left out with {kind.named}: {waveforms} have frames"
    owners = [other.named for other in RADARS if key in other.model_fields]
    if not owners:
        return None
    reason = ""
    if hasattr(kind, key):
        gives = "gives it" if isinstance(getattr(kind, key), property) else "has none"
        reason = f", which {gives}"
    listed = " and ".join(filter(None, [", ".join(owners[:-1]), owners[-1]]))
    leave_out = f"{key}: null leaves out that of a base, or of what all radars have"
    return f"is unknown with {kind.named}{reason}; it is a key of {listed}; {leave_out}"


def _holds_sections(kind: type[BaseModel], names: list[int | str], document: Any) -> bool:
    """Whether a key is of a list of sections, such as `people`."""
    place = _section_around(kind, names, document)
    field = place.model_fields.get(str(names[-1])) if place else None
    return field is not None and bool(sections(field))


def _locate(where: str, key: str, places: Places, options: Mapping[str, str]) -> str:
    """Location of a value, "file:line: key", or the option of the command line that gave it."""
    within = [option for name, option in options.items() if _within(name, key)]
    of_options = [option for name, option in options.items() if _within(key, name)]
    of_options = of_options or (within if key not in places else [])
    if of_options:
        option = of_options[-1]
        if _within(key, "classes") and not option.startswith("--set "):
            return option  # of --motion, whose user has typed no key
        return option if option.endswith(f" {key}") else f"{option}: {_short(escaped(key))}"
    place = places.get(key)
    parent = key
    while place is None and "." in parent:
        parent = parent.rpartition(".")[0]
        place = places.get(parent)
    key = _short(escaped(key).replace("\n", "\\n")) + (f" ({', '.join(within)})" if within else "")
    return f"{place or where}: {key}"


def _value_and_advice(problem: Problem) -> str:
    if not problem.key:  # of the whole
        return _short(problem.right, MAX_ADVICE)
    value = problem.value
    if value is _MISSING:
        return f": {_short(problem.right, MAX_ADVICE)}"
    shown_value = _short(json.dumps(value, default=_plain))
    right = problem.right + _advice_on_unit(problem)
    if problem.key.partition(".")[0] in ("radar", RADARS_KEY, "preset", "device"):
        name_advice = advice_on_radars(value)
        right = f"{right.partition('; known here')[0]}; {name_advice}" if name_advice else right
    return f" = {shown_value}: {_short(right, MAX_ADVICE)}"


def _advice_on_unit(problem: Problem) -> str:
    """Return the advice which unit would bring a number into its range; "" where none does."""
    reach = re.match(r"should be from (\S+) to (\S+)", problem.right)
    value = problem.value
    if isinstance(value, dict) and len(value) == 1:  # a distribution
        (value,) = value.values()
    numbers = value if isinstance(value, (list, tuple)) else [value]
    if reach is None or not numbers or not isinstance(numbers[0], (int, float)):
        return ""
    try:
        low, high = float(reach[1]), float(reach[2].rstrip(",;"))
    except ValueError:
        return ""
    meant = number_in_another_unit(problem.key, float(numbers[0]), low, high)
    return "" if meant is None else f"; {meant}"


def _short(text: str, length: int = MAX_VALUE) -> str:
    return text if len(text) <= length else text[: length - 3] + "..."


def _plain(value: object) -> object:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", exclude_none=True)
    if isinstance(value, PerActivity):
        return {"per_activity": value.per_activity}
    return str(value)
