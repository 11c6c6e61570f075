"""Make the trained networks of a release: weights and a model card for each.

    python scripts/studies/make_networks.py -o OUT [--only NAME ...] [--masks MASKS.npz]

OUT gets NAME.safetensors and NAME.md for each of quickstart, glasgow and board, whose data sets and
runs stay in OUT/work; the same line goes on where it was stopped. Each network is tested on samples
of another seed, which it has not seen; with --masks (sim_to_real.py) the glasgow one on
measured maps, too. `radhar predict OUT/NAME.safetensors DATA` uses one.
"""

import argparse
import hashlib
import json
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import sim_to_real
from shared import ROOT, as_options, commit, report_of_radhar, run_radhar, wilson_of_share

LARGEST = 2e6  # bytes of weights
TEST_SEED = 1001


@dataclass(frozen=True)
class Network:
    """A network of the release.

    Attributes:
        config: of the data that it is trained on.
        per_class: samples of each class.
        options: of `radhar train`.
        reads: its input.
        not_for: what it is not good for.
    """

    config: Path
    per_class: int
    options: tuple[str, ...]
    reads: str
    not_for: str


NETWORKS = {
    "quickstart": Network(
        ROOT / "configs/quickstart.yaml",
        20,
        (),
        "Doppler-time maps (`stft`, 128 x 128 px, coloured) of one person in free space at 24 GHz",
        "It was never tested on measured maps, and not trained on maps of another radar, another "
        "range of Doppler frequencies, dynamic range or colour map.",
    ),
    "glasgow": Network(
        sim_to_real.SIMULATED,
        300,
        ("--config", str(sim_to_real.TRAINING)),
        "outlines of Doppler-time masks at 5.8 GHz (32 x 32 px, grey), as `network_image` of "
        "scripts/studies/sim_to_real.py makes them",
        "The simulation was tuned on part of the measured maps of docs/results/transfer.md, so "
        "accuracy on them is optimistic. It was not trained for other radars, other activities, "
        "several people, or the maps themselves instead of their outlines.",
    ),
    "board": Network(
        ROOT / "configs/boards/iwr1443.yaml",
        60,
        ("--model", "cloudnet"),
        "point clouds of one person in front of an IWR1443BOOST, 3 s, 64 points a frame",
        "Clouds of a real board: a network of this kind, trained on simulated clouds, did no "
        "better than chance on five exercises of RadHAR (docs/results/transfer.md).",
    ),
}


def data_of(name: str, folder: Path, per_class: int, seed: int) -> Path:
    """A data set for a network, in `folder`."""
    if name == "glasgow":
        return sim_to_real.simulated(folder, per_class, 2, (f"seed={seed}",))
    sets = (f"samples_per_class={per_class}", f"seed={seed}")
    run_radhar("generate", NETWORKS[name].config, "-o", folder, "--jobs", 2, *as_options(sets))
    return folder


def accuracy(run: Path, data: Path, out: Path) -> tuple[float, int]:
    """Share of the samples of a data set whose class is found, and their number."""
    metrics = report_of_radhar("eval", run, data, "--split", "all", "-o", out)["accuracy"]
    (of_data,) = metrics.values()
    (found,) = of_data.values()
    predictions = (out / "predictions.csv").read_text().splitlines()
    return found, len(predictions) - 1


def card(
    name: str, weights: Path, run: Path, rows: Sequence[tuple[str, float, int]], options: str
) -> str:
    """The text of NAME.md."""
    network, about = NETWORKS[name], json.loads((run / "metrics.json").read_text())
    table = []
    for data, share, count in rows:
        low, high = wilson_of_share(share, count)
        table.append(f"| {data} | {share:.1%} | {low:.1%} to {high:.1%} | {count} |")
    return f"""# {name}: a trained network of radhar

Reads {network.reads}; gives the probabilities of {", ".join(about["classes"])}.

    radhar predict {name}.safetensors DATA

| | |
| --- | --- |
| network | {about["model"]}, {about["parameters"]:,} parameters, {weights.stat().st_size:,} bytes |
| trained on | {about["data"]["train"]} simulated samples of {network.config.relative_to(ROOT)}; \
best of {about["epochs"]} epochs on {about["data"]["val"]} others |
| made by | `python scripts/studies/make_networks.py -o OUT --only {name}{options}`, \
commit {commit()} |
| SHA-256 | {hashlib.sha256(weights.read_bytes()).hexdigest()} |
| licence | MIT, as radhar |

| tested on | accuracy | 95 % interval | n |
| --- | ---: | ---: | ---: |
{chr(10).join(table)}

## What it is not good for

{network.not_for}
"""


def make(
    name: str, out: Path, *, per_class: int | None, epochs: int | None, masks: Path | None
) -> None:
    """Write OUT/NAME.safetensors and OUT/NAME.md."""
    network, work = NETWORKS[name], out / "work" / name
    count = per_class or network.per_class
    data = data_of(name, work / "data", count, 1)
    unseen = data_of(name, work / "unseen", max(min(8, count), count // 3), TEST_SEED)
    more = as_options(() if epochs is None else (f"epochs={epochs}",))
    options = f" --per-class {per_class}" * bool(per_class) + f" --epochs {epochs}" * bool(epochs)
    run_radhar("train", data, "-o", work / "run", *network.options, *more)
    rows = [("simulated, another seed", *accuracy(work / "run", unseen, work / "eval"))]
    if name == "glasgow" and masks is not None:
        measured = sim_to_real.Measured.written(*sim_to_real.read_masks(masks), work / "measured")
        rows += [
            ("measured masks", *accuracy(work / "run", measured.folder, work / "measured_eval"))
        ]
    weights = out / f"{name}.safetensors"
    shutil.copyfile(work / "run" / "best.safetensors", weights)
    if weights.stat().st_size > LARGEST:
        sys.exit(f"make_networks: {weights}: has more than {LARGEST:g} bytes")
    (out / f"{name}.md").write_text(card(name, weights, work / "run", rows, options))
    print(f"{weights}: " + ", ".join(f"{what} {100 * share:.1f} %" for what, share, _ in rows))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--only", nargs="+", choices=[*NETWORKS], default=[*NETWORKS])
    parser.add_argument("--masks", type=Path, help="measured masks, for the glasgow network")
    parser.add_argument("--per-class", type=int, help="samples of each class, for a trial")
    parser.add_argument("--epochs", type=int, help="for a trial")
    given = parser.parse_args()
    out = given.out.resolve()
    for name in given.only:
        make(name, out, per_class=given.per_class, epochs=given.epochs, masks=given.masks)


if __name__ == "__main__":
    main()
