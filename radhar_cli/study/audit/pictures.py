"""Evidence in images beside the body: margins, level, size of the file, and the noise.

Noise is what is left in the quarter of the rows that bodies reach least in the whole data set, away
from every cell there that stands out of its row. Rows are taken one by one, as cancellers leave
more noise in some than in others. G. Maguolo and L. Nanni blacked out the lungs in the same way,
and found that what was left told the diagnosis (`held_out`).
"""

import zlib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import binary_dilation, median_filter, uniform_filter

from radhar_cli.config.image import ImageConfig
from radhar_cli.numerics.arrays import Bool, Float, Index, Levels
from radhar_cli.study.audit.evidence import Evidence, EvidencePart
from radhar_cli.study.audit.marks import MarkFeatures, mark_evidence, mark_features

SIDE = 32  # rows and columns of a thumbnail, and bands of rows of an image
EDGE = 32  # part of the columns, from the left or right, that is one edge
BANDS = 16  # rows of an edge
FAR = 8  # bands of rows that bodies reach least
TIMES = 4  # columns that these are brought to
OUTLYING = 4.0  # spreads above the median of its row from which a cell is no noise
NORMAL = 1.4826  # standard deviation of Gaussian values over their median deviation
LEAST = 4.0  # levels above the median that a body has anyway
LINE = 9  # rows whose median a steady line stands out of
FEWEST = 100  # cells of noise of which a histogram can be made
DARKEST = 0.5  # share of the noise at level 0 from which on it is not seen
BINS = np.linspace(-2.5, 2.5, 9)  # of the noise's levels, in its standard deviations


@dataclass(frozen=True)
class PictureFeatures:
    """Features of one image."""

    outer: Float  # [2 x BANDS] mean levels of the first and last rows
    first: Float  # [BANDS] mean levels of the first columns
    last: Float  # [BANDS] and of the last
    far: Float  # [FAR x TIMES] mean levels of the rows that bodies reach least
    level: Float  # mean, standard deviation, shares of the darkest and brightest level, quantiles
    size: Float  # bytes compressed, bytes of the file, height and width
    noise_level: Float
    noise_texture: Float
    marks: MarkFeatures


def thumbnail_of(levels: Levels) -> Levels:
    """Thumbnail [SIDE, SIDE] of levels [H, W]."""
    return _shrink(levels, (SIDE, SIDE))


def _shrink(levels: Levels, size: tuple[int, int]) -> Levels:
    """Means of levels [H, W] in cells of a grid (rows, columns)."""
    picture = Image.fromarray(np.ascontiguousarray(levels))
    return np.asarray(picture.resize(size[::-1], Image.Resampling.BOX))


def _rows_of_bands(height: int) -> list[Index]:
    """Rows of each of the SIDE bands of an image of a height; lower images have equal bands."""
    edges = np.arange(SIDE + 1) * height // SIDE
    return [np.arange(start, max(stop, start + 1)) for start, stop in pairwise(edges.tolist())]


def band_contrast(levels: Levels) -> Float:
    """Compute the largest contrast in each band of rows [SIDE] of levels [H, W].

    Levels are compared with the median of their row, and that with the rows around.
    """
    smooth = uniform_filter(levels.astype(np.float32), 3)
    middle = np.median(smooth, axis=1)
    line = np.maximum(middle - median_filter(middle, LINE), 0)
    contrast = smooth.max(axis=1) - middle + line
    return np.array([contrast[rows].max() for rows in _rows_of_bands(len(levels))])


def bands_far_from_bodies(contrast: Float) -> list[int]:
    """Bands [FAR] of rows in which the least stands out.

    Args:
        contrast: [N, SIDE] of each image, as `band_contrast` finds it.
    """
    reach = np.quantile(contrast, 0.95, axis=0) + 1e-3 * contrast.mean(axis=0)
    return sorted(np.argsort(reach, kind="stable")[:FAR].tolist())


def picture_features(levels: Levels, bands: list[int], file: Path | None) -> PictureFeatures:
    """Measure one image.

    Args:
        levels: [H, W].
        bands: bands of rows that bodies reach least.
        file: image file that it was read from; None of an image in a dataset.h5.
    """
    height, width = levels.shape
    edge, border = max(1, width // EDGE), max(1, height // EDGE)
    rows = (levels[:border], levels[-border:])
    shares = [np.mean(levels == extreme) for extreme in (0, 255)]
    quantiles = np.quantile(levels, [0.1, 0.25, 0.5, 0.75, 0.9])
    file_bytes = np.nan if file is None else file.stat().st_size
    size = [len(zlib.compress(levels.tobytes(), 6)), file_bytes, height, width]
    is_noise = select_noise(levels, bands)
    return PictureFeatures(
        outer=np.concatenate([_shrink(side, (1, BANDS))[0].astype(float) for side in rows]),
        first=_shrink(levels[:, :edge], (BANDS, 1))[:, 0].astype(float),
        last=_shrink(levels[:, -edge:], (BANDS, 1))[:, 0].astype(float),
        far=_shrink(levels, (SIDE, TIMES))[bands].astype(float).ravel(),
        level=np.array([levels.mean(), levels.std(), *shares, *quantiles]),
        size=np.array(size, float),
        noise_level=_noise_level(levels[is_noise].astype(float)),
        noise_texture=_noise_texture(levels, is_noise),
        marks=mark_features(levels),
    )


def select_noise(levels: Levels, bands: list[int]) -> Bool:
    """Mask [H, W] of the cells of noise, in the bands of rows that bodies reach least."""
    smooth = uniform_filter(levels.astype(np.float32), 3)
    middle = np.median(smooth, axis=1, keepdims=True)
    spread = NORMAL * np.median(np.abs(smooth - middle), axis=1, keepdims=True)
    stands_out = smooth > middle + np.maximum(OUTLYING * spread, LEAST)
    near = binary_dilation(stands_out, np.ones((3, 3), bool), iterations=2)
    is_far = np.zeros((len(levels), 1), bool)
    rows = _rows_of_bands(len(levels))
    is_far[np.concatenate([rows[band] for band in bands])] = True
    return np.asarray(is_far & ~near)


def _noise_level(noise: Float) -> Float:
    """Mean, standard deviation, quantiles and darkest share of the noise; NaN of too few cells."""
    if noise.size < FEWEST:
        return np.full(6, np.nan)
    quantiles = np.quantile(noise, [0.1, 0.5, 0.9])
    return np.array([noise.mean(), noise.std(), *quantiles, np.mean(noise == 0)])


def _noise_texture(levels: Levels, is_noise: Bool) -> Float:
    """Histogram of the noise, level and spread taken out, and how alike its neighbours are.

    NaN where there is too little noise, or most of it lies below the levels.
    """
    count = len(BINS) - 1
    noise = levels[is_noise]
    if noise.size < FEWEST or np.mean(noise == 0) > DARKEST or noise.std() < 1e-6:
        return np.full(count + 4, np.nan)
    values = levels - np.median(levels, axis=1, keepdims=True)
    values = (values - values[is_noise].mean()) / (values[is_noise].std() + 1e-6)
    histogram = np.histogram(np.clip(values[is_noise], -2.49, 2.49), BINS)[0] / noise.size
    neighbours = [
        _correlation(values, is_noise, axis, lag) for axis, lag in ((0, 1), (1, 1), (0, 2), (1, 2))
    ]
    return np.array([*histogram, *neighbours])


def _correlation(values: Float, is_noise: Bool, axis: int, lag: int) -> float:
    """Correlation of standardised values [H, W] with those `lag` cells along an axis."""
    first = (slice(None),) * axis + (slice(None, -lag),)
    second = (slice(None),) * axis + (slice(lag, None),)
    are_noise = is_noise[first] & is_noise[second]
    if not are_noise.any():
        return 0.0
    return float(np.mean(values[first][are_noise] * values[second][are_noise]))


def picture_evidence(
    features: list[PictureFeatures],
    label: Index,
    size: tuple[int, int],
    is_simulated: bool,
    image: ImageConfig | None,
) -> list[Evidence]:
    """Evidence of margins and noise of images.

    Args:
        features: features of each image [N].
        label: [N] class of each.
        size: (H, W) of the first of them.
        is_simulated: whether there is a config, in which numbers can be drawn otherwise.
        image: section `image` of simulated images, where their config is known.
    """
    outer, first, last, far, level, file_size, noise, texture = (
        np.stack([getattr(one, name) for one in features])
        for name in (
            *("outer", "first", "last", "far", "level", "size"),
            *("noise_level", "noise_texture"),
        )
    )
    cures = _SIMULATED_CURES if is_simulated else _MEASURED_CURES
    strength = cures["strength"] if image is None else _level_cure(image)
    margins = [
        _margin("first columns", first, cures["onset"]),
        _margin("last columns", last, cures["onset"]),
        _margin("first and last rows", outer, strength),
        Evidence(EvidencePart.MARGINS, "rows far from bodies", far, cure=strength),
        _margin("levels: mean, spread", level, strength),
        _margin("size: compressed, file, pixels", file_size, cures["size"]),
    ]
    everything = np.concatenate([evidence.values for evidence in margins], axis=1)
    return [
        *margins,
        _margin("all margins together", everything, "as above"),
        mark_evidence([one.marks for one in features], label, size),
        Evidence(EvidencePart.NOISE, "noise: its level", noise, cure=strength),
        Evidence(
            EvidencePart.NOISE,
            "noise: its texture",
            texture,
            cure=cures["texture"],
            leaves_out_missing=True,
        ),
    ]


def _margin(name: str, values: Float, cure: str) -> Evidence:
    """Evidence of a margin in which the movement itself may be seen."""
    return Evidence(EvidencePart.MARGINS, name, values, cure=cure, may_be_movement=True)


def _level_cure(image: ImageConfig) -> str:
    """Advise on a config whose images tell the class by their level.

    Noise has one law for all classes in every config: its keys take none by activity.
    """
    if image.kind == "decibel" and image.reference == "peak":
        return "image.reference: noise, as levels are relative to each image's peak"
    level = ""
    if image.kind == "decibel" and image.reference == "noise":
        level = ", and the level is how much moves beside the noise"
    return f"it may be the movement: noise has one law for all classes{level}"


_SIMULATED_CURES = {
    "onset": "timing.onset: {uniform: [0, 1]}, or windows cut anywhere",
    "strength": "snr_db: {uniform: [0, 30]}, one law for all classes",
    "size": "one size and one way of writing files for all classes",
    "texture": "one radar, receiver and processing for all classes",
}
_MEASURED_CURES = {
    "onset": "cut windows anywhere, not where the movement begins and ends",
    "strength": "record each class with the same gain, at the same ranges, in the same rooms",
    "size": "one length, size and way of writing files for all classes",
    "texture": "record each class in the same rooms, and process it in the same way",
}
