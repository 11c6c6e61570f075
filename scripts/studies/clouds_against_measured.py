"""Compare measured clouds of a TI board with simulated ones of the same people, frame by frame.

    python scripts/studies/clouds_against_measured.py PAIRS.npz --cfg CFG -o OUT [--offset X Y Z]

PAIRS.npz holds `points` [N, 6] (frame, x right, y ahead, z up in m, Doppler in m/s receding,
intensity), `joints` [frames, 25, 3] (m, the same axes), their `names`, `frame_number` at 10 a
second (other frames were left out) and `movement`, as MARS (An and Ogras, 2021) has them. The
joints become a recorded motion, the board of the .cfg sees its surfaces, and the cloud, cropped as
the measured one is, stands beside that. Writes OUT/clouds.md, .json, frames.png and statistics.png.
Chamfer distances are the mean of both ways; empty clouds are left out. The last line is for
programs.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt
from scipy.spatial import cKDTree
from shared import table

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.motion.skeleton import JOINTS, PARENTS, cross_sections
from radhar_cli.products.run import record
from radhar_cli.scene import Scene, draw_scene

Float = NDArray[np.floating[Any]]
NEAR_M = 0.3
FRAME_S = 0.1
SHOWN = 6
RATE = 10.0  # joints and frames per second
LOW_PASS_HZ = 2.7
OFFSET_M = (0.19, 0.0, -0.147)  # of the radar from the Kinect: right, ahead, up
CLOUD_LATE_S = 0.056  # clouds are older than the joints beside them
PATTERN_DEG = [22.0, 15.0]  # fitted to the clouds, azimuth and elevation
LONGEST_GAP = 8  # frames that are bridged
MARGIN_S = 0.6
# Kinect's joints for ours, and for the further points of the body that segments know.
KINECT = {
    "torso": "SpineMid",
    "head": "Head",
    "right_shoulder": "ShoulderRight",
    "right_elbow": "ElbowRight",
    "right_hand": "WristRight",
    "left_shoulder": "ShoulderLeft",
    "left_elbow": "ElbowLeft",
    "left_hand": "WristLeft",
    "hip": "SpineBase",
    "right_knee": "KneeRight",
    "right_ankle": "AnkleRight",
    "left_knee": "KneeLeft",
    "left_ankle": "AnkleLeft",
    "right_hip": "HipRight",
    "left_hip": "HipLeft",
    "right_toes": "FootRight",
    "left_toes": "FootLeft",
}
BONES = (
    *(("SpineBase", "SpineMid"), ("SpineMid", "SpineShoulder"), ("SpineShoulder", "Neck")),
    ("Neck", "Head"),
    *(
        (start + side, end + side)
        for side in ("Left", "Right")
        for start, end in (
            *(("Shoulder", "Elbow"), ("Elbow", "Wrist"), ("Wrist", "Hand")),
            *(("Hip", "Knee"), ("Knee", "Ankle"), ("Ankle", "Foot")),
        )
    ),
    *(("SpineShoulder", "ShoulderLeft"), ("SpineShoulder", "ShoulderRight")),
    *(("SpineBase", "HipLeft"), ("SpineBase", "HipRight")),
)


class Pairs(NamedTuple):
    """Clouds and joints, frame by frame.

    Attributes:
        clouds: of each frame [n, 5]: x, y, z, Doppler, intensity; None where they were not read.
        joints: [frames, 25, 3], m.
        names: of the joints.
        number: of the frames in the recording.
        movement: under way in each.
    """

    clouds: list[Float] | None
    joints: Float
    names: tuple[str, ...]
    number: NDArray[np.int64]
    movement: NDArray[np.int64]

    @property
    def runs(self) -> list[slice]:
        """Frames of stretches without a long gap, each of one movement."""
        apart = (np.diff(self.number) > LONGEST_GAP) | (np.diff(self.number) <= 0)
        edges = np.flatnonzero(apart | (np.diff(self.movement) != 0)) + 1
        ends = [0, *edges.tolist(), len(self.number)]
        return [slice(a, b) for a, b in pairwise(ends)]

    def bones(self) -> NDArray[np.int64]:
        """Joints at both ends [bone, 2]."""
        at = {name: n for n, name in enumerate(self.names)}
        return np.array([[at[one] for one in bone] for bone in BONES])


def read_pairs(path: Path, clouds: bool = True) -> Pairs:
    """Read pairs; without `clouds` the measured clouds are not opened."""
    with np.load(path, allow_pickle=False) as file:
        joints, number = file["joints"].astype(float), file["frame_number"].astype(int)
        names, movement = tuple(map(str, file["names"])), file["movement"].astype(int)
        found = None
        if clouds:
            points = file["points"].astype(float)
            frame = points[:, 0].astype(int)
            found = [points[frame == n, 1:] for n in range(len(joints))]
    return Pairs(found, joints, names, number, movement)


@dataclass(frozen=True)
class KinectMotion:
    """Joints of a Kinect as a motion: x ahead, y left, z up of the radar; splines over time.

    Attributes:
        splines: [time] -> [landmark, 3].
        landmarks: their names, the thirteen joints first.
    """

    splines: CubicSpline
    landmarks: tuple[str, ...] = tuple(KINECT)

    names = JOINTS
    parents = PARENTS
    breakpoints = ()
    highest_frequency = 2.0
    phases = ()

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, 17, M] (m)."""
        places: Float = self.splines(t).transpose(2, 1, 0)
        return places

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m)."""
        return self.landmark_positions(t)[:, : len(JOINTS)]

    def cross_sections(self, t: Float) -> Float:
        """Of points; surfaces have their own."""
        return np.broadcast_to(cross_sections(1.75, 80.0)[:, None], (len(JOINTS), 1))

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m)."""
        return self.positions(t)[:, :1]


def motion_of(pairs: Pairs, run: slice, offset: Sequence[float], start: float) -> KinectMotion:
    """The motion of a run; its time is that of the board, whose first frame is at `start` (s)."""
    chosen = [pairs.names.index(name) for name in KINECT.values()]
    p = pairs.joints[run][:, chosen] - np.array(offset)
    number = pairs.number[run]
    even = np.arange(number[0], number[-1] + 1)
    p = np.stack([_bridged(number, p[:, j, k], even) for j in range(p.shape[1]) for k in range(3)])
    sos = butter(2, LOW_PASS_HZ, fs=RATE, output="sos")
    pad = min(len(even) - 1, 15)
    p = sosfiltfilt(sos, p, axis=-1, padlen=pad) if pad > 3 else p
    right, ahead, up = p.reshape(len(chosen), 3, -1).transpose(1, 0, 2)
    places = np.stack([ahead, -right, up], axis=-1).transpose(1, 0, 2)  # [frame, landmark, 3]
    t = start + (even - even[0]) / RATE
    if len(t) == 1:
        t, places = np.append(t, t + 1), np.concatenate([places, places])
    return KinectMotion(CubicSpline(t, places, axis=0, bc_type="natural"))


def _bridged(number: Float, values: Float, even: Float) -> Float:
    bridged: Float = np.interp(even, number, values)
    return bridged


def board_config(cfg: Path, seconds: float, seed: int, overrides: Sequence[str] = ()) -> Config:
    """A config of the board that made the clouds, and of surfaces of people."""
    document = {
        "seed": seed,
        "radar": {
            "cfg": cfg.read_text(),
            "device": "IWR1443BOOST",
            "position_m": [0, 0, 0],
            "half_power_deg": PATTERN_DEG,
        },
        "subject": {"height_m": 1.75},
        "activities": ["stationary"],
        "duration_s": seconds,
        "body": {"scatterers": "surfaces"},
        "cloud": {"chain": "board", "doppler_carrier": "start"},
        "maps": ["points"],
    }
    return validated(Config, with_overrides(document, overrides), "config", {})


def simulated_clouds(
    pairs: Pairs,
    cfg: Path,
    seed: int = 1,
    offset: Sequence[float] = OFFSET_M,
    overrides: Sequence[str] = (),
) -> list[Float]:
    """Clouds [n, 5] of every frame's joints as the board sees them, cropped as the measured are.

    Returns:
        x right, y ahead, z up of the radar (m), Doppler (m/s, receding), intensity.
    """
    clouds: list[Float] = []
    for number, run in enumerate(pairs.runs):
        clouds += _of_run(pairs, run, cfg, seed, number, offset, overrides)
    return clouds


def _of_run(
    pairs: Pairs,
    run: slice,
    cfg: Path,
    seed: int,
    number: int,
    offset: Sequence[float],
    overrides: Sequence[str],
) -> Iterator[Float]:
    frames = pairs.number[run] - pairs.number[run][0]
    config = board_config(cfg, (int(frames[-1]) + 1) / RATE, seed, overrides)
    scene: Scene = draw_scene(config, config.chosen_activities[0], number)
    board = config.radar.header
    chirps = board.loops * len(board.order) * board.slot_s
    motion = motion_of(pairs, run, offset, CLOUD_LATE_S + chirps / 2)
    cloud = record(scene, ["cloud"], motions=(motion,))["cloud"]
    for frame in frames:
        points = cloud.points[cloud.start[frame] : cloud.start[frame + 1]].astype(float)
        x, y, z, doppler, intensity = points[:, :5].T
        found = np.stack([-y, x, z, -doppler, intensity], axis=1)
        yield found[cropped(found)]


def cropped(cloud: Float) -> NDArray[np.bool_]:
    """Points that the authors keep."""
    inside: NDArray[np.bool_] = (
        (np.abs(cloud[:, 0]) < 1) & (np.abs(cloud[:, 2]) < 1) & (cloud[:, 1] < 3)
    )
    return inside


def to_bones(cloud: Float, joints: Float, bones: Any) -> Float:
    """Distance (m) [n] of points to the nearest bone of joints [25, 3]."""
    start, end = joints[bones[:, 0]], joints[bones[:, 1]]
    way = end - start
    square = np.maximum((way**2).sum(axis=1), 1e-12)
    apart = cloud[:, None, :3] - start
    share = np.clip((apart * way).sum(axis=2) / square, 0, 1)
    distance: Float = np.linalg.norm(apart - share[..., None] * way, axis=2).min(axis=1)
    return distance


def chamfer(one: Float, other: Float) -> float:
    """Mean of both clouds' mean distances to the nearest point of the other, m; NaN if empty."""
    if not len(one) or not len(other):
        return float("nan")
    there = cKDTree(other[:, :3]).query(one[:, :3])[0].mean()
    back = cKDTree(one[:, :3]).query(other[:, :3])[0].mean()
    return float(there + back) / 2


def statistics(clouds: list[Float], pairs: Pairs, offset: Float) -> dict[str, float]:
    """Numbers of one set of clouds beside the joints."""
    bones, joints = pairs.bones(), pairs.joints - offset
    counts = np.array([len(cloud) for cloud in clouds])
    every = np.concatenate(clouds)
    apart = np.concatenate([to_bones(c, j, bones) for c, j in zip(clouds, joints, strict=True)])
    several = [cloud for cloud in clouds if len(cloud) > 4]
    spread = np.mean([cloud[:, :3].std(axis=0) for cloud in several], axis=0)
    fastest, moving = _fastest(pairs)
    return {
        "points a frame": float(counts.mean()),
        "5 % of frames have fewer": float(np.percentile(counts, 5)),
        "5 % of frames have more": float(np.percentile(counts, 95)),
        "share at zero Doppler": float(np.mean(every[:, 3] == 0)),
        "sd of Doppler, m/s": float(every[:, 3].std()),
        "median distance to a bone, m": float(np.median(apart)),
        f"share within {NEAR_M} m": float(np.mean(apart < NEAR_M)),
        "spread to the side, m": float(spread[0]),
        "spread along the view, m": float(spread[1]),
        "spread in height, m": float(spread[2]),
        "correlation of points with the fastest joint": float(
            np.corrcoef(counts[moving], fastest[moving])[0, 1]
        ),
    }


def _fastest(pairs: Pairs) -> tuple[Float, Any]:
    """Speed of the fastest joint in each frame, m/s, and where it is known."""
    speed = np.linalg.norm(np.diff(pairs.joints, axis=0), axis=2).max(axis=1) / FRAME_S
    follows = np.diff(pairs.number) == 1
    return np.append(speed, 0), np.append(follows, False)


def distances(measured: list[Float], simulated: list[Float], pairs: Pairs) -> dict[str, float]:
    """Chamfer distances of measured frames to their simulated ones and to other measured ones."""
    follows = np.flatnonzero(np.diff(pairs.number) == 1)
    shuffled = np.random.default_rng(1).permutation(len(measured))
    pair = {
        "simulated": [chamfer(measured[n], simulated[n]) for n in follows],
        "next": [chamfer(measured[n], measured[n + 1]) for n in follows],
        "shuffled": [chamfer(measured[n], measured[shuffled[n]]) for n in follows],
    }
    return {name: float(np.nanmean(values)) for name, values in pair.items()}


def within_movements(
    measured: list[Float], simulated: list[Float], pairs: Pairs
) -> dict[str, float]:
    """Correlation of the clouds' mean height and width, movement by movement, then averaged."""
    found: dict[str, list[float]] = {"mean height": [], "width": []}
    for movement in np.unique(pairs.movement):
        some = [
            n
            for n in np.flatnonzero(pairs.movement == movement)
            if len(measured[n]) > 4 and len(simulated[n]) > 4
        ]
        for name, of in (("mean height", _height), ("width", _width)):
            one, other = ([of(clouds[n]) for n in some] for clouds in (measured, simulated))
            found[name].append(float(np.corrcoef(one, other)[0, 1]))
    return {name: float(np.mean(values)) for name, values in found.items()}


def _height(cloud: Float) -> float:
    return float(cloud[:, 2].mean())


def _width(cloud: Float) -> float:
    return float(cloud[:, 0].std())


def draw_frames(
    measured: list[Float], simulated: list[Float], pairs: Pairs, offset: Float, path: Path
) -> None:
    """Some frames from the radar: measured above, simulated below, over the same skeleton."""
    chosen = np.linspace(0, len(measured) - 1, SHOWN * 2 + 1).astype(int)[1::2]
    figure, grid = plt.subplots(2, SHOWN, figsize=(2.4 * SHOWN, 6), sharey=True)
    for row, clouds, name in zip(
        grid, (measured, simulated), ("measured", "simulated"), strict=True
    ):
        for axes, n in zip(row, chosen, strict=True):
            joints = pairs.joints[n] - offset
            for start, end in pairs.bones():
                axes.plot(*joints[[start, end]][:, [0, 2]].T, color="0.6", linewidth=1)
            cloud = clouds[n]
            axes.scatter(
                cloud[:, 0], cloud[:, 2], c=cloud[:, 3], s=12, cmap="coolwarm", vmin=-1, vmax=1
            )
            axes.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", title=f"{name}, frame {n}")
            axes.title.set_fontsize(8)
            axes.tick_params(labelsize=6)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_statistics(measured: list[Float], simulated: list[Float], path: Path) -> None:
    """Histograms of points a frame, Doppler, intensity, and places."""
    figure, grid = plt.subplots(2, 3, figsize=(11, 6))
    both = {"measured": measured, "simulated": simulated}
    quantities = {
        "points a frame": (lambda clouds: np.array([len(c) for c in clouds]), (0, 80, 41)),
        "Doppler (m/s, receding)": (lambda clouds: np.concatenate(clouds)[:, 3], (-1.6, 1.6, 33)),
        "intensity (dB)": (
            lambda clouds: 20 * np.log10(np.maximum(np.concatenate(clouds)[:, 4], 1)),
            (0, 70, 36),
        ),
        "right (m)": (lambda clouds: np.concatenate(clouds)[:, 0], (-1, 1, 41)),
        "ahead (m)": (lambda clouds: np.concatenate(clouds)[:, 1], (1, 3, 41)),
        "up (m)": (lambda clouds: np.concatenate(clouds)[:, 2], (-1, 1, 41)),
    }
    for axes, (name, (of, (low, high, count))) in zip(grid.flat, quantities.items(), strict=True):
        for label, clouds in both.items():
            edges = np.linspace(low, high, count)
            axes.hist(of(clouds), edges, histtype="step", density=True, label=label)
        axes.set_xlabel(name, fontsize=8)
        axes.tick_params(labelsize=7)
    grid[0, 0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("pairs", type=Path)
    parser.add_argument("--cfg", type=Path, required=True, help="the board's .cfg")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument(
        "--offset", type=float, nargs=3, default=OFFSET_M, help="of the radar: right, ahead, up, m"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", action="append", default=[], help="key=value of the config")
    given = parser.parse_args()
    matplotlib.use("Agg")
    given.out.mkdir(parents=True, exist_ok=True)
    pairs, offset = read_pairs(given.pairs), np.array(given.offset)
    assert pairs.clouds is not None
    simulated = simulated_clouds(pairs, given.cfg, given.seed, offset, given.set)
    here, there = (statistics(clouds, pairs, offset) for clouds in (simulated, pairs.clouds))
    apart = distances(pairs.clouds, simulated, pairs)
    together = within_movements(pairs.clouds, simulated, pairs)
    means = [(name, f"{there[name]:.3g}", f"{here[name]:.3g}") for name in here]
    chamfer = [(name, f"{value:.3f}") for name, value in apart.items()]
    correlations = [(name, f"{value:.2f}") for name, value in together.items()]
    lines = [
        *table(("", "measured", "simulated"), means),
        "",
        *table(("Chamfer distance of measured frames to", "m"), chamfer),
        "",
        *table(("correlation within a movement, measured with simulated", ""), correlations),
    ]
    (given.out / "clouds.md").write_text("\n".join(lines) + "\n")
    report = {"simulated": here, "measured": there, "chamfer": apart, "correlation": together}
    (given.out / "clouds.json").write_text(json.dumps(report, indent=1) + "\n")
    draw_frames(pairs.clouds, simulated, pairs, offset, given.out / "frames.png")
    draw_statistics(pairs.clouds, simulated, given.out / "statistics.png")
    print("\n".join(lines))
    a, b = here, there
    print(
        f"points a frame: {a['points a frame']:.1f} (measured {b['points a frame']:.1f}); "
        f"zero Doppler: {a['share at zero Doppler']:.1%} ({b['share at zero Doppler']:.1%}); "
        f"to the bone: {a['median distance to a bone, m']:.3f} m "
        f"({b['median distance to a bone, m']:.3f} m); chamfer: {apart['simulated']:.3f} m "
        f"(next frame {apart['next']:.3f}, shuffled {apart['shuffled']:.3f})".replace("%", " %")
    )


if __name__ == "__main__":
    main()
