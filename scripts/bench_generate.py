"""What a sample costs, and against what: naive cube, cube engine, direct engine, the floor.

    python scripts/bench_generate.py [--rounds 5] [--json build/bench.json] [--only rows,maps,...]
        [--against TREE]

Every ratio comes from one run whose rows are interleaved; times are medians over the rounds, of
processor time where one process does the work.
Scene: configs/paper/free_space.yaml, 4 s at 77 GHz, 256 x 256, noise on, PNG and HDF5 level 1,
one process.
"""

import argparse
import ast
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from radhar_cli.config import MAP_NAMES, Config, load_config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.sample import SampleRow, StoredSample, synthesise
from radhar_cli.dataset.shards import encode_shard, write_shard
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.exact import beat_at
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.signal import Signal, shown_pulses
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.plan import Plan, Product, plan
from radhar_cli.scene.products.run import record, run
from radhar_cli.scene.products.signal import signal_of_look
from radhar_cli.scene.products.table import plan_images, products
from radhar_cli.scene.scene import Scene, draw_scene

ROOT = Path(__file__).resolve().parents[1]
PAPER = ROOT / "configs/paper/free_space.yaml"
SHARD = 16


def timed(function: Callable[[], Any], clock: Callable[[], float] = time.perf_counter) -> float:
    start = clock()
    function()
    return clock() - start


def interleaved(
    rows: dict[str, Callable[[int], Any]],
    rounds: int,
    clock: Callable[[], float] = time.process_time,
) -> dict[str, list[float]]:
    """Time every row once a round, round after round, after one round of warming up."""
    for function in rows.values():
        function(0)
    results: dict[str, list[float]] = {name: [] for name in rows}
    for turn in range(rounds):
        for name, function in rows.items():
            results[name].append(timed(lambda function=function, turn=turn: function(turn), clock))
    return results


def program(tree: Path, name: str) -> str:
    """Program that a tree's own copy of this script measures it with, as its names are its own."""
    for node in ast.parse((tree / "scripts/bench_generate.py").read_text()).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name:
            return str(ast.literal_eval(node.value))
    raise SystemExit(f"{tree}: its scripts/bench_generate.py has no {name}")


def scene(config: Config, number: int) -> Scene:
    """A drawn scene; consecutive numbers go through the classes."""
    return draw_scene(config, ACTIVITIES[number % 12], number // 12)


def naive_beat(paths: PathSource, w: Waveform) -> np.ndarray:
    """s_b[n, m], complex128, one vectorised exponential a scatterer: the formula as it stands."""
    n = np.arange(w.n_adc)[:, None]
    beat = np.zeros((w.n_adc, w.n_pulses), dtype=complex)
    for tau, a in zip(*paths(w.times(np.arange(w.n_pulses, dtype=float)))[:2], strict=True):
        beat += a * np.exp(-2j * np.pi * (w.fc * tau + w.slope * tau * n / w.adc_rate))
    return beat


def naive_signal(scene: Scene) -> np.ndarray:
    """x[m] the naive way: whole cube, noise on every sample, MTI, FFT of everything, sum."""
    recording = record(scene, ["paths", "waveform", "noise"])
    w, receiver = recording["waveform"], recording["noise"]
    beat = naive_beat(recording["paths"], w)
    noise = receiver.stream("beat").standard_normal((2, *beat.shape)) * np.sqrt(0.5)
    beat += receiver.sigma * (noise[0] + 1j * noise[1])
    moving = np.diff(beat, axis=1)
    k = np.arange(w.n_fft)[:, None]
    bins = np.fft.ifft(moving, w.n_fft, axis=0) * w.n_fft
    bins *= np.exp(-2j * np.pi * k * w.n0 / w.n_fft)
    return bins[: w.n_bins].sum(axis=0)


class Sink:
    """Writes samples as a build does: a PNG each, and a shard for every 16."""

    def __init__(self, config: Config, folder: Path) -> None:
        self.config, self.folder = config, folder
        self.whose = identity_hash(identity(config))
        self.table = colour_table(config.image.colour_map)
        self.values = scene_fields.values(scene(config, 0), scene_fields.fields(config))

    def write(self, samples: list[StoredSample]) -> None:
        for sample in samples:
            for name, image in sample.images.items():
                data = encode_png(image.levels, self.table, self.config.output.png_level)
                write_whole(self.folder, self.folder / "png" / f"{name}.png", data)
        rows = [SampleRow(sample, self.values) for sample in samples]
        data = encode_shard(self.config, self.whose, 0, rows)
        write_shard(self.folder, 0, len(samples), data)


class Floor:
    """A map's image from ready inputs: slow-time signal, torso track, beat at the pulses shown."""

    def __init__(self, config: Config, name: str) -> None:
        self.name = name
        self.table = products(config)
        self.table["range_profiles"] = Product(
            "range_profiles",
            ("beat", "waveform", "canceller"),
            self.profiles,
            "of the beat that is ready",
        )
        self.plan: Plan | None = None

    @staticmethod
    def profiles(beat: Complex, w: Waveform, canceller: Fir) -> Signal:
        shown = shown_pulses(w.n_pulses - canceller.lost, beat.shape[1])
        look = Look("", RangeBins(w), shown, canceller.taps)
        return signal_of_look(look.fast(beat), look)

    def sample(self, ready: dict[str, Any]) -> StoredSample:
        """The image alone, as a sample."""
        self.plan = self.plan or plan(self.table, [f"image:{self.name}"], ready)
        image = run(self.plan, ready)[f"image:{self.name}"]
        return StoredSample({self.name: image})


def rows(rounds: int) -> dict[str, Any]:
    """Milliseconds a sample: naive, cube, direct, floor; synthesis alone; errors."""
    config = load_config(PAPER)
    cube_config = load_config(PAPER, ["engine.kind=cube"])
    exact = load_config(PAPER, ["engine.kind=cube", "snr_db=null"])
    closed = load_config(PAPER, ["snr_db=null"])
    with tempfile.TemporaryDirectory() as place:
        sink, image = Sink(config, Path(place)), Floor(config, "stft")
        ready = [
            {"scene": drawn, **record(drawn, ["signal", "waveform"]).products}
            for drawn in (scene(config, number) for number in range(12))
        ]

        def floor(turn: int) -> None:
            numbers = range(turn * SHARD, (turn + 1) * SHARD)
            sink.write([image.sample(ready[number % 12]) for number in numbers])

        def direct(turn: int) -> None:
            p = plan_images(config)
            sink.write(
                [synthesise(scene(config, turn * SHARD + i), p, config) for i in range(SHARD)]
            )

        def synthesis(turn: int) -> None:
            p = plan(products(config), ["signal"], ["scene"])
            for i in range(SHARD):
                run(p, {"scene": scene(config, turn * SHARD + i)})

        def cube(turn: int) -> None:
            p = plan_images(cube_config)
            for number in (turn, turn + 6):
                sink.write([synthesise(scene(cube_config, number), p, cube_config)])

        def naive(turn: int) -> None:
            there = ready[turn % 12]
            x = naive_signal(scene(config, turn % 12))
            signal = there["signal"].with_samples(x[None, None])
            sink.write([image.sample(there | {"signal": signal})])

        results = interleaved(
            {
                "naive": naive,
                "cube": cube,
                "direct": direct,
                "synthesis": synthesis,
                "floor": floor,
            },
            rounds,
        )
    ms = {
        name: 1e3 * median(seconds) / {"naive": 1, "cube": 2}.get(name, SHARD)
        for name, seconds in results.items()
    }
    errors = {"cube_against_naive": 0.0, "direct_after_mti_db": -np.inf}
    for number in range(12):
        reference = record(scene(exact, number), ["signal", "paths", "waveform"])
        x = reference["signal"].x[0, 0]
        y = record(scene(closed, number), ["signal"])["signal"].x[0, 0]
        if number in (1, 7):
            paths, w = reference["paths"], reference["waveform"]
            beat, at = naive_beat(paths, w), np.arange(0, w.n_pulses, 97)
            fast = beat_matrix(*paths(w.times(at.astype(float)))[:2], w)
            gap = np.linalg.norm(fast - beat[:, at]) / np.linalg.norm(beat[:, at])
            errors["cube_against_naive"] = max(errors["cube_against_naive"], float(gap))
        if np.any(x):
            gap = 20 * np.log10(np.linalg.norm(y - x) / np.linalg.norm(x))
            errors["direct_after_mti_db"] = max(errors["direct_after_mti_db"], float(gap))
    ratios = {
        "direct_times_faster_than_naive": ms["naive"] / ms["direct"],
        "cube_times_faster_than_naive": ms["naive"] / ms["cube"],
        "synthesis_over_floor": ms["synthesis"] / ms["floor"],
    }
    print("\nmilliseconds a sample, end to end (one process)")
    for name, value in ms.items():
        label = (
            f"{name} (scene to slow-time signal, noise included)" if name == "synthesis" else name
        )
        print(f"  {label:<60}{value:10.2f}")
    print(f"  direct is {ratios['direct_times_faster_than_naive']:.0f} times faster than naive")
    print(f"  cube is {ratios['cube_times_faster_than_naive']:.1f} times faster than naive")
    print(f"  synthesis is {ratios['synthesis_over_floor']:.2f} of the floor")
    print(f"  cube against naive, worst relative L2 error {errors['cube_against_naive']:.1e}")
    print(f"  direct after MTI, worst of 12 classes {errors['direct_after_mti_db']:.1f} dB")
    return {"ms": ms, "ratios": ratios, "errors": errors}


def ready_for(scene: Scene, name: str) -> dict[str, Any]:
    """What a map's own transform starts from."""
    names = ["signal", "waveform", "canceller", "paths"]
    results = record(scene, [*names, *(["torso_track"] if "compensated" in name else [])]).products
    w, canceller, paths = results["waveform"], results["canceller"], results.pop("paths")
    shown = shown_pulses(w.n_pulses - canceller.lost, scene.config.image.size_px[1])
    return results | {"scene": scene, "beat": beat_at(paths, w, shown, canceller.taps)}


def maps(rounds: int) -> dict[str, Any]:
    """What each further map adds, over its own transform, image and write."""
    base = load_config(PAPER)
    results = {}
    print(
        "\na further map: what it adds to a build with `stft`, over its own transform, image, write"
    )
    with tempfile.TemporaryDirectory() as place:
        for name in (name for name in MAP_NAMES if name != "stft"):
            both = load_config(PAPER, [f"maps=[stft, {name}]"])
            alone = load_config(PAPER, [f"maps=[{name}]"])
            ready = [ready_for(scene(both, i), name) for i in range(12)]
            image, sink = Floor(alone, name), Sink(alone, Path(place))

            def whole(config: Config) -> Callable[[int], None]:
                p, sink = plan_images(config), Sink(config, Path(place))
                return lambda turn: sink.write(
                    [synthesise(scene(config, i), p, config) for i in range(12)]
                )

            def own(turn: int, ready=ready, image=image, sink=sink) -> None:
                sink.write([image.sample(there) for there in ready])

            times = interleaved({"both": whole(both), "base": whole(base), "own": own}, rounds)
            added = median(b - a for a, b in zip(times["base"], times["both"], strict=True)) / 12
            floor = median(times["own"]) / 12
            results[name] = {"added_ms": added * 1e3, "own_ms": floor * 1e3, "ratio": added / floor}
            print(
                f"  {name:<28}{added * 1e3:8.2f} ms over {floor * 1e3:6.2f} ms"
                f" = {added / floor:.2f}"
            )
    return results


def radhar(*arguments: str | Path) -> float:
    command = [sys.executable, "-m", "radhar_cli", *map(str, arguments)]
    return timed(lambda: subprocess.run(command, check=True, capture_output=True, cwd=ROOT))


def jobs(rounds: int) -> dict[str, Any]:
    """Two jobs against one, with warm workers and as a cold command."""
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.build import build

    config = load_config(PAPER, ["samples_per_class=40"])
    with tempfile.TemporaryDirectory() as place:

        def warm(count: int, turn: int) -> None:
            build(config, Path(place) / f"warm{count}", count, BarProgress(), overwrite=True)

        warm(2, 0)  # starts the workers, which have then imported what they need

        def cold(count: int, turn: int) -> None:
            radhar(
                "generate",
                PAPER,
                "-o",
                Path(place) / f"cold{count}",
                "--jobs",
                str(count),
                "--overwrite",
                "--set",
                "samples_per_class=40",
            )

        times = interleaved(
            {
                "warm 1": lambda t: warm(1, t),
                "warm 2": lambda t: warm(2, t),
                "cold 1": lambda t: cold(1, t),
                "cold 2": lambda t: cold(2, t),
            },
            min(rounds, 3),
            time.perf_counter,
        )
    seconds = {name: median(results) for name, results in times.items()}
    print("\n480 samples, seconds")
    for name, value in seconds.items():
        print(f"  {name:<10}{value:8.2f}")
    result = {
        "warm": seconds["warm 1"] / seconds["warm 2"],
        "cold": seconds["cold 1"] / seconds["cold 2"],
    }
    print(f"  two jobs are {result['warm']:.2f} times one, workers warm; {result['cold']:.2f} cold")
    return {"seconds": seconds, "speedup": result}


_PEAK = """
import resource, sys
from pathlib import Path
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
import radhar_cli.dataset.files as files, time
slow = float(sys.argv[4])
if slow:
    whole = files.write_whole
    import radhar_cli.dataset.batch as batch, radhar_cli.dataset.shards as shards
    def write_slowly(*a):
        time.sleep(slow); whole(*a)
    batch.write_whole = shards.write_whole = write_slowly
config = load_config(sys.argv[1], ["samples_per_class=" + sys.argv[3]])
build(config, Path(sys.argv[2]), 1, BarProgress())
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def memory(rounds: int) -> dict[str, Any]:
    """Peak resident memory of one worker's work, for few and many samples, with a slow disk too."""
    results = {}
    print("\npeak memory of one process that does everything, MiB")
    for label, per_class, slow in (
        ("12 samples", 1, 0.0),
        ("120 samples", 10, 0.0),
        ("960 samples", 80, 0.0),
        ("120 samples, a disk that takes 50 ms a file", 10, 0.05),
    ):
        with tempfile.TemporaryDirectory() as place:
            command = [sys.executable, "-c", _PEAK, PAPER, f"{place}/o", str(per_class), str(slow)]
            done = subprocess.run(
                list(map(str, command)), capture_output=True, text=True, check=True, cwd=ROOT
            )
        results[label] = int(done.stdout.split()[-1])
        print(f"  {label:<50}{results[label]:6d}")
    return results


_SCATTERERS = """
import json, sys
from time import thread_time
import numpy as np
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.paths import Paths
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.processes.worker_process import prepare_process

class Walker:
    # Points on four swinging limbs of two links each and on a trunk, seen from the origin.
    kinks = breakpoints = ()
    highest_frequency, smooth = 1.0, True

    def __init__(self, points):
        self.limb = np.arange(points) % 5
        self.down = (np.arange(points) // 5 + 1) / (points // 5 + 1)

    def __call__(self, t):
        phase = 2 * np.pi * t + np.array([0, np.pi, np.pi, 0, 0])[:, None]
        upper, lower = 0.5 * np.sin(phase), 0.5 * np.sin(phase) - 0.4 * (1 + np.cos(phase))
        upper[4] = lower[4] = 0.02
        us, uc, ls, lc = (f(v)[self.limb] for v in (upper, lower) for f in (np.sin, np.cos))
        first, second = np.minimum(self.down, 0.5)[:, None], np.maximum(self.down - 0.5, 0)[:, None]
        x = 2 + t + 0.9 * (first * us + second * ls)
        z = -0.3 - 0.9 * (first * uc + second * lc)
        y = np.array([-0.1, 0.1, -0.2, 0.2, 0])[self.limb][:, None]
        r = np.sqrt(x * x + y * y + z * z)
        a = 1e-3 / (r * r)
        power = (np.einsum("im,im->m", a, a),) if "power" in Paths._fields else ()
        return Paths(2 * r / 299_792_458.0, a, *power)

prepare_process()
waveform = Waveform(77e9, 4e9, 40e-6, 10e6, 5000.0, 4.0)
found = {}
for points in (13, 52, 208):
    times = []
    for _ in range(10):
        start = thread_time()
        DirectEcho(Walker(points), waveform, -80.0).slow_time()
        times.append(thread_time() - start)
    found[points] = 1e3 * min(times)
print(json.dumps(found))
"""


def scatterers(rounds: int, against: Path | None = None) -> dict[str, Any]:
    """Processor time of the direct echo of 20,000 pulses by scatterers: a line a + b n."""
    trees = {"this": ROOT} | ({"against": against.resolve()} if against else {})
    times: dict[str, list[list[float]]] = {name: [] for name in trees}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    for _ in range(rounds):
        for name, tree in trees.items():
            done = subprocess.run(
                [sys.executable, "-c", program(tree, "_SCATTERERS")],
                env=os.environ | one_thread | {"PYTHONPATH": str(tree)},
                cwd=tree,
                capture_output=True,
                text=True,
                check=True,
            )
            times[name].append(list(json.loads(done.stdout).values()))
    print("\ndirect echo of 13, 52, 208 scatterers, ms of processor time a sample")
    results: dict[str, Any] = {}
    for name, of_rounds in times.items():
        ms = np.median(of_rounds, axis=0)
        slope, start = np.polyfit([13, 52, 208], ms, 1)
        results[name] = {"ms": ms.tolist(), "start_ms": start, "scatterer_ms": slope}
        each = "".join(f"{value:9.2f}" for value in ms)
        print(f"  {name:<10}{each}   = {start:.2f} + {slope:.4f} n")
    if against:
        results["ratio"] = results["this"]["scatterer_ms"] / results["against"]["scatterer_ms"]
        print(f"  a further scatterer costs {results['ratio']:.2f} of what it does in {against}")
    return results


_PEOPLE = """
import json, sys
from collections import Counter
from time import process_time
from radhar_cli.config import load_config
from radhar_cli.dataset.layout import Rows
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.products.run import run
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.processes.worker_process import prepare_process

prepare_process()
config = load_config(sys.argv[1], sys.argv[3:])
rows, plan, stages, count = Rows.of(config), plan_images(config), Counter(), int(sys.argv[2])

def sample(row):
    start = process_time()
    scene, _ = draw_valid_scene(config, *rows[row])
    seconds = {"draw, check": process_time() - start}
    return seconds | run(plan, {"scene": scene}).seconds

each = [len(rows) * number // count for number in range(count)]
for row in each[::2]:  # each class: what is imported then is no part of a sample
    sample(row)
start = process_time()
for row in each:
    stages.update(sample(row))
total = 1e3 * (process_time() - start) / count
print(json.dumps({"total": total} | {k: 1e3 * v / count for k, v in stages.items()}))
"""
PEOPLE = {  # of which people: config, settings beside it
    "paper, free space": ("paper/free_space", ()),
    "quickstart": ("quickstart", ()),
    "77 GHz, points": ("human/free_space_77GHz", ("body.scatterers=points",)),
    "77 GHz, segments": ("human/free_space_77GHz", ()),
    "Glasgow, gate of 21 bins": ("measured/glasgow_5p8GHz", ()),
    "MMRGait, gate, segments": ("measured/mmrgait_77GHz", ()),
    "IWR1443, 60 frames": ("boards/iwr1443", ()),
}
PEOPLE_SAMPLES = 24


def people(rounds: int, against: Path | None = None) -> dict[str, Any]:
    """Processor time of a sample without its files, by stage; one process, one thread."""
    trees = {"this": ROOT} | ({"against": against.resolve()} if against else {})
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    print("\nscenes to images, ms of processor time a sample, and the largest stages")
    results: dict[str, Any] = {}
    for label, (config, more) in PEOPLE.items():
        # Older trees have no boards.
        having = {
            n: tree for n, tree in trees.items() if (tree / f"configs/{config}.yaml").exists()
        }
        found: dict[str, list[dict[str, float]]] = {name: [] for name in having}
        for _ in range(rounds):
            for name, tree in having.items():
                done = subprocess.run(
                    [
                        *(sys.executable, "-c", program(tree, "_PEOPLE")),
                        *(f"configs/{config}.yaml", str(PEOPLE_SAMPLES), *more),
                    ],
                    env=os.environ | one_thread | {"PYTHONPATH": str(tree)},
                    cwd=tree,
                    capture_output=True,
                    text=True,
                    check=True,
                )
                found[name].append(json.loads(done.stdout))
        for name, of_rounds in found.items():
            stages = {stage: median(one[stage] for one in of_rounds) for stage in of_rounds[0]}
            results.setdefault(label, {})[name] = stages
            most = sorted(stages, key=stages.__getitem__, reverse=True)[1:6]
            line = ", ".join(f"{stage} {stages[stage]:.1f}" for stage in most)
            print(f"  {label:<26}{name:>8}{stages['total']:8.1f}   {line}", flush=True)
        if "against" in having:
            pairs = zip(found["against"], found["this"], strict=True)
            each = [old["total"] / new["total"] for old, new in pairs]
            least = {n: min(one["total"] for one in of_rounds) for n, of_rounds in found.items()}
            results[label] |= {
                "ratio": median(each),
                "ratio_of_minima": least["against"] / least["this"],
            }
            print(
                f"  {'':<34}{median(each):8.2f} times ({', '.join(f'{r:.2f}' for r in each)}), "
                f"{least['against'] / least['this']:.2f} of the least"
            )
    return results


BUILDS = {  # what is built: config, settings beside it
    "free space": ("free_space", ()),
    "free space, double": ("free_space", ("engine.precision=double",)),
    "through the wall": ("through_wall", ()),
    "free space, nine maps": ("free_space", (f"maps=[{','.join(MAP_NAMES)}]",)),
}
FEW, MANY = 1, 17  # samples a class


def builds(rounds: int, against: Path | None = None) -> dict[str, Any]:
    """Processor time of a further sample of `radhar generate --jobs 1`, the start not counted."""
    trees = {"this": ROOT} | ({"against": against.resolve()} if against else {})
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    print("\nwhole builds, one job, ms of processor time a further sample")
    results: dict[str, Any] = {}
    for label, (config, more) in BUILDS.items():
        times: dict[str, list[float]] = {name: [] for name in trees}
        for _ in range(rounds):
            for name, tree in trees.items():
                few, many = (
                    _generate_seconds(
                        tree, config, (*more, f"samples_per_class={count}"), one_thread
                    )
                    for count in (FEW, MANY)
                )
                times[name].append(1e3 * (many - few) / (12 * (MANY - FEW)))
        results[label] = {name: median(ms) for name, ms in times.items()}
        line = "".join(f"{name:>9} {ms:6.1f}" for name, ms in results[label].items())
        if against:
            results[label]["ratio"] = results[label]["against"] / results[label]["this"]
            each = (old / new for old, new in zip(times["against"], times["this"], strict=True))
            line += (
                f"   {results[label]['ratio']:.2f} times ("
                + ", ".join(f"{r:.2f}" for r in each)
                + ")"
            )
        print(f"  {label:<24}{line}", flush=True)
    return results


def _generate_seconds(
    tree: Path, config: str, settings: tuple[str, ...], environment: dict[str, str]
) -> float:
    """User and system time of `radhar generate` in a tree."""
    path = tree / "configs/paper" / f"{config}.yaml"
    command = [sys.executable, "-m", "radhar_cli", "generate", str(path), "--jobs", "1"]
    command += [word for setting in settings for word in ("--set", setting)]
    before = os.times()
    with tempfile.TemporaryDirectory() as place:
        subprocess.run(
            [*command, "-o", f"{place}/o"],
            env=os.environ | environment | {"PYTHONPATH": str(tree)},
            cwd=tree,
            capture_output=True,
            check=True,
        )
    after = os.times()
    children = after.children_user - before.children_user
    return children + after.children_system - before.children_system


LENGTHS = (60, 120, 240, 480)  # s
_LENGTHS = """
import json, sys, time
from radhar_cli.config import load_config
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene
def once(seconds):
    overrides = ["snr_db=null", "motion.walking.lane_m=4", f"duration_s={seconds}"]
    config = load_config(sys.argv[1], overrides)
    walking = next(one for one in config.chosen_activities if one.slug == "walking")
    scene = draw_scene(config, walking, 0)
    start = time.process_time()
    record(scene, ["signal"])
    return time.process_time() - start
once(20)
print(json.dumps([once(int(seconds)) for seconds in sys.argv[2:]]))
"""


def lengths(rounds: int, against: Path | None = None) -> dict[str, Any]:
    """Processor time of the echo of a walk to and fro, of one minute to eight."""
    trees = {"this": ROOT} | ({"against": against.resolve()} if against else {})
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    words = ["configs/quickstart.yaml", *map(str, LENGTHS)]
    found: dict[str, list[list[float]]] = {name: [] for name in trees}
    for _ in range(rounds):
        for name, tree in trees.items():
            environment = os.environ | one_thread | {"PYTHONPATH": str(tree)}
            done = subprocess.run(
                [sys.executable, "-c", program(tree, "_LENGTHS"), *words],
                env=environment,
                cwd=tree,
                capture_output=True,
                text=True,
                check=True,
            )
            found[name].append(json.loads(done.stdout))
    print(f"\nechoes of walks of {', '.join(map(str, LENGTHS))} s, seconds of processor time")
    results = {}
    for name, times in found.items():
        results[name] = [median(of_length) for of_length in zip(*times, strict=True)]
        line = ", ".join(f"{seconds:.2f}" for seconds in results[name])
        ratio = results[name][-1] / results[name][0]
        print(f"  {name:<9}{line}; the last is {ratio:.1f} times the first")
    return results


ESTIMATED = {  # what is estimated and built: config, settings beside it
    "quickstart": ("quickstart", ("samples_per_class=30",)),
    "77 GHz, segments": ("human/free_space_77GHz", ("samples_per_class=30",)),
    "paper, free space": ("paper/free_space", ("samples_per_class=50",)),
    "Glasgow, gate": ("measured/glasgow_5p8GHz", ("samples_per_class=30",)),
    "IWR1443": ("boards/iwr1443", ("samples_per_class=2",)),
    "streams": ("human/streams", ("stream.count=8", "split.subjects=8")),
}


def run_timed(*arguments: str | Path) -> tuple[float, float, str]:
    """Run a command of radhar; return its wall and processor time (s) and its output."""
    command = [sys.executable, "-m", "radhar_cli", *map(str, arguments)]
    before, start = os.times(), time.perf_counter()
    done = subprocess.run(command, check=True, capture_output=True, cwd=ROOT, text=True)
    after, wall = os.times(), time.perf_counter() - start
    children = after.children_user - before.children_user
    return wall, children + after.children_system - before.children_system, done.stdout


def estimates(rounds: int) -> dict[str, Any]:
    """Time that `generate --dry-run` says, over that of the build which follows it."""
    print("\nestimated and real seconds of builds with as many jobs as pay, and load before them")
    results: dict[str, list[dict[str, Any]]] = {}
    for label, (config, more) in ESTIMATED.items():
        for _ in range(min(rounds, 2)):
            load = os.getloadavg()[0]
            with tempfile.TemporaryDirectory() as place:
                command = ["generate", f"configs/{config}.yaml", "-o", f"{place}/o", "--json"]
                command += [word for setting in more for word in ("--set", setting)]
                dry_wall, _, said = run_timed(*command, "--dry-run")
                wall, processor, _ = run_timed(*command)
            estimate = json.loads(said)
            if estimate["seconds"] is None:
                print(f"  {label:<20}load {load:4.1f}: no sample in {dry_wall:.0f} s", flush=True)
                continue
            row = {
                "load": load,
                "samples": estimate["samples"],
                "jobs": estimate["jobs"],
                "probes": estimate["probes"],
                "dry_run": dry_wall,
                "core_share": estimate["core_share"],
                "wall": wall,
                "wall_ratio": estimate["seconds"] / wall,
                "within_range": estimate["seconds_range"][0]
                <= wall
                <= estimate["seconds_range"][1],
                "processor": processor,
                "processor_ratio": estimate["processor_seconds"] / processor,
            }
            results.setdefault(label, []).append(row)
            print(
                f"  {label:<20}{row['samples']:6d} samples, load {load:4.1f}, share of a core "
                f"{row['core_share']:.2f}: processor {processor:6.1f} s, estimate "
                f"{row['processor_ratio']:.2f} of it; wall {wall:6.1f} s, {row['wall_ratio']:.2f}; "
                f"dry run {dry_wall:.1f} s, {row['probes']} samples",
                flush=True,
            )
    return results


_KINDS = """
import json, sys
import numpy as np
from radhar_cli.config import load_config
from radhar_cli.dataset.build import choose_batch_size
from radhar_cli.dataset.estimate import FILE_S, encode_samples
from radhar_cli.dataset.layout import Rows, row_bytes
from radhar_cli.dataset.trial import make_trial_sample
config, rounds, count = load_config(sys.argv[1], sys.argv[4:]), int(sys.argv[2]), int(sys.argv[3])
label = sys.argv[1]
rows = Rows.of(config).spread_progressively(count)
make_trial_sample(config, label, rows[0])
made = [[make_trial_sample(config, label, row) for row in rows] for _ in range(rounds)]
least = [min(of_row, key=lambda sample: sample.processor) for of_row in zip(*made)]
written = encode_samples(config, [sample.row for sample in least])
batch = choose_batch_size(1000, 2, row_bytes(config))
write = written.sample_seconds + written.shard_seconds / batch
write += FILE_S * len(config.maps) * config.output.png
stages = {name: np.mean([sample.stages[name] for sample in least]) for name in least[0].stages}
stages["write"] += write
print(json.dumps({name: 1e3 * seconds for name, seconds in stages.items()}))
"""
KINDS = {  # of samples: config, settings beside it, number of samples that are timed
    "paper, free space": ("paper/free_space", (), 24),
    "paper, through the wall": ("paper/through_wall", (), 24),
    "quickstart: 24 GHz, 13 points, two maps": ("quickstart", (), 24),
    "people at 77 GHz, 13 points": ("human/free_space_77GHz", ("body.scatterers=points",), 24),
    "people at 77 GHz, segments": ("human/free_space_77GHz", (), 24),
    "people through a wall, 2 GHz": ("human/through_wall_2GHz", (), 24),
    "three people in a room": ("human/people", (), 8),
    "Glasgow: gate of 21 range bins": ("measured/glasgow_5p8GHz", (), 24),
    "board IWR1443, clouds alone": ("boards/iwr1443", ("maps=[points]",), 6),
    "board IWR1443, all maps and clouds": ("boards/iwr1443", (), 6),
    "stream of a minute, 24 GHz": ("human/streams", (), 6),
}
THOUSAND, CORES = 1000, 2


def kinds(rounds: int) -> dict[str, Any]:
    """What a thousand samples of each kind cost, files included: processor time, two cores."""
    print("\na thousand samples: ms of processor time a sample (the least of rounds), minutes on 2")
    print("cores, and the largest stages in percent")
    results: dict[str, Any] = {}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    for label, (config, more, count) in KINDS.items():
        words = [f"configs/{config}.yaml", str(rounds), str(count), *more]
        done = subprocess.run(
            [sys.executable, "-c", _KINDS, *words],
            env=os.environ | one_thread,
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        stages = json.loads(done.stdout)
        total = sum(stages.values())
        minutes = THOUSAND * total / 1e3 / CORES / 60
        results[label] = {"ms": total, "minutes": minutes, "stages": stages}
        largest = sorted(stages, key=stages.__getitem__, reverse=True)[:4]
        line = ", ".join(f"{name} {100 * stages[name] / total:.0f}" for name in largest)
        print(f"  {label:<42}{total:9.1f} ms{minutes:8.2f} min   {line}", flush=True)
    return results


SECTIONS = {
    "kinds": kinds,
    "lengths": lengths,
    "estimates": estimates,
    "rows": rows,
    "builds": builds,
    "people": people,
    "scatterers": scatterers,
    "maps": maps,
    "jobs": jobs,
    "memory": memory,
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path, default=Path("build/bench_generate.json"))
    parser.add_argument("--only", default=",".join(SECTIONS), help="sections, comma separated")
    parser.add_argument(
        "--against",
        type=Path,
        help="another tree of radhar, for lengths, builds, people and scatterers",
    )
    arguments = parser.parse_args()
    prepare_process()
    more = {
        name: {"against": arguments.against}
        for name in ("lengths", "builds", "people", "scatterers")
    }
    results = {
        name: SECTIONS[name](arguments.rounds, **more.get(name, {}))
        for name in arguments.only.split(",")
    }
    arguments.json.parent.mkdir(parents=True, exist_ok=True)
    arguments.json.write_text(json.dumps(results, indent=2))
    print(f"\n{arguments.json}")


if __name__ == "__main__":
    main()
