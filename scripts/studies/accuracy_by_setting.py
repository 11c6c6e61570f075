"""What settings of a config cost a network that learns from its images: a table of accuracies.

    python scripts/studies/accuracy_by_setting.py -o OUT [--config configs/quickstart.yaml]
        [--seeds 1 2 3 4 5] [--learned 50] [--tested 25] [--epochs 20] [--only X] [--table]

A network a setting and seed learns from images of the setting and is tested on images of the config
as it is and of the setting, of other scenes (study/tradeoff/accuracy.py). Rows "signal with an
error of -X dB" add white noise to the signal after the canceller, at that level below its power,
which stands for an engine that is as wrong as that. Seeds come one after the other, each with all
settings; what is in OUT is kept, so that the same line goes on where it was stopped, and several
processes may share OUT, each with seeds of its own. The table at the end is of what OUT has, with
--table of that alone.
"""

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from shared import ROOT, commit, table

from radhar_cli.assembly.receiver import noise_stream
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.processing.canceller import Canceller
from radhar_cli.processing.signal import Signal
from radhar_cli.products.direct import MeasuredEcho, receive_measured_echo
from radhar_cli.products.plan import Product
from radhar_cli.products.signal import receive_echo
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.noise import circular_gaussian
from radhar_cli.scene import Scene
from radhar_cli.study.tradeoff.accuracy import AccuracyStudy, SeedAccuracy, Sizes, setting_accuracy
from radhar_cli.study.tradeoff.intervals import Interval, mean_interval, paired_difference

DEFAULT = "the config as it is"


def receive_wrong_echo(
    scene: Scene,
    echo: MeasuredEcho,
    direct: DirectEcho,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    db: float,
) -> Signal:
    """Signal with a white error after the canceller, of relative L2 norm 10^(db/20).

    Args:
        scene: what is simulated, which names the random stream.
        echo: samples of the echo.
        direct: closed form of the echo.
        canceller: canceller of static echoes.
        receiver: impairments, which are not part of what the error is relative to.
        db: level of the error.
    """
    clean = receive_echo(echo.samples.copy(), direct.look, (), canceller).x
    signal = receive_measured_echo(echo, direct, canceller, receiver)
    error = circular_gaussian(noise_stream(scene, "error of the signal"), clean.shape)
    error *= 10 ** (db / 20) * np.linalg.norm(clean) / np.linalg.norm(error)
    return signal.with_samples(signal.x + error)


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
        make = partial(receive_wrong_echo, db=self.error_db)
        needs = ("scene", "echo", "direct", "canceller", "receiver")
        return (Product("signal", needs, make, "receiver, canceller, error"),)


def signal_error(db: float) -> Row:
    """Row of a signal that is as wrong as that, dB."""
    return Row(f"signal with an error of {db:g} dB", (), db)


ROWS = (
    Row(DEFAULT),
    signal_error(-20),
    signal_error(-30),
    Row("image of 32 px", ("image.size_px=32",)),
    Row("body of segments", ("body.scatterers=segments",)),
    Row("STFT overlap of 0.8", ("processing.overlap_fraction=0.8",)),
    Row("PRF halved", ("radar.prf_hz=1750",)),
    Row("motion of the paper", ("motion.model=paper",)),
    Row("FSST, compensated, instead of STFT", ("maps=[fsst_compensated]",)),
    Row("no noise", ("snr_db=null",)),
    Row("SNR of 30 dB throughout", ("snr_db=30",)),
    signal_error(-40),
    Row("tolerance of -40 dB", ("engine.tolerance_db=-40",)),
    Row("tolerance of -120 dB", ("engine.tolerance_db=-120",)),
    Row("segments without shadows", ("body.scatterers=segments", "body.shadowing=false")),
    signal_error(-50),
    Row("image of 128 px", ("image.size_px=128",)),
)
Results = dict[str, dict[int, SeedAccuracy]]  # {row: {seed: accuracies}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--config", type=Path, default=ROOT / "configs/quickstart.yaml")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    parser.add_argument("--learned", type=int, default=50)
    parser.add_argument("--tested", type=int, default=25)
    parser.add_argument("--epochs", type=int, default=20)
    parser.add_argument("--only", default="", help="rows whose names have this, and the default")
    parser.add_argument("--table", action="store_true", help="make no network")
    options = parser.parse_args()
    sizes = Sizes(options.learned, options.tested, options.epochs)
    rows = [row for row in ROWS if options.only in row.name or row.name == DEFAULT]
    prepare_process()
    results: Results = {row.name: {} for row in rows}
    with BarProgress("network") as progress:
        for number in options.seeds:
            for row in rows:
                study = AccuracyStudy(
                    options.config, (), options.out, progress, sizes, row.products
                )
                if not options.table:
                    study.measure_seed(row.overrides, number)
                recorded = study.read_record(row.overrides, number)
                if recorded is not None:
                    results[row.name][number] = recorded
    print(f"commit {commit()}", "", *lines_of(results), sep="\n")


def lines_of(results: Results) -> list[str]:
    """Lines of the table: accuracies in per cent, differences from the default in points."""
    default, lines = results[DEFAULT], []
    for name, by_seed in results.items():
        both = [number for number in by_seed if number in default]
        if not both:
            continue
        accuracy = setting_accuracy([by_seed[number] for number in both])
        alike = setting_accuracy([default[number] for number in both])
        difference = in_points(paired_difference(accuracy.by_seed, alike.by_seed))
        on_default = mean_and_range(accuracy.by_seed) if accuracy.tested_on == "default" else ""
        cells = [name, on_default, mean_and_range(accuracy.own_by_seed)]
        lines.append([*cells, "" if name == DEFAULT else difference, str(len(both))])
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
