"""What the defaults of place, heading and onset are worth to a network.

    python scripts/studies/effect_of_defaults.py -o OUT [--masks MASKS.npz] [--clouds FOLDER]
        [--half 1 | 2] [--seeds 5] [--per-class 100]

Each part makes the same data set twice, with the defaults until 0dece9a (`EARLIER`: walkers start
far away, who stays in place near, everybody faces the radar, nothing begins before or after its
cue) and with those of today, and trains networks on each.

- maps: the twelve classes of configs/quickstart.yaml, tested on other people of both kinds;
- masks: five classes as the radar of configs/measured/glasgow_5p8GHz.yaml sees them, without what
  that config says about people's places and timing, tested on measured masks (sim_to_real.py); and
  today's defaults with everybody facing the radar, as people in these masks do;
- clouds: the five classes of configs/measured/radhar_1443.yaml in the same way (radhar_classes.py).

--half tests on the first or the second half of what was measured. What OUT holds is kept, so the
same line goes on where it was stopped. The last lines are tables in Markdown.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import mean

import radhar_classes
import sim_to_real
from shared import ROOT, as_options, commit, report_of_radhar, run_radhar, table

from radhar_cli.dataset.reading import open_dataset

QUICKSTART = ROOT / "configs/quickstart.yaml"
EPOCHS = 12  # of the twelve classes, after which accuracy hardly rises
FACING = "{uniform: [150, 210]}"
STARTS = (  # where people started, by class
    "{per_activity: {default: {uniform: [9, 12]}, S1: {uniform: [2, 5]}, S2: {uniform: [2, 5]}, "
    "S3: {uniform: [2, 5]}, S4: {uniform: [2, 5]}, S5: {uniform: [2, 5]}, S6: {uniform: [2, 5]}, "
    "S7: {uniform: [2, 5]}, S9: {uniform: [5, 8]}, S10: {uniform: [5, 8]}, "
    "S11: {uniform: [5, 8]}, S12: {uniform: [5, 8]}}}"
)
CUES = (  # when things began
    "{seat_start_s: 0.5, grab_start_s: 0.5, rise_start_s: 0.5, walk_stop_s: 2.0, onset: 0.5, "
    "visible: 1.0}"
)
EARLIER = (f"motion={{range_m: {STARTS}, cross_range_m: 0, angle_deg: {FACING}}}", f"timing={CUES}")
TODAY = ("motion={}", "timing={}")
DEFAULTS: dict[str, tuple[str, ...]] = {"earlier": EARLIER, "today": TODAY}
# Half of today's people head away from the radar; in the measured masks nobody does.
FOR_MASKS = DEFAULTS | {"today_facing": (f"motion={{angle_deg: {FACING}}}", TODAY[1])}
# People are within the gate and before the wall, wherever either default has them.
ROOMY = ("processing.gate_m=[0.75, 15.0]", "room.back_wall_m=null")
# The board sees 11 m, and the study takes points up to 2.9 m: both defaults get that place, and
# lanes on which walkers stay there.
NEAR, LANE = "{uniform: [1.2, 2.3]}", "walking: {lane_m: {uniform: [0.8, 1.4]}}"
AT_THE_BOARD: dict[str, tuple[str, ...]] = {
    "earlier": (
        "on_invalid=redraw",
        f"motion={{range_m: {NEAR}, cross_range_m: 0, angle_deg: {FACING}, {LANE}}}",
        EARLIER[1],
    ),
    "today": ("on_invalid=redraw", f"motion={{place: {{range_m: {NEAR}}}, {LANE}}}", TODAY[1]),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder of all that is made")
    parser.add_argument("--masks", type=Path, help="measured masks, .npz (sim_to_real.py)")
    parser.add_argument("--clouds", type=Path, help="measured clouds (radhar_classes.py)")
    parser.add_argument("--half", type=int, choices=(1, 2), help="of what was measured")
    parser.add_argument("--seeds", type=int, default=5, help="of the networks")
    parser.add_argument("--per-class", type=int, default=100, help="samples of each class")
    parser.add_argument("--jobs", type=int, default=2, help="processes that generate")
    given = parser.parse_args()
    for path in (given.masks, given.clouds):
        if path is not None and not path.exists():
            sys.exit(f"effect_of_defaults: {path}: no such file or folder")
    out: Path = given.out.resolve()
    seeds = range(1, 1 + given.seeds)
    lines = test_on_each_other(out / "maps", given.per_class, seeds, given.jobs)
    if given.masks is not None:
        lines += test_on_masks(out / "masks", given, seeds)
    if given.clouds is not None:
        lines += test_on_clouds(out / "clouds", given, seeds)
    print(f"\nscripts/studies/effect_of_defaults.py, commit {commit()}\n")
    print("\n".join(lines))


def test_on_each_other(out: Path, per_class: int, seeds: range, jobs: int) -> list[str]:
    """Accuracy of networks on other people of both defaults: lines of a table."""
    for name, settings in DEFAULTS.items():
        for part, seed, count in (("train", 1, per_class), ("test", 2, max(per_class // 2, 8))):
            made = (*settings, f"seed={seed}", f"samples_per_class={count}", "maps=[stft]")
            make_data(QUICKSTART, out / part / name, made, jobs)
    rows = []
    for learned in DEFAULTS:
        runs = [
            train_once(out / "train" / learned, out / "runs" / f"{learned}_{seed}", seed)
            for seed in seeds
        ]
        shares = {
            tested: [accuracy_on(run, out / "test" / tested) for run in runs] for tested in DEFAULTS
        }
        rows.append([learned, *(mean_and_range(shares[tested]) for tested in DEFAULTS)])
    header = ["trained with", *(f"on people of {name} (%)" for name in DEFAULTS)]
    title = f"twelve classes of maps, {per_class} a class, {len(seeds)} seeds"
    return [title, "", *table(header, rows)]


def make_data(config: Path, folder: Path, settings: Sequence[str], jobs: int) -> Path:
    """Generate a data set once.

    Raises:
        SystemExit: `radhar generate` failed, or the folder holds a data set of other settings.
    """
    run_radhar("generate", config, "-o", folder, "--jobs", jobs, *as_options(settings))
    return folder


def train_once(data: Path, run: Path, seed: int) -> Path:
    """Train the usual network with a seed; a run that ended is kept."""
    if not (run / "best.safetensors").exists():
        run_radhar("train", data, "-o", run, *as_options((f"seed={seed}", f"epochs={EPOCHS}")))
    return run


def accuracy_on(run: Path, data: Path) -> float:
    """Accuracy of a run on all samples of a data set."""
    cached = run / f"on_{data.name}.json"
    if not cached.exists():
        folder = run / f"eval_{data.name}"
        told = report_of_radhar("eval", run, data, "--split", "all", "-o", folder, "--overwrite")
        cached.write_text(json.dumps(told))
    report = json.loads(cached.read_text())
    return float(report["accuracy"][run.name][data.name])


def test_on_masks(out: Path, given: argparse.Namespace, seeds: range) -> list[str]:
    """Accuracy on measured masks of networks that saw simulated ones: lines of a table."""
    runs = {
        name: [sim_to_real.trained(images, out / "runs" / f"{name}_{seed}", seed) for seed in seeds]
        for name, images in simulated_masks(out, given.per_class, given.jobs).items()
    }
    masks, slugs = sim_to_real.read_masks(given.masks)
    if given.half:
        rows = sim_to_real.half_of(slugs, given.half)
        masks, slugs = masks[rows], [slugs[row] for row in rows]
    measured = sim_to_real.Measured.written(masks, slugs, out / "measured")
    shares = {name: [measured.predicted(run).accuracy for run in runs[name]] for name in runs}
    return measured_lines("measured masks, five classes", shares, len(slugs), given.half)


def simulated_masks(out: Path, per_class: int, jobs: int) -> dict[str, Path]:
    """Trees of simulated images for a network, by the defaults they were made with."""
    trees = {}
    for name, settings in FOR_MASKS.items():
        tree = trees[name] = out / "images" / name
        if (tree / "done").exists():
            continue
        made = (
            *settings,
            *ROOMY,
            f"samples_per_class={per_class}",
            f"activities={list_of_slugs()}",
        )
        data_folder = make_data(sim_to_real.SIMULATED, out / "data" / name, made, jobs)
        with open_dataset(data_folder) as data:
            for row, label in enumerate(data.label):
                slug = sim_to_real.CLASSES[data.classes[label]]
                # A walk of 5 s has the time axis of the others, not that of measured walks.
                image = sim_to_real.network_image(data.maps["stft"][row] > 0, "")
                part = "val" if data.split[row] else "train"
                sim_to_real.write_image(image, tree / part / slug / f"{row:05d}.png")
        (tree / "done").touch()
    return trees


def list_of_slugs() -> str:
    """The classes of the measured masks by our names, in YAML."""
    return f"[{', '.join(sim_to_real.SLUGS)}]"


def test_on_clouds(out: Path, given: argparse.Namespace, seeds: range) -> list[str]:
    """Accuracy on windows of measured clouds: lines of a table."""
    models = {}
    for name, settings in AT_THE_BOARD.items():
        clouds, labels = radhar_classes.simulated(
            out / name, max(given.per_class // 3, 8), given.jobs, settings
        )
        models[name] = [radhar_classes.trained(clouds, labels, seed) for seed in seeds]
    rows, truth = radhar_classes.windows(*radhar_classes.measured(given.clouds), given.half)
    shares = {
        name: [float((model.predict(rows) == truth).mean()) for model in models[name]]
        for name in models
    }
    return measured_lines(
        "windows of measured clouds, five classes", shares, len(truth), given.half
    )


def measured_lines(
    what: str, shares: Mapping[str, Sequence[float]], count: int, half: int | None
) -> list[str]:
    """A table of accuracies on what was measured."""
    part = f"half {half}" if half else "all"
    rows = [[name, mean_and_range(some)] for name, some in shares.items()]
    return ["", f"{what}, {part}, n = {count}", "", *table(["trained with", "accuracy (%)"], rows)]


def mean_and_range(shares: Sequence[float]) -> str:
    """Mean and range of the seeds, per cent."""
    return f"{100 * mean(shares):.1f} ({100 * min(shares):.1f} to {100 * max(shares):.1f})"


if __name__ == "__main__":
    main()
