"""How far the error that the direct engine states is from the true one, over random scenes.

    python scripts/studies/stated_errors.py [--scenes 144] [--seed 1]

The true error is that against the exact sum at every pulse: paths that are not interpolated, phases
that are not rounded; of gates and of boards, against the beat samples of every pulse.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from radhar_cli.activities.activity import ACTIVITIES
from radhar_cli.config.data_set import Config
from radhar_cli.echo.accuracy import AccuracyError, exact_sum
from radhar_cli.echo.board_cube import exact_cube, fast_cube
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.exact import exact_echo
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.errors import SceneError
from radhar_cli.numerics.arrays import Complex
from radhar_cli.products.run import record
from radhar_cli.scene import Scene, draw_scene

# Bodies in the air or above a floor; in a closed room; before a stepped radar; a gate; a board, in
# the open and in a room.
KINDS = (
    "points",
    "segments",
    "surfaces",
    "segments",
    "room",
    "stepped",
    "gate",
    "board",
    "board in a room",
)
TOLERANCES_DB = (-80.0, -80.0, -80.0, -90.0, -100.0, -110.0, -120.0)
BOARDS = Path(__file__).resolve().parents[2] / "configs" / "boards"
OF_BOARDS = ("board", "board in a room")
OF_ROOMS = ("room", "board in a room")
CHUNK = 2**12  # pulses whose exact paths are in memory at once


class ErrorsOfScene(NamedTuple):
    """Relative error (dB) of a scene after the canceller: what was allowed, stated and is true."""

    label: str
    tolerance_db: float
    stated_db: float
    true_db: float


def draw_config(rng: np.random.Generator, kind: str) -> dict[str, object]:
    """Draw a radar of 2 to 81 GHz, or a board, and a person of some body and surroundings."""
    body = kind if kind in ("points", "segments", "surfaces") else "points"
    if kind in ("room", "stepped", *OF_BOARDS):
        body = str(rng.choice(["points", "segments", "surfaces"]))
    drawn: dict[str, object] = {
        "seed": int(rng.integers(2**31)),
        "snr_db": None,
        "duration_s": float(rng.uniform(1.5, 3.0)) if kind not in OF_ROOMS + OF_BOARDS else 1.5,
        "body": {"scatterers": body},
        "motion": {"model": "human", "place": {"range_m": {"uniform": [2.5, 5.0]}}},
        "on_invalid": "keep",
    }
    if kind in OF_ROOMS:
        drawn |= draw_room(rng)
    if kind in OF_BOARDS:
        name = str(rng.choice(["iwr1443_10Hz", "iwr1443_30Hz"]))
        commands = (BOARDS / f"{name}.cfg").read_text()
        place = [0.1, 0.0, 1.0]  # in the room
        return drawn | {"radar": {"device": "IWR1443BOOST", "cfg": commands, "position_m": place}}
    carrier = float(rng.choice([2e9, 5.8e9, 24e9, 60e9, 77e9]))
    radar: dict[str, object] = {
        "carrier_hz": carrier,
        "bandwidth_hz": carrier * float(rng.choice([0.02, 0.05])),
        "prf_hz": 8000.0 if carrier > 50e9 else 2000.0,
    }
    if kind == "stepped":
        radar |= {"waveform": "sfcw", "steps": 100, "dwell_s": 2e-5, "prf_hz": 450.0}
    processing: dict[str, object] = {
        "clutter": str(rng.choice(["difference", "difference", "mean", "highpass", "none"]))
    }
    if kind == "gate":
        processing |= {"range_sum": "gated", "gate_m": 0.5}
    drawn |= {"radar": radar, "processing": processing}
    if kind == "room":
        return drawn
    return drawn | {"room": {"faces": {"floor": "concrete"} if rng.random() < 0.2 else None}}


def draw_room(rng: np.random.Generator) -> dict[str, object]:
    """Draw a closed room of two to five faces, each of some material."""
    names = ("floor", "left", "right", "back", "ceiling")
    chosen = rng.permutation(names)[: int(rng.integers(2, 6))]
    faces = {str(name): str(rng.choice(["concrete", "wood", "metal"])) for name in chosen}
    box = {"x": [0, 7], "y": [-3, 3], "height": 2.6}
    return {"room": {"box_m": box, "faces": faces, "order": 1}}


def compare_errors(scenes: int, seed: int) -> Iterator[ErrorsOfScene]:
    """Draw scenes and compare the errors of those that the direct engine makes."""
    rng = np.random.default_rng(seed)
    for number in range(scenes):
        kind, activity = KINDS[number % len(KINDS)], ACTIVITIES[number // len(KINDS) % 12]
        drawn = draw_config(rng, kind)
        tolerance_db = float(rng.choice(TOLERANCES_DB))
        config = Config.model_validate(drawn | {"engine": {"tolerance_db": tolerance_db}})
        try:
            scene = draw_scene(config, activity, 0)
            errors_of = errors_of_board if kind in OF_BOARDS else errors_of_signal
            stated_db, true_db = errors_of(scene, tolerance_db)
        except (AccuracyError, SceneError) as error:
            print(f"{kind}, {activity.slug}, seed {drawn['seed']}: {error}", flush=True)
            continue
        if np.isfinite([stated_db, true_db]).all():
            label = f"{kind}, {activity.slug}, seed {drawn['seed']}"
            yield ErrorsOfScene(label, tolerance_db, stated_db, true_db)


def errors_of_board(scene: Scene, tolerance_db: float) -> tuple[float, float]:
    """Stated and true error (dB) of the cube of a board."""
    made = record(scene, ["channels", "board"])
    cube, _, stated_db = fast_cube(made["channels"], made["board"], tolerance_db)
    exact, _ = exact_cube(made["channels"], made["board"])
    return stated_db, relative_db(cube - exact, exact)


def errors_of_signal(scene: Scene, tolerance_db: float) -> tuple[float, float]:
    """Stated and true error (dB) of a signal, or of the bins of a gate, after the canceller."""
    if scene.config.processing.range_sum == "gated":
        echo: DirectEcho = record(scene, ["gated"])["gated"]
    else:
        made = record(scene, ["paths", "waveform", "canceller"])
        echo = DirectEcho(
            made["paths"], made["waveform"], tolerance_db, canceller=made["canceller"]
        )
    y, stated = echo.rows()
    exact = exact_rows(echo)
    error, x = echo.canceller(y - exact), echo.canceller(exact)
    if isinstance(echo, GatedEcho):
        counted = echo.counted_bins()
        error, x = np.where(counted, error, 0), np.where(counted, x, 0)
    return stated.error_db, relative_db(error, x)


def exact_rows(echo: DirectEcho) -> Complex:
    """Exact signals [K, M] of an echo before the canceller."""
    if isinstance(echo, GatedEcho):
        static = not echo.canceller.removes_static
        return exact_echo(echo.source, [echo.look], static=static)[0]
    pulses = np.arange(echo.waveform.n_pulses)
    parts = [
        exact_sum(echo.source, echo.waveform, pulses[start : start + CHUNK], (1.0,))
        for start in range(0, pulses.size, CHUNK)
    ]
    return np.concatenate(parts)[None]


def relative_db(error: Complex, x: Complex) -> float:
    """Relative L2 error, dB."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return 20 * float(np.log10(np.linalg.norm(error) / np.linalg.norm(x)))


def main() -> None:
    """Print every scene, and the worst."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=144)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    scenes = list[ErrorsOfScene]()
    for scene in compare_errors(arguments.scenes, arguments.seed):
        scenes.append(scene)
        print(
            f"{scene.label}: tolerance {scene.tolerance_db:.0f}, stated {scene.stated_db:.1f}, "
            f"true {scene.true_db:.1f} dB",
            flush=True,
        )
    excess_db = np.array([scene.true_db - scene.stated_db for scene in scenes])
    beyond = sum(scene.true_db > scene.tolerance_db for scene in scenes)
    print(
        f"{len(scenes)} scenes: stated at most {excess_db.max():.1f} dB better than true, "
        f"{-excess_db.min():.1f} dB worse; standard deviation {excess_db.std():.1f} dB; "
        f"{beyond} beyond their tolerance"
    )


if __name__ == "__main__":
    main()
