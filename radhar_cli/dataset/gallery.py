"""gallery.png: some samples of every class, small, for the data card."""

import io
from math import ceil

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from radhar_cli.arrays import Levels
from radhar_cli.dataset.layout import Rows, column_axis, row_axis
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset

MAX_CLASSES, ROWS = 16, 4
WIDTH, MIN_SIDE, MAX_SIDE = 960, 72, 160  # px, of a row and of an image
GAP, MARGIN, LINE, FONT = 4, 128, 13, 11  # px


def gallery_png(data: Dataset) -> bytes:
    """PNG with a column for every class and a row for every map, or more where maps are few."""
    order = Rows.of(data.config)
    classes = list(order.classes())[:MAX_CLASSES]
    repeats = min(max(1, ROWS // len(data.maps)), max(order.counts))
    side = min(max(WIDTH // len(classes), MIN_SIDE), MAX_SIDE)
    titles = [activity.slug.split("_") for activity, _ in classes]
    top = LINE * max(map(len, titles)) + 2 * GAP
    step, every = side + GAP, range(len(data.maps) * repeats)
    page = np.full((top + step * len(every), MARGIN + step * len(classes), 3), 255, np.uint8)
    table = colour_table(data.config.image.colour_map)
    for line in every:
        name = data.config.maps[line // repeats]
        for column, (_, rows) in enumerate(classes):
            row = rows.start + line % repeats
            if row < rows.stop:
                y, x = top + step * line, MARGIN + step * column
                page[y : y + side, x : x + side] = table[_small(data.maps[name][row], side)]
    picture = Image.fromarray(page)
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(FONT)
    for column, words in enumerate(titles):
        for line, word in enumerate(words):
            draw.text((MARGIN + step * column, GAP + LINE * line), word, "black", font)
    for number, name in enumerate(data.config.maps):
        for line, text in enumerate(_described(data, name)):
            place = (GAP, top + step * number * repeats + LINE * line)
            draw.text(place, text, "black", font)
    buffer = io.BytesIO()
    few = picture.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.save(buffer, "png", compress_level=data.config.output.png_level)
    return buffer.getvalue()


def _small(levels: Levels, side: int) -> Levels:
    """Levels [side, side] of an image of any size."""
    coarse = levels[:: ceil(levels.shape[0] / 2048), :: ceil(levels.shape[1] / 2048)]
    resized = Image.fromarray(coarse).resize((side, side), Image.Resampling.BILINEAR)
    return np.asarray(resized)


def _described(data: Dataset, name: str) -> list[str]:
    """A map's name in pieces that fit the margin, and its axes."""
    pieces = name.split("_")
    extent = data.extent(name)
    quantity, unit = row_axis(name)
    across, column_unit = column_axis(name)
    across = "time" if column_unit == "s" else across
    what = quantity.split()[0]
    if extent is None:
        return [*pieces, f"up: {what}", f"right: {across}"]
    left, right, bottom, top = (round(edge, 9) for edge in extent)
    reach = f"{bottom:.4g} to {top:.4g} {unit}"
    columns = f"{left:.3g} to {right:.3g} {column_unit}"
    return [*pieces, f"up: {what}", reach, f"right: {across}", columns]
