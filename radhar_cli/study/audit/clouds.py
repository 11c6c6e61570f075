"""Evidence in a board's point clouds beside the movement: place, number of points, far points."""

import numpy as np

from radhar_cli.dataset.reading import Dataset
from radhar_cli.learning.images.sequences import CLOUDS
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.study.audit.evidence import Evidence, EvidencePart
from radhar_cli.study.audit.recordings import RECORD_ALIKE
from radhar_cli.study.audit.scene_numbers import one_law

FAR_M = 1.5  # from the middle of a cloud: points there are none of the body's


def has_clouds(data: Dataset) -> bool:
    """Whether a data set holds point clouds."""
    return CLOUDS in data.products and f"{CLOUDS}_start" in data.products


def cloud_evidence(data: Dataset, rows: Index, is_simulated: bool = True) -> list[Evidence]:
    """Evidence of the clouds of some rows of a data set, simulated or measured."""
    clouds = [
        _cloud_features(data.products[CLOUDS][row], data.products[f"{CLOUDS}_start"][row])
        for row in rows.tolist()
    ]
    place, ends, counts, far = (np.stack(columns) for columns in zip(*clouds, strict=True))
    return [
        Evidence(
            EvidencePart.CLOUDS,
            "where the cloud is",
            place,
            cure=f"motion.place.range_m: {one_law(place[:, 0])}, one law for all classes"
            if is_simulated
            else "record all classes at the same places",
        ),
        Evidence(
            EvidencePart.CLOUDS,
            "first and last frame",
            ends,
            cure="timing.onset: {uniform: [0, 1]}, or cut windows anywhere"
            if is_simulated
            else "cut windows anywhere",
            may_be_movement=True,
        ),
        Evidence(
            EvidencePart.CLOUDS,
            "points, frames",
            counts,
            cure="recordings of one length; motion.range_m alike for all classes"
            if is_simulated
            else RECORD_ALIKE,
            may_be_movement=True,
        ),
        Evidence(
            EvidencePart.CLOUDS,
            "points far from the body",
            far,
            cure="the same room and clutter for all classes",
        ),
    ]


def _cloud_features(points: Float, start: Index) -> tuple[Float, Float, Float, Float]:
    """Place, ends, counts and far points of one sample.

    Args:
        points: rows [N, 8] of all frames: x, y, z, Doppler, intensity, SNR (dB), bins.
        start: [T + 1] first row of each frame, and N.
    """
    per_frame = np.diff(start)
    counts = np.array([len(per_frame), len(points), per_frame.mean(), per_frame.std()], float)
    if not len(points):
        return np.full(4, np.nan), np.full(4, np.nan), counts, np.full(3, np.nan)
    middle = np.median(points[:, :2], axis=0)
    distance = np.hypot(*(points[:, :2] - middle).T)
    place = np.array([*middle, *np.quantile(points[:, 0], [0.1, 0.9])])
    edges = (points[start[0] : start[1]], points[start[-2] : start[-1]])
    ends = [value for frame in edges for value in (len(frame), _speed(frame))]
    outliers = points[distance > FAR_M]
    snr = float(np.median(outliers[:, 5])) if len(outliers) else np.nan
    far = np.array([len(outliers) / len(points), snr, _speed(outliers)])
    return place, np.array(ends, float), counts, far


def _speed(points: Float) -> float:
    """Mean size of the Doppler velocity of points [N, 8] that have one, m/s; NaN of none."""
    speeds = np.abs(points[:, 3])
    speeds = speeds[np.isfinite(speeds)]
    return float(speeds.mean()) if speeds.size else np.nan
