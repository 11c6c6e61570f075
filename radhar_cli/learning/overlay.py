"""Pictures of what a network finds, over the images or clouds that it was asked about."""

from pathlib import Path

import numpy as np

from radhar_cli.config.image import DEFAULT_COLOUR_MAP
from radhar_cli.figures.clouds import CloudPicture, clouds_png
from radhar_cli.figures.page import png_bytes
from radhar_cli.figures.stream_page import LabelledMap, draw_labelled_maps
from radhar_cli.figures.two_samples import Picture, pictures_png
from radhar_cli.learning.estimates import RunEstimates
from radhar_cli.learning.evaluation import Inputs
from radhar_cli.learning.run_folder import RunMetadata
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Float, Levels

PICTURES, A_ROW, CLOUDS, STREAMS = 12, 4, 6, 4  # that are drawn at most


def draw_overlay(
    metadata: RunMetadata, inputs: Inputs, estimates: RunEstimates, path: Path
) -> bytes:
    """Draw some of the inputs with what was found in them, evenly spread.

    Args:
        metadata: description of the network.
        inputs: what it was asked about.
        estimates: what it has found in all of them.
        path: the inputs' file or folder, for the title.

    Returns:
        The PNG file.
    """
    title = f"{metadata.model} on {path}"
    if not metadata.reads_pictures:
        pictures = _cloud_pictures(metadata, inputs, estimates)
        return clouds_png(pictures, PARENTS if estimates.names == JOINTS else (), title)
    rows = _spread(len(estimates), STREAMS if estimates.task.axes else PICTURES)
    words = [*estimates.lines(1)]
    if estimates.task.axes:
        maps = [
            LabelledMap(
                estimates.samples[row],
                _levels(inputs, row),
                (0.0, float(metadata.size[1]), 0.0, float(metadata.size[0])),
                "pixel row",
                {"found": estimates.values[row].argmax(1)},
            )
            for row in rows
        ]
        colours = metadata.colours or DEFAULT_COLOUR_MAP
        return png_bytes(draw_labelled_maps(maps, estimates.names, colours, "column"))
    height, width = metadata.size
    drawn = [Picture(_levels(inputs, row), (0, width, 0, height), words[row]) for row in rows]
    lines = {f"{n + 1} ...": drawn[n : n + A_ROW] for n in range(0, len(drawn), A_ROW)}
    return pictures_png(lines, title, "column (px)", "row (px)")


def _spread(count: int, max_rows: int) -> list[int]:
    """At most `max_rows` of so many rows, evenly spread."""
    rows: list[int] = np.unique(
        np.linspace(0, count - 1, min(count, max_rows)).astype(int)
    ).tolist()
    return rows


def _levels(inputs: Inputs, row: int) -> Levels:
    """Pixels [H, W, 3] of an image, or [H, W] of a gray one."""
    pixels = inputs.pixels.read(int(inputs.rows[row]))
    return pixels[..., 0] if pixels.shape[2] == 1 else pixels


def _cloud_pictures(
    metadata: RunMetadata, inputs: Inputs, estimates: RunEstimates
) -> list[CloudPicture]:
    """Clouds of frames, evenly spread over all, with the joints or the class found in each.

    Networks of frame maps have no points to draw.
    """
    frames = np.array(
        [(row, t) for row, length in enumerate(inputs.lengths.tolist()) for t in range(length)]
    )
    words, has_joints = [*estimates.lines(1)], bool(estimates.task.coordinates)
    pictures = []
    for row, t in frames[_spread(len(frames), CLOUDS)].tolist():
        points: Float = np.zeros((0, 4))
        if metadata.input == "clouds":
            cloud = inputs.pixels.read(int(inputs.rows[row]))[t]
            points = cloud[cloud[:, -1] > 0, :4]
        joints = estimates.values[row, t] if has_joints else np.zeros((0, 3))
        caption = f"frame {inputs.first[row] + t}"
        pictures.append(CloudPicture(points, joints, caption if has_joints else words[row]))
    return pictures
