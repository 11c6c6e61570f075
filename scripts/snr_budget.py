"""The SNR from the raw sample to the cell of a map: theory, and what the maps have.

    python scripts/snr_budget.py [--per-class 4] [--report-only]

Each scene of the paper's two data sets is made three times: the echo alone, the noise alone, and
both again with the range gate. Noise scales with the SNR and nothing else does, so one SNR gives
all. Leaves docs/results/snr_budget.json, of which the tables of docs/results.md are made.
"""

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from reproduce_paper import ROOT, SCENARIOS, as_text, commit, read_json, table, write_page

from radhar_cli import load_config
from radhar_cli.arrays import Float
from radhar_cli.config.schema import Config
from radhar_cli.echo.half_band_sum import noise_gain
from radhar_cli.pipeline.plan import Product
from radhar_cli.pipeline.run import record
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene import Scene, draw_scene

BEGIN = "<!-- tables: scripts/snr_budget.py -->"
SNRS = (30, 20, 10, 0, -10, -20)
GATE = ("processing.range_sum=gated",)  # of 1 m to both sides of the torso
BODY = 0.9  # share of the echo's energy that the body's cells hold
STILL_DB = -60.0  # after the canceller: less is rounding


def db(ratio: float | np.floating[Any]) -> float:
    """10 log10, -inf at 0."""
    with np.errstate(divide="ignore"):
        return float(10 * np.log10(ratio))


@dataclass(frozen=True)
class Gains:
    """Gains of SNR that the chain has whatever the scene, in dB.

    Attributes:
        compression: N_ADC, of a scatterer in the bin where it lies.
        half_band: |G|^2/sum |D|^2 with |G| = N_FFT, from the raw sample to the sum over the kept
            bins; N_FFT/n_bins = 2 unpadded: the noise of all bins takes back what compression won.
        window: (sum g)^2/sum g^2, of a tone in the middle of a cell.
        gate: from the raw sample to the sum of the powers of `gate_bins`.
        recording: M, of a filter matched to the whole recording.
    """

    compression: float
    half_band: float
    window: float
    gate: float
    recording: float
    gate_bins: int


def gains(w: Waveform, frames: Frames, gate_bins: int) -> Gains:
    """The gains of a radar, its frames and its gate."""
    g = frames.window
    return Gains(
        compression=db(w.n_adc),
        half_band=db(w.n_fft**2 / noise_gain(w)),
        window=db(np.sum(g) ** 2 / np.sum(g**2)),
        gate=db(w.n_adc / gate_bins),
        recording=db(w.n_pulses),
        gate_bins=gate_bins,
    )


def silent(w: Waveform) -> Signal:
    """No echo."""
    return Signal(np.zeros(w.n_pulses, complex), 0.0, w.prf, w.f0)


def silent_bins(gated: Any) -> tuple[Any, None]:
    """No echo in the gate's bins."""
    return np.zeros((gated.bins.stop - gated.bins.start, gated.waveform.n_pulses), complex), None


SILENCE = (
    Product("slow_time", ("waveform",), silent, "no echo"),
    Product("gated_echo", ("gated",), silent_bins, "no echo"),
)


@dataclass(frozen=True)
class Parts:
    """Echo and noise of one scene at 0 dB, relative to P_s.

    Attributes:
        wall: mean sum A_i^2 with the wall over P_s.
        canceller: what it does to the echo's mean power, over what it does to the noise's.
        echo, noise: mean power of x[m].
        echo_map, noise_map: [frequency, time].
        gated_echo, gated_noise: the same of the gate.
    """

    wall: float
    canceller: float
    echo: float
    noise: float
    echo_map: Float
    noise_map: Float
    gated_echo: Float
    gated_noise: Float


def parts_of(scene: Scene, gated: Scene, **given: Any) -> Parts:
    """Make the parts of a scene, and those of the same one with the gate."""
    asked = ("signal", "stft")
    echo = record(scene, (*asked, "paths", "waveform"), receiver=(), **given)
    noise = record(scene, (*asked, "signal_power"), SILENCE, **given)
    in_gate = record(gated, ("stft",), receiver=(), **given)
    noise_in_gate = record(gated, ("stft",), SILENCE, **given)
    w, power = echo["waveform"], noise["signal_power"]
    paths = echo["paths"](w.times(np.arange(w.n_pulses, dtype=float)))
    a2 = paths.amplitude**2
    # |1 - exp(j phi)|^2 = 4 sin^2(phi/2) of the echo, 2 of white noise
    turn = 2 * np.sin(np.pi * w.f0 * np.diff(paths.delay)) ** 2
    return Parts(
        wall=a2.sum(0).mean() / power,
        canceller=(a2[:, 1:] * turn).sum(0).mean() / a2.sum(0).mean(),
        echo=float(np.mean(np.abs(echo["signal"].x) ** 2)) / power,
        noise=float(np.mean(np.abs(noise["signal"].x) ** 2)) / power,
        echo_map=echo["stft"].power / power,
        noise_map=noise["stft"].power / power,
        gated_echo=in_gate["stft"].power / power,
        gated_noise=noise_in_gate["stft"].power / power,
    )


def cells(echo: Float, noise: Float) -> tuple[float, float]:
    """Echo over mean noise: the largest of the map, the median of the body's cells.

    Those are the fewest cells that hold BODY of the echo's energy.

    Args:
        echo: map [frequency, time].
        noise: mean of the noise's map at each frequency [frequency].
    """
    ratio = echo / noise[:, None]
    order = np.argsort(echo, axis=None)[::-1]
    energy = np.cumsum(echo.ravel()[order])
    body = order[: np.searchsorted(energy, BODY * energy[-1]) + 1]
    return db(ratio.max()), db(np.median(ratio.ravel()[body]))


def budget(config: Config, gated: Config, per_class: int) -> dict[str, Any]:
    """The budget of a config at 0 dB, in dB: theory, measured scene by scene, medians."""
    drawn = [
        (activity, draw_scene(config, activity, n), draw_scene(gated, activity, n))
        for activity in config.every_class
        for n in range(per_class)
    ]
    parts = [parts_of(scene, in_gate) for _, scene, in_gate in drawn]
    noise = np.mean([p.noise_map.mean(1) for p in parts], axis=0)
    gated_noise = np.mean([p.gated_noise.mean(1) for p in parts], axis=0)
    products = record(drawn[0][2], ("waveform", "frames", "gate"))
    known = gains(products["waveform"], products["frames"], products["gate"].count)
    scenes = []
    for (activity, _, _), p in zip(drawn, parts, strict=True):
        moves = db(p.canceller) > STILL_DB
        peak, median = cells(p.echo_map, noise) if moves else (None, None)
        gated_peak, gated_median = cells(p.gated_echo, gated_noise) if moves else (None, None)
        scenes.append(
            {
                "class": activity.slug,
                "wall": db(p.wall),
                "canceller": db(p.canceller) if moves else None,
                "signal_theory": db(p.wall * p.canceller) + known.half_band if moves else None,
                "signal": db(p.echo / p.noise) if moves else None,
                "cell_theory": db(p.wall) + known.half_band + known.window,
                "peak": peak,
                "median": median,
                "gated_cell_theory": db(p.wall) + known.gate + known.window,
                "gated_peak": gated_peak,
                "gated_median": gated_median,
            }
        )
    return {
        "gains": {name: round(value, 2) for name, value in vars(known).items()},
        "scenes": {
            key: [round(s[key], 2) if isinstance(s[key], float) else s[key] for s in scenes]
            for key in scenes[0]
        },
    }


def read_budget(file: Path) -> dict[str, Any]:
    """The record, its scenes one by one."""
    contents = read_json(file)
    for scenario in contents["scenarios"].values():
        columns = scenario["scenes"]
        rows = zip(*columns.values(), strict=True)
        scenario["scenes"] = [dict(zip(columns, row, strict=True)) for row in rows]
    return contents


def median_of(scenes: list[dict[str, Any]], key: str) -> float:
    """Median of the scenes that have it: what is of the echo, those in which something moves."""
    return float(np.median([scene[key] for scene in scenes if scene[key] is not None]))


def disagreement(scenes: list[dict[str, Any]]) -> str:
    """How far x[m] as it is made lies from theory, scene by scene."""
    apart = [abs(s["signal"] - s["signal_theory"]) for s in scenes if s["signal"] is not None]
    return f"{np.median(apart):.1f} (median), {max(apart):.1f} (largest)"


def steps(b: Mapping[str, Any]) -> dict[str, str | float]:
    """The budget of a scenario at 0 dB, step by step."""
    gain, scenes = b["gains"], b["scenes"]
    wall, compression, half_band = median_of(scenes, "wall"), gain["compression"], gain["half_band"]
    return {
        "raw sample, free space: what `snr_db` says": 0.0,
        "wall, both ways": wall,
        "range compression, in the scatterer's bin": compression,
        "coherent sum over the kept bins: noise of all of them": half_band - compression,
        "canceller, mean power": median_of(scenes, "canceller"),
        "**slow-time signal x[m], theory**": median_of(scenes, "signal_theory"),
        "x[m] as it is made": median_of(scenes, "signal"),
        "apart in a scene": disagreement(scenes),
        "window of the STFT, a tone": gain["window"],
        "**all of the echo in one cell, theory**": median_of(scenes, "cell_theory"),
        "strongest cell of the maps": median_of(scenes, "peak"),
        "median of the body's cells": median_of(scenes, "median"),
        "gate of 1 m: all of the echo in one cell, theory": median_of(scenes, "gated_cell_theory"),
        "gate: strongest cell": median_of(scenes, "gated_peak"),
        "gate: median of the body's cells": median_of(scenes, "gated_median"),
        "filter matched to the whole echo, of x[m], theory": wall + half_band + gain["recording"],
        "the same, of the raw samples": wall + compression + gain["recording"],
    }


def readings(b: Mapping[str, Any]) -> dict[str, float]:
    """What an SNR of -10 dB would be as our `snr_db`, if it were that of another place."""
    wall = median_of(b["scenes"], "wall")
    return {
        "a raw sample, of the echo in free space (ours)": -10.0,
        "a raw sample, of the echo that is received": -10 - wall,
        "after range compression, in the scatterer's bin": -10 - wall - b["gains"]["compression"],
        "the sum over the bins, before the canceller": -10 - wall - b["gains"]["half_band"],
        "x[m], after the canceller": -10 - median_of(b["scenes"], "signal_theory"),
        "the strongest cell of the map": -10 - median_of(b["scenes"], "peak"),
    }


def page_text(contents: Mapping[str, Any]) -> str:
    """The tables."""
    both = [contents["scenarios"][name] for name in SCENARIOS]

    def side_by_side(columns: list[Mapping[str, str | float]]) -> list[list[str]]:
        values = ([column[words] for column in columns] for words in columns[0])
        text = ([v if isinstance(v, str) else f"{v:+.1f}" for v in row] for row in values)
        return [[words, *row] for words, row in zip(columns[0], text, strict=True)]

    per_class = len(both[0]["scenes"]) // 12
    lines = [
        f"Made by `python scripts/snr_budget.py --per-class {per_class}` at {contents['commit']}: "
        f"medians over {12 * per_class} scenes of each config, dB, at 0 dB; stationary people, of "
        "whom the canceller leaves nothing, are left out.",
        "",
        *table(["", *SCENARIOS.values()], side_by_side([steps(b) for b in both])),
    ]
    head = ["scenario", "", *(f"{snr} dB" for snr in SNRS)]
    body = []
    for name, b in zip(SCENARIOS.values(), both, strict=True):
        for words, key in (
            ("all in one cell, theory", "cell_theory"),
            ("strongest cell", "peak"),
            ("median of the body's cells", "median"),
        ):
            value = median_of(b["scenes"], key)
            body.append([name, words, *(f"{value + snr:+.1f}" for snr in SNRS)])
    lines += ["The same over the SNR of the data:", "", *table(head, body)]
    slugs = list(dict.fromkeys(scene["class"] for scene in both[0]["scenes"]))
    rows = []
    for slug in slugs:
        row = [slug]
        for b in both:
            mine = [scene for scene in b["scenes"] if scene["class"] == slug]
            moves = any(scene["peak"] is not None for scene in mine)
            row += [
                f"{median_of(mine, key) - 10:+.1f}" if moves else "no echo"
                for key in ("peak", "median")
            ]
        rows.append(row)
    head = ["class, at -10 dB"]
    for words in SCENARIOS.values():
        head += [f"{words}: strongest cell", "median of the body's cells"]
    return "\n".join([*lines, "Class by class:", "", *table(head, rows)])


def main() -> None:
    """Measure, and write record and tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--per-class", type=int, default=4)
    parser.add_argument("--report-only", action="store_true", help="write the tables, no more")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "results.md")
    options = parser.parse_args()
    file = options.page.parent / "results" / "snr_budget.json"
    if not options.report_only:
        scenarios = {}
        for name in SCENARIOS:
            config = ROOT / "configs" / "paper" / f"{name}.yaml"
            both = (load_config(config, ["snr_db=0", *more]) for more in ((), GATE))
            scenarios[name] = budget(*both, options.per_class)
        contents = {"commit": (commit()["commit"] or "")[:7], "snr_db": 0, "scenarios": scenarios}
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(as_text(contents))
    write_page(options.page, page_text(read_budget(file)), BEGIN)


if __name__ == "__main__":
    main()
