"""The data card, README.md: a data set described for readers and for the Hugging Face Hub."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from radhar_cli.config.schema import MAP_NAMES, Config
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.layout import CARD, GALLERY, SPLITS, Rows, column_axis, png_folder, row_axis
from radhar_cli.dataset.reading import BLOCK, Dataset
from radhar_cli.dataset.scene_fields import ERROR
from radhar_cli.dataset.table import number_names
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.untrusted import read_text

MAX_CARD = 2**20
_LICENCE = ("license", "license_name", "license_link")
_FRONT = re.compile(r"\s*---\n(.*?)\n---(?:\n|$)", re.DOTALL)
# {configuration: {split: files}}
Files = Mapping[str, Mapping[str, str]]

_KINDS = {
    "rtm": "range over time",
    "stft": "Doppler over time, by a short-time Fourier transform",
    "fsst": "Doppler over time, by the synchrosqueezed short-time Fourier transform",
}
_NOISE_TELLS = (
    "the less a person moves, the more noise an image shows: `snr_db` is that of the whole echo, "
    "the canceller removes what hardly moves, and levels are relative to what is left. So the "
    "noise alone tells `stationary` from most others; with `processing.clutter: mean`, which keeps "
    "slow motion, it tells little"
)
_STEPS = {"compensated": "the torso's bulk Doppler taken off", "denoised": "denoised"}
_SIZES = ((10**3, "n<1K"), (10**4, "1K<n<10K"), (10**5, "10K<n<100K"), (10**6, "100K<n<1M"),
          (10**7, "1M<n<10M"), (10**8, "10M<n<100M"))  # fmt: skip
BIBTEX = """\
@article{gao2025radharsimulator,
  title = {RadHARSimulator V1: Model-Based FMCW Radar Human Activity Recognition Simulator},
  author = {Gao, Weicheng},
  year = {2025},
  journal = {arXiv preprint}
}

@software{radhar,
  title = {radhar: labelled FMCW radar data sets for human activity recognition},
  author = {{The radhar authors}},
  version = {VERSION}
}
"""


def png_files(data: Dataset) -> Files:
    """The configurations of a folder with PNGs: one a map."""
    present = data.present_splits
    return {
        name: {split: f"{png_folder(name, n).as_posix()}/**" for n, split in present.items()}
        for name in data.config.maps
    }


def features(config: Config) -> list[dict[str, Any]]:
    """Columns of a configuration, as `datasets` writes them down."""
    names = {str(a.index): a.slug for a in config.every_class}
    return [
        {"name": "image", "dtype": "image"},
        {"name": "label", "dtype": {"class_label": {"names": names}}},
        *number_features(config),
    ]


def number_features(config: Config) -> list[dict[str, Any]]:
    """The columns of numbers among them: index, and what was drawn."""
    whole, names = ("index", "subject"), number_names(config)
    kinds = {"index": "int64"} | ({"labels": "string"} if config.people else {})
    kinds |= {name: "int64" if name in whole else "float64" for name in names}
    return [{"name": name, "dtype": kind} for name, kind in kinds.items()]


def data_files(files: Files) -> list[dict[str, Any]]:
    """`configs` of the front matter: the files of each split of each configuration."""
    return [
        {
            "config_name": name,
            "data_files": [{"split": split, "path": path} for split, path in parts.items()],
        }
        for name, parts in files.items()
    ]


def configurations(config: Config, files: Files) -> list[dict[str, Any]]:
    """`configs` of the front matter where the columns of each are those of `features`."""
    return [{**one, "features": features(config)} for one in data_files(files)]


def front_matter(path: Path) -> dict[str, Any]:
    """The front matter of a card, which may have been edited; empty where it has none.

    Raises:
        FolderError: the card cannot be read.
    """
    try:
        found = _FRONT.match(read_text(path, MAX_CARD).replace("\r\n", "\n"))
        document, _ = parse_yaml(found[1] if found else "", path.name)
    except (OSError, UnicodeDecodeError, ConfigError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FolderError(f"{path}: cannot be read ({reason})") from None
    return document if isinstance(document, dict) else {}


def owner_licence(folder: Path) -> dict[str, str | list[str]]:
    """What the card in a folder says of the licence, which its owner may have chosen.

    Raises:
        FolderError: the card cannot be read, or says something else than names of licences.
    """
    path = folder / CARD
    matter = front_matter(path) if path.exists() else {}
    licence = {key: matter[key] for key in _LICENCE if matter.get(key) is not None}
    for key, value in licence.items():
        names = value if isinstance(value, list) else [value]
        if not all(isinstance(name, str) and name.isprintable() for name in names):
            raise FolderError(f"{path}: {key}: should be text on one line, such as cc-by-4.0")
    return licence


def card(data: Dataset, more: Mapping[str, Any], reading: str) -> str:
    """The text of README.md.

    Args:
        data: the data set.
        more: front matter: what `load_dataset` reads, and a licence where it is not the config's.
        reading: Markdown, how to read the files next to the card.
    """
    config, count = data.config, len(data)
    measured = config.recorded is not None
    front = {
        "license": config.output.license or "unknown",
        "task_categories": ["image-classification"],
        "tags": ["radar", "fmcw", "micro-doppler", "human-activity-recognition", "radhar"]
        + ([] if measured else ["synthetic"]),
        "size_categories": [next((name for most, name in _SIZES if count < most), "n>100M")],
        **more,
    }
    title = f"{'Measured' if measured else 'Simulated'} radar maps of human activities"
    parts = [
        f"---\n{yaml.safe_dump(front, sort_keys=False, default_flow_style=None, width=100)}---",
        f"# {title}",
        _summary(data),
        f"![Some samples of each class]({GALLERY})",
        "## Reading it",
        reading,
        "## Maps",
        _maps(data),
        "## Classes and split",
        _classes(data),
        "## Numbers of a sample",
        _numbers(data),
        "## What to know before using it",
        _cautions(data),
        "## How it was made",
        _making(data),
        "## Licence and citation",
        _licence(front["license"]),
        f"```bibtex\n{BIBTEX.replace('VERSION', data.file.text('radhar_version'))}```",
    ]
    return "\n\n".join(parts) + "\n"


def table(head: Sequence[str], lines: Sequence[Sequence[object]]) -> str:
    """A Markdown table."""
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join(f"| {' | '.join(map(str, row))} |" for row in rows)


def _summary(data: Dataset) -> str:
    config, (height, width) = data.config, data.config.image.size_px
    classes, maps = len(config.chosen_activities), len(config.maps)
    what = (
        f"{len(data):,} samples of {classes} classes, {maps} map{'s' * (maps > 1)} of each, "
        f"{height} x {width} pixels: "
    )
    if config.recorded is not None:
        return (
            f"{what}what a radar recorded of people, cut into windows of "
            f"{config.recorded.window_s:g} s."
        )
    whom = "several moving people" if config.people else "one moving person"
    walled = "through a wall" if config.wall is not None else "in free space"
    return (
        f"{what}what an FMCW radar sees of {whom} {walled}, simulated from a model of "
        "the body, the waves and the receiver. No person was recorded. Every number of a scene "
        "(who moves, where, how fast, how much noise) was drawn, and stands beside its image."
    )


def _maps(data: Dataset) -> str:
    lines = []
    for name in data.config.maps:
        first, *steps = name.split("_")
        says = "a product of its builder's own"
        if name in MAP_NAMES:
            says = ", ".join([_KINDS[first], *(_STEPS[step] for step in steps)])
        edges, unit, across = data.extent(name), row_axis(name)[1], column_axis(name)[1]
        if edges is None:
            lines.append([f"`{name}`", says, "/extent", "/extent"])
            continue
        left, right, bottom, top = edges
        lines.append(
            [
                f"`{name}`",
                says,
                f"{bottom:.6g} to {top:.6g} {unit}",
                f"{left:.4g} to {right:.4g} {across}",
            ]
        )
    image = data.config.image
    level = (
        f"255 is the largest power of the image, 0 is {image.dynamic_range_db:g} dB below it or "
        "less, linear in dB between"
        if image.kind == "decibel"
        else "255 where the cell exceeds its CFAR threshold, else 0"
    )
    edges_differ = (
        ""
        if all(data.extent(name) for name in data.config.maps)
        else (" Where edges differ from sample to sample they are in /extent of dataset.h5.")
    )
    return (
        table(["map", "power", "rows, bottom to top", "columns, left to right"], lines)
        + f"\n\nA pixel is a grey level: {level}. What comes nearer has positive Doppler."
        + edges_differ
    )


def _classes(data: Dataset) -> str:
    present = data.present_splits
    lines = []
    for activity, rows in Rows.of(data.config).classes():
        counts = np.bincount(data.split[rows], minlength=len(SPLITS))
        lines.append([activity.index, f"`{activity.slug}`", *(counts[n] for n in present)])
    others = ""
    if data.labels is not None:
        shown = zip(data.class_slugs, data.labels.sum(axis=0).tolist(), strict=True)
        listed = ", ".join(f"`{slug}` {count}" for slug, count in shown if count)
        others = (
            "\n\nThe class is what the sample's own person does. Others are there too: column "
            f"`labels` has what anybody does ({listed})."
        )
    by = "sample: every sample was drawn on its own"
    if data.config.split.subjects is not None:
        by = f"person: none of the {data.config.split.subjects} is in two of its parts"
    return table(["label", "class", *present.values()], lines) + f"{others}\n\nSplit by {by}."


def _numbers(data: Dataset) -> str:
    """What was drawn, from where to where, and what all samples share."""
    units = {field.name: "" if field.unit == "1" else field.unit for field in data.fields}
    keys = {field.name: (units[field.name], f"`{field.key}`") for field in data.fields}
    keys |= {
        "subject": ("", "number of the person"),
        ERROR.name: (ERROR.unit, "measured: error of the simulated signal"),
    }
    drawn, shared = [], []
    for name in number_names(data.config):
        (low, high), (unit, key) = _reach(data, name), keys[name]
        if low < high:
            drawn.append([f"`{name}`", f"{low:.6g}", f"{high:.6g}", unit, key])
        elif low == high:
            shared.append([f"`{name}`", f"{low:.6g}", unit, key])
    parts = [
        "Columns beside the label, in SI units; empty where a number does not apply to the "
        "activity. `index` counts the samples of a class: label and index name a sample in every "
        "form of this data set.",
        table(["column", "smallest", "largest", "unit", "drawn by (config.yaml)"], drawn),
        "The same in all samples that it applies to:",
        table(["column", "value", "unit", "config.yaml"], shared),
    ]
    return "\n\n".join(parts if shared else parts[:2])


def _reach(data: Dataset, name: str) -> tuple[float, float]:
    """Smallest and largest of a column's numbers; (inf, -inf) of none."""
    low, high = np.inf, -np.inf
    for start in range(0, len(data), BLOCK):
        values = data.scene[name].rows(start, start + BLOCK).astype(float)
        values = values[~np.isnan(values)]
        low, high = values.min(initial=low), values.max(initial=high)
    return float(low), float(high)


def _cautions(data: Dataset) -> str:
    config, notes = data.config, [str(warning["message"]) for warning in data.warnings]
    if config.recorded is None:
        if config.snr_db is not None and config.processing.clutter in ("difference", "highpass"):
            notes.append(_NOISE_TELLS)
        notes.append(
            "simulated data: a network that is accurate on them need not be so on a real radar"
        )
    else:
        notes.append("config.yaml names files and persons as the manifest of the recordings does")
    return "\n".join(f"- {' '.join(message.split())}" for message in notes)


def _making(data: Dataset) -> str:
    config = data.config
    made = ", ".join(
        f"no {library}" if version == "none" else f"{library} {version}"
        for library, version in data.versions.items()
    )
    if config.recorded is not None:
        return f"`radhar generate --recordings`, seed {config.seed}; {made}."
    return (
        f"`radhar generate config.yaml -o OUT`, seed {config.seed}, makes the same bytes again "
        f"with {made}. Motion: `{config.motion.model}`; echo: `{config.engine.kind}` engine."
    )


def _licence(name: str | list[str]) -> str:
    if name == "unknown":
        return (
            "No licence was chosen: who publishes this data set puts one at `license:` in the "
            "first lines of this file. Please cite:"
        )
    names = name if isinstance(name, str) else ", ".join(name)
    return f"Licence: {names}. Please cite:"
