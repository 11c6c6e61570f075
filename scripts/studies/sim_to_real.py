"""Train on simulated maps alone, and test on measured ones.

    python scripts/studies/sim_to_real.py MASKS.npz -o OUT [--quick | --seeds K]
        [--half 1 | 2] [--pieces]

MASKS.npz: `masks` [K, H, W/8], uint8, bits of H x W Doppler-time masks, row 0 the highest Doppler;
`label` [K] into `classes`. Rows reach over +-500 Hz, columns over 5 s, of walking over 10 s.
Such masks were made by github.com/Hong-01/EE4675-Human-Activity-Classification-using-Radar of
"Radar signatures of human activities" (University of Glasgow, CC BY 4.0).

Simulated people come from configs/measured/glasgow_5p8GHz.yaml, settings of the training from
configs/train/measured.yaml. The network is on disk, and its digest printed, before MASKS.npz is
opened; with group norm it is tested as it is, with batch norm after `radhar adapt` has seen the
maps without their labels. Five seeds, or K, or with --quick one. --half takes the first or the
second half of the maps of each class, so that what is chosen by looking at one is reported on the
other. --pieces adds what each piece of the simulation brings, and accuracy with a few labelled maps
of each class. Every step is a `radhar` command; the same line goes on where it was stopped.
"""

import argparse
import hashlib
import json
import re
import shutil
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from PIL import Image
from scipy import ndimage
from shared import ROOT, as_options, run_radhar, wilson_of_share

from radhar_cli.capture.images import list_images, read_image
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import CaptureError
from radhar_cli.figures.two_samples import Picture, pictures_png
from radhar_cli.learning.evaluation import open_for_model, predict_classes
from radhar_cli.learning.few_shots import ShotOptions, measure_few_shots
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.run_folder import load_best
from radhar_cli.numerics.arrays import Bool, Float, Index, Levels

SIMULATED = ROOT / "configs/measured/glasgow_5p8GHz.yaml"
TRAINING = ROOT / "configs/train/measured.yaml"
CLASSES = {  # names in measured data: ours
    "walking": "walking",
    "sitting_down": "sitting_down",
    "standing_up": "standing_up",
    "picking_up": "grabbing",
    "grabbing": "grabbing",
    "falling": "walking_to_falling",
    "walking_to_falling": "walking_to_falling",
}
SLUGS = tuple(dict.fromkeys(CLASSES.values()))
LONG = "walking"  # its maps last twice as long as those of the others
SIDE, BAND_HZ, SHOWN_HZ, LINE_HZ, SHOWN_S = 32, 500.0, 160.0, 24.0, 5
MEDIAN, BLUR = (5, 5), 3  # cells of a mask, rows and columns of 39 ms; pixels of an image
Axis = tuple[float, float]  # of the images: Doppler of the middle, Hz; exponent
COMPRESSED, LINEAR, FINE = (LINE_HZ, 0.65), (0.0, 1.0), 8  # FINE: samples a pixel
TREES = {"images": COMPRESSED, "linear": LINEAR}  # what networks see as they are, and adapted
TOWARDS = (  # walks that begin towards the radar, one in five
    "motion.angle_deg={uniform: [165, 195]}",
    "motion.range_m={uniform: [7.4, 8.2]}",
)
PAPERS_MOTION = "motion.model=paper"
INSTEAD = {  # what else could be simulated, and its keys
    "the paper's motion": (PAPERS_MOTION, "classes={}"),
    "segments": ("body.scatterers=segments",),
    "half of the band": ("processing.range_sum=coherent",),
    "CFAR on power": ("image.cfar={domain: power, edges: shrink}",),
    "an empty room": ("room.reflectors=[]", "room.back_wall_m=null"),
    "30 dB": ("snr_db=30",),
}
NO_AUGMENTATION = "augment={}"
BATCH_NORM = "model=smallnet_bn"  # of what is adapted
SEEDS = 5
MIN_PER_CLASS = 8  # fewer leave nothing to validate with
SHOTS, REPEATS = (0, 1, 5, 20, 100), 5
ADAPTING = 20  # epochs without labels, which networks with batch norm gain more by
SHOT_EPOCHS = 40  # of who learns from a few labelled maps, which are soon gone through
MAX_SIDE = 2048  # px of a mask
CONFUSED, BESIDE = 6, 3  # pairs of classes and images of each that are drawn


def network_image(mask: Bool, slug: str, axis: Axis = COMPRESSED) -> Levels:
    """A mask [H, W] as the network sees it [SIDE, SIDE]: the outline of what moves, blurred.

    Single cells and lines of interference go by a median, what is not connected with the line at
    zero goes too, holes are filled. Then the first 5 s within SHOWN_HZ, without what lies within
    LINE_HZ: how thick the line at zero is depends on the room and on SNR more than on who moves.
    Doppler f is at ((|f| - middle) / (SHOWN_HZ - middle))^exponent of the way out: who sits down or
    bends is hardly faster than LINE_HZ, and gets more pixels so. Without the first columns, in
    which filter and STFT start. Simulated and measured masks go the same way.
    """
    (middle, exponent), (height, width) = axis, mask.shape
    centre = height // 2
    body = mask[:, : width // 2] if slug == LONG else mask[:, ::2]  # columns as far apart in each
    body = ndimage.median_filter(body, size=MEDIAN)
    body[centre - 3 : centre + 3] = True
    parts, _ = ndimage.label(body)
    body = ndimage.binary_fill_holes(parts == parts[centre, 0])
    line = round(centre * LINE_HZ / BAND_HZ)
    body[centre - line : centre + line] = False
    body[:, : body.shape[1] // SIDE] = False
    way_out = (np.arange(FINE * SIDE // 2) + 0.5) / (FINE * SIDE // 2)
    hz = middle + (SHOWN_HZ - middle) * way_out ** (1 / exponent)
    above, below = (centre + sign * hz * centre / BAND_HZ for sign in (-1, 1))
    shown = body[np.concatenate([above[::-1], below]).astype(int)]
    levels = Image.fromarray(shown.astype(np.uint8) * 255)
    small = np.asarray(levels.resize((SIDE, SIDE), Image.Resampling.BOX))
    return ndimage.uniform_filter(small, BLUR)


def read_masks(path: Path) -> tuple[Bool, list[str]]:
    """Masks [K, H, W], and the class of each by our names, of the classes that we have.

    Raises:
        CaptureError: names the file and what is wrong with it.
    """
    images = list_images(path, packed=True)
    if not SIDE <= min(images.size) <= max(images.size) <= MAX_SIDE:
        raise CaptureError(
            f"{path}: masks have {images.size[0]} x {images.size[1]} px; should have {SIDE} to "
            f"{MAX_SIDE} a side"
        )
    names = [str(part["label"]).strip().lower().replace(" ", "_") for part in images.parts]
    rows = [row for row, name in enumerate(names) if name in CLASSES]
    if not rows:
        there = sorted(set(names))
        raise CaptureError(f"{path}: has no map of {', '.join(CLASSES)}; its classes are {there}")
    files = (images.parts[row]["file"] for row in rows)
    masks = [read_image(path.parent, file, images.size, packed=True) > 0 for file in files]
    return np.stack(masks), [CLASSES[names[row]] for row in rows]


def half_of(slugs: Sequence[str], half: int) -> Index:
    """Rows of the first (1) or second (2) half of each class: mostly of other persons."""
    names = np.array(slugs)
    rows = [np.flatnonzero(names == name) for name in dict.fromkeys(slugs)]
    found: Index = np.concatenate([np.array_split(of_class, 2)[half - 1] for of_class in rows])
    return found


def write_image(levels: Levels, path: Path) -> None:
    """Write a PNG, and its folder if need be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(levels).save(path)


def simulated(out: Path, per_class: int, jobs: int, more: Sequence[str] = ()) -> Path:
    """Trees of simulated images for the networks, in `out`; most falls from standing."""
    settings = json.dumps([per_class, more, hashlib.sha256(SIMULATED.read_bytes()).hexdigest()])
    if (out / "done").exists():
        if (out / "done").read_text() != settings:
            sys.exit(f"sim_to_real: {out}: is of other settings; -o should name a new folder")
        return out / "images"
    in_place = ",".join(SLUGS[1:-1])
    papers = PAPERS_MOTION in more  # who never turns round, nor falls from standing
    towards = 0 if papers else per_class // 5
    standing = 0 if papers else 3 * per_class // 4
    for name, count, sets in (
        ("walking_away", per_class - towards, ["activities=[walking]", "duration_s=10"]),
        ("walking_towards", towards, ["activities=[walking]", "duration_s=10", *TOWARDS]),
        ("in_place", per_class, [f"activities=[{in_place}]"]),
        ("falling_walking", per_class - standing, ["activities=[walking_to_falling]"]),
        ("falling_standing", standing, ["activities=[falling]"]),
    ):
        if not count:
            continue
        sets += [f"samples_per_class={count}", *more]
        run_radhar("generate", SIMULATED, "-o", out / name, "--jobs", jobs, *as_options(sets))
        with open_dataset(out / name) as data:
            masks, split = data.maps["stft"], data.split[:]
            for row, label in enumerate(data.label):
                slug = CLASSES[data.classes[label]]
                part = "val" if split[row] else "train"
                for tree, axis in TREES.items():
                    image = network_image(masks[row] > 0, slug, axis)
                    write_image(image, out / tree / part / slug / f"{name}_{row:05d}.png")
    (out / "done").write_text(settings)
    return out / "images"


def trained(data: Path, run: Path, seed: int, more: Sequence[str] = ()) -> Path:
    """A network that has learned from a tree of images."""
    run_radhar("train", data, "-o", run, "--config", TRAINING, *as_options((f"seed={seed}", *more)))
    return run


@dataclass(frozen=True)
class Measured:
    """Measured images in a tree, and the class of each."""

    folder: Path

    @classmethod
    def written(
        cls, masks: Bool, slugs: Sequence[str], folder: Path, axis: Axis = COMPRESSED
    ) -> "Measured":
        """Write them, in place of others."""
        shutil.rmtree(folder, ignore_errors=True)
        for row, (mask, slug) in enumerate(zip(masks, slugs, strict=True)):
            write_image(network_image(mask, slug, axis), folder / slug / f"{row:05d}.png")
        return cls(folder)

    def predicted(self, run: Path) -> "Predicted":
        """What a run makes of them."""
        metadata, model = load_best(run)
        images = open_for_model(metadata, self.folder, None)
        result = predict_classes(
            model, metadata, images, images.rows("all"), torch.device("cpu"), batch=128
        )
        return Predicted(images, result.truth, result.probabilities, metadata.classes)


@dataclass(frozen=True)
class Predicted:
    """Measured images, their true classes [N], and probabilities [N, classes]."""

    images: ImageSet
    truth: Index
    probabilities: Float
    classes: tuple[str, ...]

    @property
    def predicted(self) -> Index:
        """Classes [N]."""
        winners: Index = self.probabilities.argmax(1)
        return winners

    @property
    def accuracy(self) -> float:
        """Share of images whose class is found."""
        return float((self.truth == self.predicted).mean())

    @property
    def confusion(self) -> str:
        """A table: rows are true classes."""
        lines = [f"{'':20s}" + "".join(f"{name[:12]:>14s}" for name in self.classes)]
        for number, name in enumerate(self.classes):
            counts = np.bincount(self.predicted[self.truth == number], minlength=len(self.classes))
            lines.append(f"{name:20s}" + "".join(f"{count:14d}" for count in counts))
        return "\n".join(lines)


def accuracy_line(what: str, one: Predicted) -> str:
    """Accuracy of a run, with Wilson's interval of 95 %."""
    count = one.truth.size
    low, high = wilson_of_share(one.accuracy, count)
    return f"{what}: {one.accuracy:.3f} ({low:.3f} to {high:.3f}), n = {count}"


def seeds_line(what: str, some: Sequence[Predicted]) -> str:
    """Accuracy of all seeds: their mean and range."""
    each = [one.accuracy for one in some]
    return (
        f"{what}: mean {np.mean(each):.3f}, lowest {min(each):.3f}, highest {max(each):.3f}, "
        f"n = {some[0].truth.size}, {len(each)} seeds"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("masks", type=Path, help="measured masks, .npz")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder of all that is made")
    parser.add_argument("--quick", action="store_true", help="one seed")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="K", help=f"default {SEEDS}")
    parser.add_argument("--half", type=int, choices=(1, 2), help="of the maps of each class")
    parser.add_argument("--pieces", action="store_true", help="what each piece brings, few labels")
    parser.add_argument("--per-class", type=int, default=300, help="simulated maps of each class")
    parser.add_argument("--jobs", type=int, default=2, help="processes that generate")
    given = parser.parse_args()
    if given.per_class < MIN_PER_CLASS:
        parser.error(f"--per-class is {given.per_class}; should be at least {MIN_PER_CLASS}")
    if not given.masks.is_file():
        sys.exit(f"sim_to_real: {given.masks}: no such file")
    out: Path = given.out.resolve()
    images = simulated(out / "simulated", given.per_class, given.jobs)
    if given.seeds < 1:
        parser.error(f"--seeds is {given.seeds}; should be at least 1")
    seeds = range(1, 2 if given.quick else 1 + given.seeds)
    runs = [trained(images, out / f"runs/seed_{seed}", seed) for seed in seeds]
    linear = images.with_name("linear")
    to_adapt = [trained(linear, out / f"runs/bn_{seed}", seed, (BATCH_NORM,)) for seed in seeds]
    for run in (*runs, *to_adapt):
        digest = hashlib.sha256((run / "best.safetensors").read_bytes()).hexdigest()
        print(f"{run.name}: best.safetensors has SHA-256 {digest}", flush=True)
    try:
        masks, slugs = read_masks(given.masks)
    except CaptureError as error:
        sys.exit(f"sim_to_real: {error}")
    if given.half:
        rows = half_of(slugs, given.half)
        masks, slugs = masks[rows], [slugs[row] for row in rows]
    measured, unlabelled = (
        Measured.written(masks, slugs, out / "measured" / tree, axis)
        for tree, axis in TREES.items()
    )
    if given.pieces:
        ablation(measured, images, out / "instead", given)
        curve(unlabelled, linear, to_adapt[0], out / "shots")
    fitted = [adapted(run, unlabelled, linear, out / "adapted" / run.name) for run in to_adapt]
    results = {"as it is": (measured, images, runs), "adapted": (unlabelled, linear, fitted)}
    report(results, out, given.quick)


def ablation(measured: Measured, images: Path, out: Path, given: argparse.Namespace) -> None:
    """Print what all seeds reach where one thing is simulated otherwise, or not augmented."""
    made: dict[str, tuple[Path, list[Path]]] = {}
    for what, more in {**INSTEAD, "no augmentation": (NO_AUGMENTATION,)}.items():
        folder = out / re.sub(r"\W+", "_", what)
        same = more == (NO_AUGMENTATION,)
        data = images if same else simulated(folder, given.per_class, given.jobs, more)
        runs = [
            trained(data, folder / f"seed_{seed}", seed, more if same else ())
            for seed in range(1, 1 + given.seeds)
        ]
        made[what] = data, runs
        correct = [measured.predicted(run) for run in runs]
        print(seeds_line(f"{what}, as it is", correct), flush=True)
    for what, (data, runs) in made.items():
        correct = [
            measured.predicted(adapted(run, measured, data, run.parent / "adapted" / run.name))
            for run in runs
        ]
        print(seeds_line(f"{what}, adapted", correct), flush=True)


def curve(measured: Measured, images: Path, run: Path, out: Path) -> None:
    """Print accuracy with k labelled maps a class: fine-tuned, adapted as well, from scratch."""
    more = (f"epochs={SHOT_EPOCHS}",)
    options = ShotOptions(SHOTS, REPEATS, (images,), ADAPTING, more)
    for result in measure_few_shots(run, measured.folder, out, options):
        print(result, flush=True)


def adapted(run: Path, measured: Measured, data: Path, out: Path) -> Path:
    """The run, adapted to measured maps without their labels; it is shown its own on."""
    learned = ("--epochs", ADAPTING, "--mix", data)
    run_radhar("adapt", run, measured.folder, "-o", out, *learned, "--overwrite")
    return out


def mistakes_png(found: Predicted, simulated: ImageSet) -> bytes | None:
    """Draw measured images of the commonest errors beside simulated ones; None if all are right.

    Of each of CONFUSED pairs of a true and a predicted class, BESIDE measured images, the surest
    first; then the nearest simulated image of each, of the true and of the predicted class.
    """
    names, shown = found.classes, _grey(simulated, range(len(simulated)))
    pairs = Counter(zip(found.truth.tolist(), found.predicted.tolist(), strict=True))
    rows: dict[str, list[Picture]] = {}
    for (true, taken), count in pairs.most_common():
        if true == taken or len(rows) == CONFUSED:
            continue
        some = np.flatnonzero((found.truth == true) & (found.predicted == taken))
        surest = np.argsort(-found.probabilities[some, taken], kind="stable")[:BESIDE]
        levels = _grey(found.images, some[surest])
        row = [
            _picture(one, f"measured {Path(found.images.samples.name[number]).name}")
            for number, one in zip(some[surest], levels, strict=True)
        ]
        for slug in (names[true], names[taken]):
            of_class = shown[simulated.samples.label == simulated.classes.index(slug)]
            apart = (np.abs(of_class.astype(np.int16) - one) for one in levels)
            nearest = [one.sum((1, 2)).argmin() for one in apart]
            row += [_picture(of_class[number], f"simulated {slug}") for number in nearest]
        rows[f"{names[true]}\n{count} as\n{names[taken]}"] = row
    title = "Measured images that are taken for another class, and the nearest simulated ones"
    axis = f"Doppler ({SHOWN_HZ:g} Hz at 1)"
    return pictures_png(rows, title, "time (s)", axis) if rows else None


def _grey(images: ImageSet, rows: Iterable[int]) -> Levels:
    """Levels [N, H, W] of some images."""
    return np.stack([images.pixels.read(int(row))[..., 0] for row in rows])


def _picture(levels: Levels, words: str) -> Picture:
    return Picture(levels, (0, SHOWN_S, -1, 1), words)


def report(results: dict[str, tuple[Measured, Path, list[Path]]], out: Path, quick: bool) -> None:
    """Print what runs make of measured maps as they are, and others, with batch norm, adapted."""
    correct = {}
    for kind, (measured, images, runs) in results.items():
        correct[kind] = some = [measured.predicted(run) for run in runs]
        for run, one in zip(runs, some, strict=True):
            print(f"\n{run.name}, {kind}; rows are true classes\n{one.confusion}")
        if drawn := mistakes_png(some[0], open_for_model(load_best(runs[0])[0], images, None)):
            figure = out / f"mistakes_{kind.replace(' ', '_')}.png"
            figure.write_bytes(drawn)
            print(f"what it takes for something else, beside simulated maps: {figure}")
        if len(runs) > 1:
            mean = np.mean([one.probabilities for one in some], axis=0)
            together = replace(some[0], probabilities=mean)
            print(accuracy_line(f"{kind}, probabilities of all seeds averaged", together))
    line = (lambda what, some: accuracy_line(what, some[0])) if quick else seeds_line
    print(line("accuracy with unlabelled measured maps", correct["adapted"]))
    print(line("accuracy on measured", correct["as it is"]), flush=True)


if __name__ == "__main__":
    main()
