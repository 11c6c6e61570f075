"""What one sample costs here and with others, in one run: mmwrt, plain NumPy, radhar.

    python -m venv build/mmwrt && build/mmwrt/bin/pip install mmwrt==0.0.14 tqdm
    python scripts/bench_peers.py [--rounds 3] [--out build/bench_peers]
        [--mmwrt build/mmwrt/bin/python]

Scene: configs/paper/free_space.yaml without noise, a person of 13 points who walks: 20,000 chirps
of 400 samples at 77 GHz, one channel. Processor time of one process, medians over rounds in which
all take turns; what would take minutes is timed on some chirps and extrapolated, and said so. Two
models are computed, each by ours and by others, and the signals are compared:

- delays at every ADC sample, the residual video phase kept, amplitudes one: what mmwrt computes;
- delays of a chirp at its start, amplitudes of the radar equation: the paper's, and our default.

OUT.md and OUT.json are written. Figures that others have published stand below, with machines.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from radhar_cli.config import load_config
from radhar_cli.dataset.trial import make_trial_sample
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import Paths
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, draw_scene

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "configs/paper/free_space.yaml"
WALKING = next(activity for activity in ACTIVITIES if activity.slug == "walking")
MMWRT_BEAT = ROOT / "scripts/mmwrt_beat.py"
MMWRT = ROOT / "build/mmwrt/bin/python"
INSTALL = "python -m venv build/mmwrt && build/mmwrt/bin/pip install mmwrt==0.0.14 tqdm"
CHIRPS = 100  # of models that would take minutes
DB = 20

# What others have published; nothing of it was measured here. A path sample is one scatterer in one
# ADC sample of one channel.
PUBLISHED = (
    {
        "program": "witwin-radar, main branch of 19 September 2026",
        "workload": "30 s of a walking body, 128 points on a mesh, 300 frames of 384 chirps x 256 "
        "samples x 4 receivers",
        "machine": "NVIDIA RTX 5080 (Windows, desktop in use)",
        "seconds": 14.274506,
        "path_samples": 300 * 384 * 256 * 4 * 128,
        "source": "github.com/witwin-ai/witwin-radar, docs/dev/audit/"
        "radar-adc-cuda-fusion-2026-09-19.md",
    },
    {
        "program": "witwin-radar",
        "workload": "two moving points (limbs), 1024 chirps x 128 samples",
        "machine": "NVIDIA RTX 5080, AMD Ryzen 7 9800X3D",
        "seconds": 0.16927,
        "path_samples": 1024 * 128 * 2,
        "source": "github.com/witwin-ai/witwin-radar, docs/dev/audit/"
        "radar-matlab-comparison-2026-09-17.md",
    },
    {
        "program": "MATLAB R2025b, radarTransceiver",
        "workload": "the same two points, measured by the authors of witwin-radar",
        "machine": "AMD Ryzen 7 9800X3D, double precision",
        "seconds": 0.29514,
        "path_samples": 1024 * 128 * 2,
        "source": "the same page",
    },
)
UNPUBLISHED = (
    "RadHARSimulator V1, the paper's MATLAB tool: neither the paper (arXiv 2509.06751) nor its "
    "repository states a time of simulation; its table has times of networks (NVIDIA RTX 3060). "
    "It is an installer without sources, for MATLAB, and was not timed.",
    "RadarSimPy: not on PyPI; its C++ core can be built by those who have bought access, and the "
    "binaries are handed out at radarsimx.com. It was not timed, and no figure was found.",
    "SimHumalator (MATLAB) and MATLAB's backscatterPedestrian: no published time was found. The "
    "latter is sampled at the bandwidth of the chirp, 4 GHz here "
    "(MATLAB Answers 517935, 519868), 160,000 samples a chirp instead of 400.",
    "witwin-radar needs CUDA and has a licence of its own (research or commercial): not timed.",
)


@dataclass(frozen=True)
class Case:
    """A scene without noise, as each of the programs needs it."""

    scene: Scene
    waveform: Waveform
    source: Any  # its paths
    motion: Any
    tx: Float  # m
    rx: Float

    @classmethod
    def of(cls, *overrides: str) -> "Case":
        """The person who walks, with settings beside."""
        scene = draw_scene(load_config(CONFIG, ["snr_db=null", *overrides]), WALKING, 0)
        made = record(scene, ["paths", "waveform", "motions", "antennas"])
        antennas = made["antennas"]
        places = (np.array(place, float) for place in (antennas.tx, antennas.rx))
        return cls(scene, made["waveform"], made["paths"], made["motions"][0], *places)

    def steps(self, chirps: int) -> tuple[Float, Float]:
        """Positions at the starts of chirps, mean velocities within them [point, axis, chirp]."""
        begin = self.waveform.times(np.arange(chirps, dtype=float))
        start = self.motion.positions(begin)
        end = self.motion.positions(begin + self.waveform.chirp)
        return tuple(
            np.ascontiguousarray(x.transpose(1, 0, 2))
            for x in (start, (end - start) / self.waveform.chirp)
        )


class UnitPaths:
    """Paths of a source, all with the amplitude one."""

    def __init__(self, source: Any) -> None:
        self._source = source

    def __call__(self, t: Float) -> Paths:
        delay = self._source(t).delay
        return Paths(delay, np.ones_like(delay))


def numpy_moving(case: Case, chirps: int) -> Complex:
    """Beat [N_ADC, chirps] by plain NumPy: delays at every ADC sample, amplitudes one."""
    w, (start, speed) = case.waveform, case.steps(chirps)
    t = np.arange(w.n_adc)[:, None] / w.adc_rate
    beat = np.zeros((w.n_adc, chirps), complex)
    for p, v in zip(start, speed, strict=True):
        place = p[:, None] + v[:, None] * t
        legs = (np.linalg.norm(place - end[:, None, None], axis=0) for end in (case.tx, case.rx))
        tau = sum(legs) / SPEED_OF_LIGHT
        beat += np.exp(-2j * np.pi * (w.fc * tau + w.slope * tau * t - w.slope * tau**2 / 2))
    return beat


def numpy_stopped(case: Case) -> Complex:
    """Beat [N_ADC, M] by plain NumPy: the paper's formula as it stands, for the whole recording."""
    w = case.waveform
    t = np.arange(w.n_adc)[:, None] / w.adc_rate
    beat = np.zeros((w.n_adc, w.n_pulses), complex)
    delays, amplitudes = case.source(w.times(np.arange(w.n_pulses, dtype=float)))[:2]
    for tau, a in zip(delays, amplitudes, strict=True):
        beat += a * np.exp(-2j * np.pi * (w.fc * tau + w.slope * tau * t))
    return beat


def exact_moving(case: Case, chirps: int) -> Complex:
    """Beat [N_ADC, chirps] by our exact engine, as `numpy_moving`."""
    waveform = replace(case.waveform, residual_video_phase=True)
    return moving_beat_matrix(UnitPaths(case.source), waveform, np.arange(chirps, dtype=float))


def exact_stopped(case: Case) -> Complex:
    """Beat [N_ADC, M] by our exact engine, as `numpy_stopped`."""
    return np.concatenate(list(beat_blocks(case.source, case.waveform)), axis=1)


def fast_signal(case: Case) -> Complex:
    """Slow-time signal by our fast engine: after MTI, summed over the range bins."""
    scene = replace(case.scene)  # without the positions that it holds
    return record(scene, ["signal"])["signal"].x[0, 0]


def whole_sample() -> tuple[None, float]:
    """A sample of a data set, from its draw to the bytes of its PNG file; its processor time, s."""
    config = load_config(CONFIG, [f"activities=[{WALKING.slug}]"])
    return None, make_trial_sample(config, "peers", 0).processor


def signal_of(beat: Complex, w: Waveform) -> Complex:
    """The same of a beat matrix [N_ADC, M], by its FFT."""
    k = np.arange(w.n_fft)[:, None]
    bins = np.fft.ifft(np.diff(beat, axis=1), w.n_fft, axis=0) * w.n_fft
    bins *= np.exp(-2j * np.pi * k * w.n0 / w.n_fft)
    return bins[: w.n_bins].sum(axis=0)


def difference_db(x: Complex, y: Complex) -> float:
    """Relative L2 difference of two signals, dB."""
    return float(DB * np.log10(np.linalg.norm(x - y) / np.linalg.norm(y)))


def mmwrt_beat(case: Case, chirps: int, python: Path) -> tuple[Complex, float]:
    """Beat [N_ADC, chirps] by mmwrt, as `numpy_moving`, and its processor time, s."""
    w, (start, speed) = case.waveform, case.steps(chirps)
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "given.npz"), Path(folder, "made.npz")
        radar = np.array([w.fc, w.slope, w.chirp, w.adc_rate, w.prf, SPEED_OF_LIGHT])
        np.savez(given, radar=radar, start=start, speed=speed, count=chirps, tx=case.tx, rx=case.rx)
        subprocess.run([python, MMWRT_BEAT, given, made], check=True, stdout=subprocess.DEVNULL)
        with np.load(made) as result:  # its phases have the other sign
            return result["beat"].conj(), float(result["seconds"])


def version_of_mmwrt(python: Path) -> str | None:
    """Version of mmwrt that a Python has, or None."""
    words = "import importlib.metadata as m, mmWrt.Raytracing; print(m.version('mmwrt'))"
    try:
        done = subprocess.run([python, "-c", words], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.split()[-1]


@dataclass(frozen=True)
class Row:
    """One program: what it computes, and its time for some chirps."""

    program: str
    model: str
    chirps: int  # that were computed
    work: Callable[[], tuple[Any, float]]  # result and processor time, s


def timed(function: Callable[[], Complex]) -> Callable[[], tuple[Complex, float]]:
    """The function, with its processor time beside its result."""

    def run() -> tuple[Complex, float]:
        begun = process_time()
        result = function()
        return result, process_time() - begun

    return run


MOVING, STOPPED = "delays at every ADC sample", "delays of a chirp at its start"
FAST = f"{STOPPED}; MTI and sum over range"
WHOLE = "the same, drawn, checked, with noise, STFT and image"


def programs(case: Case, chirps: int, python: Path | None) -> list[Row]:
    """All that are compared; mmwrt where its Python is given."""
    pulses = case.waveform.n_pulses
    rows = [
        Row("plain NumPy", MOVING, chirps, timed(lambda: numpy_moving(case, chirps))),
        Row("radhar, exact engine", MOVING, chirps, timed(lambda: exact_moving(case, chirps))),
        Row("plain NumPy", STOPPED, pulses, timed(lambda: numpy_stopped(case))),
        Row("radhar, exact engine", STOPPED, pulses, timed(lambda: exact_stopped(case))),
        Row(
            "radhar, fast engine (default)",
            FAST,
            pulses,
            timed(lambda: fast_signal(case)),
        ),
        Row("radhar, a sample of a data set", WHOLE, pulses, whole_sample),
    ]
    if python is not None:
        name = f"mmwrt {version_of_mmwrt(python)}"
        rows.insert(0, Row(name, MOVING, chirps, lambda: mmwrt_beat(case, chirps, python)))
    return rows


def compare(case: Case, rounds: int, chirps: int, python: Path | None) -> list[dict[str, Any]]:
    """Time all programs in turn, and compare their signals; a dict for each, with its figures."""
    rows, results = programs(case, chirps, python), list[Complex]()
    times: list[list[float]] = [[] for _ in rows]
    for turn in range(rounds + 1):  # the first warms up
        for number, row in enumerate(rows):
            result, seconds = row.work()
            if turn == 0:
                results.append(result)
            else:
                times[number].append(seconds)
    pulses, w = case.waveform.n_pulses, case.waveform
    reference = {
        row.model: x for row, x in zip(rows, results, strict=True) if "NumPy" in row.program
    }
    table = []
    for row, x, seconds in zip(rows, results, times, strict=True):
        error = None
        if row.model == FAST:
            error = difference_db(x, signal_of(reference[STOPPED], w))
        elif row.model in reference and "NumPy" not in row.program:
            # The first sample of a chirp comes before its echo, which mmwrt does not pretend.
            error = difference_db(x[1:], reference[row.model][1:])
        a_chirp = median(seconds) / row.chirps
        table.append(
            {
                "program": row.program,
                "model": row.model,
                "chirps": row.chirps,
                "ms_a_chirp": 1e3 * a_chirp,
                "seconds_a_sample": a_chirp * pulses,
                "extrapolated": row.chirps < pulses,
                "million_path_samples_a_second": len(case.motion.names) * w.n_adc / a_chirp / 1e6,
                "rounds": seconds,
                "difference_from_numpy_db": error,
            }
        )
    fast = next(row["seconds_a_sample"] for row in table if row["model"] == FAST)
    return [row | {"times_the_fast_engine": row["seconds_a_sample"] / fast} for row in table]


def markdown(table: list[dict[str, Any]], heading: str) -> str:
    """The figures as tables in Markdown."""
    lines = [
        heading,
        "",
        "| program | model | ms a chirp | s a sample | times the fast engine | "
        "million path samples a second | from plain NumPy, dB |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in table:
        error = row["difference_from_numpy_db"]
        sample = f"{row['seconds_a_sample']:.3g}"
        sample += f" (from {row['chirps']} chirps)" if row["extrapolated"] else ""
        lines.append(
            f"| {row['program']} | {row['model']} | {row['ms_a_chirp']:.3g} | {sample} | "
            f"{row['times_the_fast_engine']:.3g} | {row['million_path_samples_a_second']:.3g} | "
            f"{'' if error is None else f'{error:.0f}'} |"
        )
    lines += [
        "",
        "Published by others, on their machines:",
        "",
        "| program | workload | machine | s | million path samples a second | source |",
        "| --- | --- | --- | ---: | ---: | --- |",
    ]
    for known in PUBLISHED:
        rate = known["path_samples"] / known["seconds"] / 1e6
        lines.append(
            f"| {known['program']} | {known['workload']} | {known['machine']} | "
            f"{known['seconds']:.3g} | {rate:.3g} | {known['source']} |"
        )
    return "\n".join([*lines, "", *(f"- {line}" for line in UNPUBLISHED), ""])


def machine() -> str:
    """Processor and Python of this run, and how busy it was."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = (line for line in cpuinfo.read_text().splitlines() if line.startswith("model name"))
        model = next(names, f": {model}").partition(": ")[2]
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    cores = os.cpu_count()
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}"
    return f"{model}, {cores} cores, load {load}; {versions}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--chirps", type=int, default=CHIRPS, help="of models that take minutes")
    parser.add_argument("--mmwrt", type=Path, default=MMWRT, help="a Python that has mmwrt")
    parser.add_argument("--out", type=Path, default=Path("build/bench_peers"))
    arguments = parser.parse_args()
    prepare_process()
    python = arguments.mmwrt if version_of_mmwrt(arguments.mmwrt) else None
    if python is None:
        print(
            f"{arguments.mmwrt} has no mmwrt, which is left out; install it: {INSTALL}",
            file=sys.stderr,
        )
    case, before = Case.of(), machine()
    table = compare(case, arguments.rounds, arguments.chirps, python)
    text = markdown(table, f"{before}; medians of {arguments.rounds} rounds, processor time")
    print(text)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.with_suffix(".md").write_text(text)
    report = {
        "machine": before,
        "rows": table,
        "published": PUBLISHED,
        "unpublished": UNPUBLISHED,
    }
    arguments.out.with_suffix(".json").write_text(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
