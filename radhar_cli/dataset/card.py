"""The data card, README.md: a data set described for its readers."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from PIL import Image, ImageDraw, ImageFont

from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.radar import BoardRadar, FramesRadar
from radhar_cli.dataset.card_contents import (
    describe_arrays,
    describe_classes,
    describe_people,
    describe_streams,
)
from radhar_cli.dataset.file_description import describe_levels
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.image_tables import hub_configs
from radhar_cli.dataset.layout import CARD, GALLERY, Rows, column_axis, row_axis
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.stream_files import draw_streams
from radhar_cli.files.replacing import refuse_links
from radhar_cli.files.table_text import markdown_table
from radhar_cli.schema.number import nominal

_WAVEFORMS = {
    "fmcw": "an FMCW",
    "sfcw": "a stepped-frequency",
    "cw": "a CW",
    "impulse": "an impulse",
}
SIDE, GAP, LINE, MARGIN = 160, 6, 18, 64  # px
SIZES = ("n<1K", "1K<n<10K", "10K<n<100K", "100K<n<1M", "1M<n<10M", "10M<n<100M", "n>100M")

_NOISE_TELLS = (
    "noise alone tells {} from most classes, as levels are relative to what the "
    "canceller leaves of the echo; `processing.clutter: mean` keeps slow motion"
)
_SIMULATED = (
    "nobody was recorded: a network that is accurate on simulated data need not be so on a real "
    "radar"
)
_READING = """\
`dataset.h5` holds everything for h5py and MATLAB: `/maps/<map>`, `/label`, `/split`,
`/scene/<column>`. `radhar convert . -o OUT --to parquet`, or `--to webdataset`, makes other forms.
A label is the same number in all of them: its place in the table of classes below."""
_READING_PNGS = """

```python
import datasets
from torchvision.datasets import ImageFolder

data = datasets.load_dataset("FOLDER OR NAME ON THE HUB", "{0}")  # one configuration a map
names = data["train"].features["label"].names

train = ImageFolder("png/{0}/train")  # numbered by the alphabet; the next line gives our labels
train.target_transform = [names.index(name) for name in train.classes].__getitem__
```

`png/{0}/classes.txt` has these names too."""
BIBTEX = """\
@article{gao2025radharsimulator,
  title = {RadHARSimulator V1: Model-Based FMCW Radar Human Activity Recognition Simulator},
  author = {Gao, Weicheng},
  year = {2025},
  journal = {arXiv preprint arXiv:2509.06751},
  doi = {10.48550/arXiv.2509.06751},
  url = {https://arxiv.org/abs/2509.06751}
}

@software{radhar,
  title = {radhar: labelled FMCW radar data sets for human activity recognition},
  author = {{The radhar authors}},
  year = {2026},
  version = {VERSION},
  note = {Python program, MIT licence}
}
"""


GALLERY_STREAMS = 4


MORE = (describe_arrays, describe_people, describe_streams)
# `radhar audit` replaces what stands between the marks.
_TOLD_APART = """\
<!-- radhar audit -->
## Who is told apart by what

Not audited yet: `radhar audit .` tells how well the class is guessed from place, onset, noise and
other numbers that are not the movement, and writes it here.
<!-- end of radhar audit -->"""


def write_card(source: Path, folder: Path) -> None:
    """Write README.md and its picture into an output folder that lacks them.

    Args:
        source: dataset.h5, or the file that is going to be renamed to it.
        folder: output folder.
    """
    missing = [name for name in (CARD, GALLERY) if not (folder / name).exists()]
    for name in missing:
        refuse_links(folder, folder / name)
    if not missing:
        return
    with Dataset(source) as data:
        name = next(
            (map_name for map_name in data.config.maps if map_name != "rtm"), data.config.maps[0]
        )
        if GALLERY in missing:
            write_whole(folder, folder / GALLERY, draw_gallery(data, name))
        if CARD not in missing:
            return
        more: dict[str, Any] = {}
        reading = _READING
        if data.config.output.png:
            more["configs"] = hub_configs(data.config, data.split)
            reading += _READING_PNGS.format(name)
        picture = f"![{name}, one sample of each class]({GALLERY})\n\n{_describe_axes(data, name)}"
        text = compose_card(data, more, f"{picture}\n\n{reading}")
        write_whole(folder, folder / CARD, text.encode())


def draw_gallery(data: Dataset, name: str) -> bytes:
    """Draw map `name` of the first sample of each of the first 16 classes; return the PNG file.

    Of streams it is the first ones with their labels.
    """
    if name in data.frame_label:
        from radhar_cli.figures.page import png_bytes  # Matplotlib is slow to import

        return png_bytes(draw_streams(data, name, GALLERY_STREAMS))
    order, table = Rows.of(data.config), colour_table(data.config.image.colour_map)
    classes = list(order.classes())[:16]
    columns = min(len(classes), 4)
    step, lines = SIDE + GAP, -(-len(classes) // columns)
    size = (MARGIN + columns * step, lines * (step + LINE) + LINE)
    page = Image.fromarray(np.full((size[1], size[0], 3), 255, np.uint8))
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(12)
    for number, (activity, rows) in enumerate(classes):
        x, y = MARGIN + number % columns * step, number // columns * (step + LINE)
        image = Image.fromarray(table[data.maps[name][rows.start]])
        page.paste(image.resize((SIDE, SIDE), Image.Resampling.BILINEAR), (x, y + LINE))
        draw.text((x, y), activity.slug.replace("_", " "), "black", font)
    if (edges := data.extent(name)) is not None:
        left, right, bottom, top = (f"{float(f'{edge:.3g}'):g}" for edge in edges)
        row_unit, column_unit = row_axis(name)[1], column_axis(name)[1]
        look: dict[str, Any] = {"fill": "black", "font": font}
        for y in range(LINE, lines * (step + LINE), step + LINE):
            draw.text((MARGIN - GAP, y), f"{top} {row_unit}", anchor="ra", **look)
            draw.text((MARGIN - GAP, y + SIDE), bottom, anchor="rd", **look)
        for x in range(MARGIN, MARGIN + columns * step, step):
            y = lines * (step + LINE)
            draw.text((x, y), left, anchor="la", **look)
            draw.text((x + SIDE, y), f"{right} {column_unit}", anchor="ra", **look)
    buffer = io.BytesIO()
    page.save(buffer, "png", compress_level=data.config.output.png_level)
    return buffer.getvalue()


def _describe_axes(data: Dataset, name: str) -> str:
    """Describe the axes of an image of a map, with units, and its colours."""
    (rows, row_unit), (columns, column_unit) = row_axis(name), column_axis(name)
    if (edges := data.extent(name)) is None:
        sides = f"across: {columns} ({column_unit}); up: {rows} ({row_unit})"
    else:
        left, right, bottom, top = (f"{round(edge, 9):.4g}" for edge in edges)
        sides = f"across: {columns}, {left} to {right} {column_unit}; "
        sides += f"up: {rows}, {bottom} to {top} {row_unit}"
    image, colours = data.config.image, ""
    if image.kind == "decibel":
        colours = f"; {describe_levels(image, 'brightest', 'darkest')}"
    return f"`{name}`, {sides}{colours}."


def compose_card(data: Dataset, more: Mapping[str, Any], reading: str) -> str:
    """Write the text of README.md.

    Args:
        data: the data set.
        more: additional front matter, which `load_dataset` reads.
        reading: Markdown, how to read the files next to the card.
    """
    config, measured = data.config, isinstance(data.config, MeasuredConfig)
    content = "point clouds and maps" if "points" in data.products else "maps"
    title = f"{'Measured' if measured else 'Simulated'} radar {content} of human activities"
    front = {
        "license": config.output.license or "unknown",
        "pretty_name": title,
        "task_categories": ["image-classification"],
        "size_categories": [SIZES[sum(len(data) >= 10**n for n in range(3, 9))]],
        **more,
    }
    licence, version = config.output.license, data.file.text("radhar_version")
    licence = licence or "not chosen (`output.license` of the config)"
    parts = [
        f"---\n{yaml.safe_dump(front, sort_keys=False, default_flow_style=None, width=100)}---",
        f"# {title}",
        _summary(data),
        reading,
        f"## Maps\n\n{_maps(data)}",
        f"## Classes\n\n{describe_classes(data)}",
        *filter(None, (describe(data) for describe in MORE)),
        _TOLD_APART,
        "## How it was made",
        _making(data),
        "## Known biases and limits",
        "\n".join(f"- {' '.join(limit.split())}" for limit in _limits(data)),
        "## Licence and citation",
        f"Licence: {licence}. Please cite:",
        f"```bibtex\n{BIBTEX.replace('VERSION', version)}```",
    ]
    return "\n\n".join(parts) + "\n"


def _summary(data: Dataset) -> str:
    """Summarise the data set: its samples, maps, origin and split."""
    config, (height, width) = data.config, data.config.image.size_px
    maps = len(config.maps)
    if isinstance(config, MeasuredConfig):
        window = config.recordings.window_s
        content = f"what a radar recorded of people, cut into windows of {window:g} s."
    else:
        whom = "several moving people" if config.people else "one moving person"
        room = config.room.faces is not None
        where = (
            "through a wall" if config.wall is not None else "in a room" if room else "in the open"
        )
        view = f"what {_radar_in_words(config)} sees of {whom} {where}"
        content = f"{view}, simulated from the movement to the map."
    split = "Samples are split one by one."
    if isinstance(config, MeasuredConfig) and config.recordings.has_split:
        split = "Split as the list of recordings says."
    if config.split.subjects is not None:
        split = f"Split by person: none of the {config.split.subjects} is in two of its parts."
    count = len(config.chosen_activities)
    sets = f"{count} class{'es' * (count > 1)}"
    if isinstance(config, Config) and config.stream is not None:
        sets = f"{len(config.activities)} classes that follow each other, in streams"
    return (
        f"{len(data):,} samples of {sets}, {maps} "
        f"map{'s' * (maps > 1)} of each, {height} x {width} pixels: {content} {split}\n\n"
        "`scenes.csv` and /scene of dataset.h5 have the numbers that were drawn for each sample."
    )


def _radar_in_words(config: Config) -> str:
    """Name the radar of a config: its kind, carrier and bandwidth."""
    radar, kind = config.radar, config.radar.kind
    if isinstance(radar, BoardRadar):
        return f"a TI {radar.device or 'board'} ({radar.carrier_hz / 1e9:.4g} GHz)"
    if isinstance(radar, FramesRadar):
        antennas = f"{len(radar.array.tx)} x {len(radar.array.rx)}"
        name = _WAVEFORMS[radar.waveform]
        return f"{name} radar with frames ({antennas} antennas, {radar.carrier_hz / 1e9:.4g} GHz)"
    carrier = f"{nominal(radar.carrier_hz) / 1e9:.4g} GHz"
    band = "" if kind == "cw" else f" + {nominal(radar.bandwidth_hz) / 1e9:.3g} GHz"
    return f"{_WAVEFORMS[kind]} radar ({carrier}{band})"


def _maps(data: Dataset) -> str:
    """Write the table of maps with their axes, and the meaning of a level."""
    lines = []
    for name in data.config.maps:
        reach = "/extent of dataset.h5"
        if edges := data.extent(name):
            reach = ", ".join(f"{round(edge, 9):.5g}" for edge in edges)
        axes = (f"{quantity}, {unit}" for quantity, unit in (row_axis(name), column_axis(name)))
        lines.append([f"`{name}`", *axes, reach])
    image = data.config.image
    level = (
        f"{describe_levels(image, '255', '0')}, linear in dB between"
        if image.kind == "decibel"
        else "255 where the cell exceeds its CFAR threshold, else 0"
    )
    table = markdown_table(("map", "rows", "columns", "left, right, bottom, top"), lines)
    return f"{table}\n\nA pixel is a grey level: {level}. What comes nearer has positive Doppler."


def _making(data: Dataset) -> str:
    """Describe the command, seed and versions that make the data set again."""
    config = data.config
    library_versions = ", ".join(
        f"{library} {version}" for library, version in data.versions.items()
    )
    if isinstance(config, MeasuredConfig):
        source = config.recordings.source
        origin = "" if source is None else f"Recordings: {source}.\n\n"
        command = "`radhar generate --recordings`" if source is None else "`radhar prepare`"
        return f"{origin}{command}, seed {config.seed}; {library_versions}."
    return (
        f"`radhar generate config.yaml -o OUT`, seed {config.seed}, makes the same bytes again "
        f"with {library_versions}."
    )


def _limits(data: Dataset) -> list[str]:
    """List the known biases and limits of the data set, those that its build warned of first."""
    config, notes = data.config, [str(warning["message"]) for warning in data.warnings]
    if isinstance(config, MeasuredConfig):
        return [*notes, "config.yaml names files and persons as the recordings' manifest does"]
    stands = any("stationary" in activity.movements for activity in config.chosen_activities)
    if config.has_noise and config.processing.clutter in ("difference", "highpass"):
        notes.append(_NOISE_TELLS.format("`stationary`" if stands else "who hardly moves"))
    return [*notes, _SIMULATED]
