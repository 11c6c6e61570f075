"""How far data are from a reference: as a signal, as a power map, as an image."""

from math import inf, log10
from typing import Any

import numpy as np
from PIL import Image

from radhar_cli.arrays import Complex, Float, Levels
from radhar_cli.processing.image import decibels

SSIM_WINDOW = 7


def relative_db(compared: Complex, exact: Complex) -> float | None:
    """Relative L2 error in dB; -inf where the two are the same, None where there is no signal."""
    size = float(np.linalg.norm(exact))
    if size == 0:
        return None
    error = float(np.linalg.norm(compared - exact)) / size
    return 20 * log10(error) if error > 0 else -inf


def map_error_db(compared: Float, exact: Float, dynamic_range_db: float) -> tuple[float, float]:
    """Root mean square and largest difference (dB) of two power maps as they are displayed.

    Both are referred to their own maximum and cut at the dynamic range; cells that are at the floor
    in both do not count.
    """
    one, other = (decibels(power, dynamic_range_db) for power in (compared, exact))
    seen = (one > -dynamic_range_db) | (other > -dynamic_range_db)
    difference = (one - other)[seen]
    if difference.size == 0:
        return 0.0, 0.0
    return float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())


def image_scores(compared: Levels, exact: Levels) -> dict[str, float | None]:
    """SSIM, PSNR (dB; None for equal images) and share of pixels whose level differs.

    SSIM has a window of 7 pixels, of 3 or 5 in smaller images, and is None below 3.

    An image of another size is brought to the reference's by bilinear interpolation first.
    """
    import skimage.metrics

    metrics: Any = skimage.metrics
    if compared.shape != exact.shape:
        size = (exact.shape[1], exact.shape[0])
        compared = np.asarray(Image.fromarray(compared).resize(size, Image.Resampling.BILINEAR))
    same = bool(np.array_equal(compared, exact))
    window = min(SSIM_WINDOW, *(side - 1 + side % 2 for side in exact.shape))
    similar = None
    if window >= 3:
        similar = metrics.structural_similarity(exact, compared, data_range=255, win_size=window)
    return {
        "ssim": None if similar is None else float(similar),
        "psnr_db": None
        if same
        else float(metrics.peak_signal_noise_ratio(exact, compared, data_range=255)),
        "pixels_changed": float(np.mean(compared != exact)),
    }
