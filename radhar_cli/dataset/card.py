"""The data card, README.md: a data set described for readers and for the Hugging Face Hub."""

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from radhar_cli.config.identity import NOT_IDENTITY, differences
from radhar_cli.config.schema import Config
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.layout import CARD, GALLERY, SPLITS, Rows, column_axis, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import number_names
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.untrusted import read_text

MAX_CARD = 2**20
MAX_VALUE = 200  # characters of a config's value
SIZES = ("n<1K", "1K<n<10K", "10K<n<100K", "100K<n<1M", "1M<n<10M", "10M<n<100M", "n>100M")
_LICENCE = ("license", "license_name", "license_link")
_FRONT = re.compile(r"\s*---\n(.*?)\n---(?:\n|$)", re.DOTALL)
# {configuration: {split: files}}
Files = Mapping[str, Mapping[str, str]]

_NOISE_TELLS = (
    "noise alone tells `stationary` from most classes, as levels are relative to what the "
    "canceller leaves of the echo; `processing.clutter: mean` keeps slow motion"
)
_SIMULATED = (
    "nobody was recorded: a network that is accurate on simulated data need not be so on a real "
    "radar"
)
BIBTEX = """\
@article{gao2025radharsimulator,
  title = {RadHARSimulator V1: Model-Based FMCW Radar Human Activity Recognition Simulator},
  author = {Gao, Weicheng},
  year = {2025},
  journal = {arXiv preprint arXiv:2509.06751},
  doi = {10.48550/arXiv.2509.06751}
}

@software{radhar,
  title = {radhar: labelled FMCW radar data sets for human activity recognition},
  author = {{The radhar authors}},
  version = {VERSION}
}
"""


def number_features(config: Config) -> list[dict[str, Any]]:
    """Columns of numbers, as `datasets` writes them down: index, and what was drawn."""
    kinds = {"index": "int64"} | ({"labels": "string"} if config.people else {})
    kinds |= {n: "int64" if n == "subject" else "float64" for n in number_names(config)}
    return [{"name": name, "dtype": kind} for name, kind in kinds.items()]


def configurations(config: Config, files: Files) -> list[dict[str, Any]]:
    """`configs` of the front matter: files of each split, and columns (image, label, numbers)."""
    names = {str(a.index): a.slug for a in config.every_class}
    label = {"name": "label", "dtype": {"class_label": {"names": names}}}
    features = [{"name": "image", "dtype": "image"}, label, *number_features(config)]
    return [
        {
            "config_name": name,
            "data_files": [{"split": split, "path": path} for split, path in parts.items()],
            "features": features,
        }
        for name, parts in files.items()
    ]


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


def owner_licence(folder: Path) -> dict[str, Any]:
    """What the card in a folder says of the licence, which its owner may have chosen.

    Raises:
        FolderError: the card cannot be read.
    """
    matter = front_matter(folder / CARD) if (folder / CARD).exists() else {}
    return {key: matter[key] for key in _LICENCE if matter.get(key) is not None}


def card(data: Dataset, more: Mapping[str, Any], reading: str) -> str:
    """The text of README.md.

    Args:
        data: the data set.
        more: front matter: what `load_dataset` reads, and a licence where it is not the config's.
        reading: Markdown, how to read the files next to the card.
    """
    config, measured = data.config, data.config.recorded is not None
    title = f"{'Measured' if measured else 'Simulated'} radar maps of human activities"
    front = {
        "license": config.output.license or "unknown",
        "pretty_name": title,
        "task_categories": ["image-classification"],
        "size_categories": [SIZES[sum(len(data) >= 10**n for n in range(3, 9))]],
        **more,
    }
    licence, version = front["license"], data.file.text("radhar_version")
    if licence == "unknown":
        licence = "not chosen; who publishes this puts it into the first lines of this file"
    parts = [
        f"---\n{yaml.safe_dump(front, sort_keys=False, default_flow_style=None, width=100)}---",
        f"# {title}",
        f"![Some samples of each class]({GALLERY})",
        _summary(data),
        reading,
        _maps(data),
        _classes(data),
        "## How it was made",
        _making(data),
        "## Known biases and limits",
        "\n".join(f"- {' '.join(one.split())}" for one in _limits(data)),
        "## Licence and citation",
        f"Licence: {' '.join(str(licence).split())}. Please cite:",
        f"```bibtex\n{BIBTEX.replace('VERSION', version)}```",
    ]
    return "\n\n".join(parts) + "\n"


def _table(head: Sequence[str], lines: Sequence[Sequence[object]]) -> str:
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join(f"| {' | '.join(map(str, row))} |" for row in rows)


def _summary(data: Dataset) -> str:
    config, (height, width) = data.config, data.config.image.size_px
    maps, recorded = len(config.maps), config.recorded
    if recorded is not None:
        what = f"what a radar recorded of people, cut into windows of {recorded.window_s:g} s."
    else:
        whom = "several moving people" if config.people else "one moving person"
        where = "through a wall" if config.wall is not None else "in free space"
        what = f"what an FMCW radar sees of {whom} {where}, simulated from the movement to the map."
    split = "Samples are split one by one."
    if config.split.subjects is not None:
        split = f"Split by person: none of the {config.split.subjects} is in two of its parts."
    return (
        f"{len(data):,} samples of {len(config.chosen_activities)} classes, {maps} "
        f"map{'s' * (maps > 1)} of each, {height} x {width} pixels: {what} {split}\n\n"
        "Columns: `label`, `index` (which sample of its class) and what was drawn, in SI units, "
        "empty where it does not apply; /scene of dataset.h5 has units and keys of config.yaml."
    )


def _maps(data: Dataset) -> str:
    lines = []
    for name in data.config.maps:
        edges = data.extent(name)
        reach = ", ".join(f"{edge:.5g}" for edge in edges) if edges else "/extent of dataset.h5"
        axes = (f"{quantity}, {unit}" for quantity, unit in (row_axis(name), column_axis(name)))
        lines.append([f"`{name}`", *axes, reach])
    image = data.config.image
    level = (
        f"255 is the largest power of the image, 0 is {image.dynamic_range_db:g} dB below it or "
        "less, linear in dB between"
        if image.kind == "decibel"
        else "255 where the cell exceeds its CFAR threshold, else 0"
    )
    table = _table(("map", "rows", "columns", "left, right, bottom, top"), lines)
    return f"{table}\n\nA pixel is a grey level: {level}. What comes nearer has positive Doppler."


def _classes(data: Dataset) -> str:
    present, lines = data.present_splits, []
    for activity, rows in Rows.of(data.config).classes():
        counts = np.bincount(data.split[rows], minlength=len(SPLITS))
        lines.append([activity.index, f"`{activity.slug}`", *(counts[n] for n in present)])
    others = ""
    if data.labels is not None:
        shown = zip(data.class_slugs, data.labels.sum(axis=0).tolist(), strict=True)
        listed = ", ".join(f"`{slug}` {count}" for slug, count in shown if count)
        others = (
            "\n\nThe class is what the sample's main person does. Others are there too: column "
            f"`labels` has what anybody does ({listed})."
        )
    return _table(["label", "class", *present.values()], lines) + others


def _making(data: Dataset) -> str:
    """The command, versions, and in a fold what the config says."""
    config = data.config
    made = ", ".join(f"{library} {version}" for library, version in data.versions.items())
    if config.recorded is not None:
        return f"`radhar generate --recordings`, seed {config.seed}; {made}."
    keys = "\n".join(
        f"{key}: {json.dumps(value)[:MAX_VALUE]}"
        for key, (_, value) in differences(Config(), config).items()
        if key not in NOT_IDENTITY
    )
    return (
        f"`radhar generate config.yaml -o OUT`, seed {config.seed}, makes the same bytes again "
        f"with {made}.\n\n<details><summary>Keys of config.yaml that are not the defaults</summary>"
        f"\n\n```yaml\n{keys}\n```\n\n</details>"
    )


def _limits(data: Dataset) -> list[str]:
    config, notes = data.config, [str(warning["message"]) for warning in data.warnings]
    if config.recorded is not None:
        return [*notes, "config.yaml names files and persons as the recordings' manifest does"]
    if config.snr_db is not None and config.processing.clutter in ("difference", "highpass"):
        notes.append(_NOISE_TELLS)
    return [*notes, _SIMULATED]
