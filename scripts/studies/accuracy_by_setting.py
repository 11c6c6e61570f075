"""What settings of a config cost a network that learns from its images: a table of accuracies.

    python scripts/studies/accuracy_by_setting.py -o OUT [--config configs/quickstart.yaml]
        [--seeds 5] [--learned 50] [--tested 25] [--epochs 20] [--only X]

A network a setting and seed learns from images of the setting and is tested on images of the config
as it is and of the setting, of other scenes (radhar_cli/tradeoff/accuracy.py). Rows "signal with an
error of -X dB" add white noise to the slow-time signal, at that level below its power, which stands
for an engine that is as wrong as that. Seeds come one after the other, each with all settings; what
is in OUT is kept, so that the same line goes on where it was stopped. After every network OUT has
results.json and table.md of what is done.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from shared import ROOT, commit, table

from radhar_cli.assembly.receiver import noise_stream
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.processing.look import Look
from radhar_cli.products.plan import Product
from radhar_cli.products.receiver import make_receiver
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.noise import WhiteNoise, circular_gaussian
from radhar_cli.scene import Scene
from radhar_cli.tradeoff.accuracy import AccuracyStudy, SeedAccuracy, Sizes, setting_accuracy
from radhar_cli.tradeoff.intervals import Interval, mean_interval, paired_difference

DEFAULT = "the config as it is"


@dataclass(frozen=True)
class SignalError(Impairment):
    """White error of the slow-time signal, before the noise, at a level relative to its power."""

    db: float
    scene: Scene

    def apply(self, x: Complex, look: Look) -> Complex:
        """Add the error to x [K, M], of relative L2 norm 10^(db/20)."""
        error = circular_gaussian(noise_stream(self.scene, "error of the signal"), x.shape)
        return x + 10 ** (self.db / 20) * np.linalg.norm(x) / np.linalg.norm(error) * error


def make_wrong_receiver(
    scene: Scene, noise: WhiteNoise, waveform: Waveform, db: float
) -> tuple[Impairment, ...]:
    """Make a receiver that takes a wrong signal: its impairments after the error."""
    return (SignalError(db, scene), *make_receiver(scene, noise, waveform))


class Row(NamedTuple):
    """Setting of the study."""

    name: str
    overrides: tuple[str, ...] = ()
    error_db: float | None = None  # of the signal; None is that of the engine

    @property
    def products(self) -> tuple[Product, ...]:
        """Products that stand in place of the table's."""
        if self.error_db is None:
            return ()
        make = partial(make_wrong_receiver, db=self.error_db)
        return (Product("receiver", ("scene", "noise", "waveform"), make, "error, noise"),)


def signal_error(db: float) -> Row:
    """Row of a signal that is as wrong as that, dB."""
    return Row(f"signal with an error of {db:g} dB", (), db)


ROWS = (
    Row(DEFAULT),
    signal_error(-20),
    signal_error(-30),
    Row("FSST, compensated, instead of STFT", ("maps=[fsst_compensated]",)),
    Row("image of 32 px", ("image.size_px=32",)),
    Row("body of segments", ("body.scatterers=segments",)),
    Row("STFT overlap of 0.8", ("processing.overlap_fraction=0.8",)),
    Row("PRF halved", ("radar.prf_hz=1750",)),
    Row("no noise", ("snr_db=null",)),
    Row("motion of the paper", ("motion.model=paper",)),
    Row("SNR of 30 dB throughout", ("snr_db=30",)),
    signal_error(-40),
    Row("tolerance of -40 dB", ("engine.tolerance_db=-40",)),
    Row("tolerance of -120 dB", ("engine.tolerance_db=-120",)),
    Row("segments without shadows", ("body.scatterers=segments", "body.shadowing=false")),
    signal_error(-50),
    Row("image of 128 px", ("image.size_px=128",)),
)
Results = dict[str, list[SeedAccuracy]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--config", type=Path, default=ROOT / "configs/quickstart.yaml")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--learned", type=int, default=50)
    parser.add_argument("--tested", type=int, default=25)
    parser.add_argument("--epochs", type=int, default=20)
    parser.add_argument("--only", default="", help="rows whose names have this, and the default")
    given = parser.parse_args()
    sizes = Sizes(given.learned, given.tested, given.epochs)
    rows = [row for row in ROWS if given.only in row.name or row.name == DEFAULT]
    given.out.mkdir(parents=True, exist_ok=True)
    prepare_process()
    results: Results = {row.name: [] for row in rows}
    with BarProgress("network") as progress:
        for number in range(1, given.seeds + 1):
            for row in rows:
                study = AccuracyStudy(given.config, (), given.out, progress, sizes, row.products)
                results[row.name].append(study.measure_seed(row.overrides, number))
                write_results(given.out, results)
    print((given.out / "table.md").read_text())


def write_results(out: Path, results: Results) -> None:
    """Write what is done: results.json, and table.md."""
    numbers = {name: [asdict(each) for each in some] for name, some in results.items()}
    document = {"commit": commit(), "settings": numbers}
    (out / "results.json").write_text(json.dumps(document, indent=2) + "\n")
    (out / "table.md").write_text("\n".join(lines_of(results)) + "\n")


def lines_of(results: Results) -> list[str]:
    """Lines of the table: accuracies in per cent, differences from the default in points."""
    default = setting_accuracy(results[DEFAULT]).by_seed
    lines = []
    for name, some in results.items():
        if not some:
            continue
        accuracy = setting_accuracy(some)
        difference = paired_difference(accuracy.by_seed, default)
        on_default = mean_and_range(accuracy.by_seed) if accuracy.tested_on == "default" else ""
        cells = [name, on_default, mean_and_range(accuracy.own_by_seed)]
        cells += ["" if name == DEFAULT else in_points(difference), str(len(some))]
        lines.append(cells)
    header = ["learned from", "on images of the config (%)", "on images like them (%)"]
    return table([*header, "difference (points, 95 %)", "seeds"], lines)


def mean_and_range(shares: Sequence[float]) -> str:
    """Mean and range of the seeds, per cent."""
    middle = mean_interval(shares).mean
    return f"{100 * middle:.1f} ({100 * min(shares):.1f} to {100 * max(shares):.1f})"


def in_points(difference: Interval) -> str:
    """Difference with its interval, in points of a per cent."""
    middle, low, high = (f"{100 * value:+.1f}" for value in difference)
    return f"{middle} ({low} to {high})".replace(" (+nan to +nan)", "")


if __name__ == "__main__":
    main()
