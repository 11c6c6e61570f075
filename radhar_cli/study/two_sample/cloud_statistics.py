"""Statistics that tell the point clouds of one radar from those of another."""

import numpy as np
from scipy.spatial import cKDTree

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.study.two_sample.map_statistics import Statistic

MOST_POINTS = 512  # of a cloud, and of those that it is set beside, for a Chamfer distance
CHAMFER = "chamfer"
STATISTICS = {
    "points": Statistic("points a frame", ""),
    "points_sd": Statistic("sd of points over frames", ""),
    "empty": Statistic("frames without points", "%"),
    "range": Statistic("distance from the radar, median", "m"),
    "height": Statistic("height, median", "m"),
    "spread_ahead": Statistic("spread ahead within frames, sd", "m"),
    "spread_left": Statistic("spread across within frames, sd", "m"),
    "spread_up": Statistic("spread in height within frames, sd", "m"),
    "speed": Statistic("size of the Doppler, mean", "m/s"),
    "speed_95": Statistic("size of the Doppler, 95 %", "m/s"),
    "still": Statistic("points without Doppler", "%"),
    "snr": Statistic("SNR, median", "dB"),
    "snr_sd": Statistic("SNR, sd", "dB"),
    CHAMFER: Statistic("Chamfer distance to other measured clouds", "m"),
}


def cloud_statistics(points: Float, start: Index) -> dict[str, float]:
    """Statistics of a sample under the names of `STATISTICS`, without the Chamfer distance.

    Args:
        points: rows [N, 8] of all frames: x, y, z (m), Doppler (m/s), intensity, SNR (dB), bins.
        start: [T + 1] first row of each frame, and N.
    """
    counts = np.diff(start)
    values = dict.fromkeys(STATISTICS, np.nan)
    values |= {
        "points": float(counts.mean()),
        "points_sd": float(counts.std()),
        "empty": 100 * float((counts == 0).mean()),
    }
    if not len(points):
        return values
    places, speed, snr = points[:, :3], np.abs(points[:, 3]), points[:, 5]
    frame = np.repeat(np.arange(counts.size), counts)
    sums = np.stack([np.bincount(frame, column, counts.size) for column in places.T], 1)
    deviation = places - (sums / np.maximum(counts, 1)[:, None])[frame]
    freedom = max(1, len(points) - np.count_nonzero(counts))
    spread = np.sqrt((deviation**2).sum(0) / freedom)
    values |= dict(zip(("spread_ahead", "spread_left", "spread_up"), spread.tolist(), strict=True))
    values |= {
        "range": float(np.median(np.linalg.norm(places, axis=1))),
        "height": float(np.median(places[:, 2])),
    }
    speed, snr = speed[np.isfinite(speed)], snr[np.isfinite(snr)]
    if speed.size:
        values |= {
            "speed": float(speed.mean()),
            "speed_95": float(np.percentile(speed, 95)),
            "still": 100 * float((speed == 0).mean()),
        }
    if snr.size:
        values |= {"snr": float(np.median(snr)), "snr_sd": float(snr.std())}
    return values


def centred_places(points: Float, rng: np.random.Generator) -> Float:
    """Places [n, 3] of at most `MOST_POINTS` points [N, 8], about their median."""
    places = points[:, :3] - np.median(points[:, :3], axis=0) if len(points) else points[:, :3]
    if len(places) > MOST_POINTS:
        places = places[np.sort(rng.choice(len(places), MOST_POINTS, replace=False))]
    return places


def chamfer_distances(clouds: list[Float], measured: list[Float], same: bool) -> Float:
    """Chamfer distance [N] of each cloud to the measured ones, m; NaN of an empty cloud.

    The mean distance of its points to the nearest of theirs, and of theirs to the nearest of its,
    halved, so that both what is missing and what should not be there count (H. Fan et al., "A Point
    Set Generation Network", CVPR 2017).

    Args:
        clouds: places [n, 3] of each.
        measured: places [n, 3] of each measured cloud.
        same: whether the clouds are the measured ones, of which each is set beside the others.
    """
    distances = np.full(len(clouds), np.nan)
    for number, cloud in enumerate(clouds):
        other_clouds = [
            m for place, m in enumerate(measured) if len(m) and not (same and place == number)
        ]
        if not len(cloud) or not other_clouds:
            continue
        every = np.concatenate(other_clouds)
        reference = every[:: -(-len(every) // MOST_POINTS)]
        to_reference = np.mean(cKDTree(reference).query(cloud)[0])
        from_reference = np.mean(cKDTree(cloud).query(reference)[0])
        distances[number] = (to_reference + from_reference) / 2
    return distances
