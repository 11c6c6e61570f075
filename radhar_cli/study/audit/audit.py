"""`radhar audit`: how well the class can be told from all that is not the movement."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from radhar_cli.dataset.reading import open_dataset
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.study.audit.clouds import cloud_evidence
from radhar_cli.study.audit.duplicates import (
    Overlaps,
    Pairs,
    count_across_splits,
    identical_pairs,
    near_pairs,
)
from radhar_cli.study.audit.evidence import Evidence, EvidencePart
from radhar_cli.study.audit.held_out import ClassShare, Effort, class_share, holm
from radhar_cli.study.audit.opening import AuditedSet, open_for_audit
from radhar_cli.study.audit.pictures import (
    PictureFeatures,
    band_contrast,
    bands_far_from_bodies,
    picture_evidence,
    picture_features,
    thumbnail_of,
)
from radhar_cli.study.audit.recordings import numbered

SIGNIFICANT = 0.05  # p, adjusted for the number of lines, from which on a share is chance
MAX_IMAGES = 20_000  # among which duplicates are looked for
# What is told beyond chance, over what chance leaves: Cohen's kappa of equal classes.
HARDLY, SOME, MUCH = 0.05, 0.2, 0.5
QUICK = Effort(trees=30, folds=3, permutations=400)
QUICK_SAMPLES = 60  # of a class


@dataclass(frozen=True)
class AuditLine:
    """Result of the audit of one piece of evidence."""

    evidence: Evidence
    result: ClassShare | None  # None where it cannot be tested
    p: float  # adjusted for the number of lines; NaN without a result

    @property
    def is_leak(self) -> bool:
        """Whether the class is told, beyond chance: by p and by the interval, which it takes both.

        p alone is too small where groups are few, as forests are not fitted anew to each
        permutation; the interval alone knows nothing of the number of lines.
        """
        result = self.result
        if result is None or result.is_confounded:
            return False
        return self.p < SIGNIFICANT and result.low > result.chance

    @property
    def verdict(self) -> str:
        """Meaning of the result, in words."""
        if self.result is None:
            return "not tested: too few persons, recordings or samples of each class"
        if self.result.is_confounded:
            return "cannot be told: each person or recording has one class, and few have each"
        if self.result.high < self.result.chance:
            return "at chance: every class has each value as often"
        if not self.is_leak:
            beyond = (self.result.high - self.result.chance) / (1 - self.result.chance)
            return "at chance" if beyond < SOME else "at chance, of too few samples to tell"
        share, chance = self.result.share, self.result.chance
        beyond = (share - chance) / (1 - chance)
        words = "gives the class away"
        if beyond < MUCH:
            words = "tells much of the class"
        if beyond < SOME:
            words = "tells some of the class"
        if beyond < HARDLY:
            words = "hardly tells the class"
        return f"{words}; it may be the movement" if self.evidence.may_be_movement else words

    @property
    def cure(self) -> str:
        """Advice on data to draw or record instead; empty where nothing is told."""
        return self.evidence.cure if self.is_leak else ""


@dataclass(frozen=True)
class Audit:
    """Everything that was found of a data set.

    Attributes:
        data: the data set.
        rows: rows from which classes were guessed.
        held_out: unit that was held out whole: person, recording or sample.
        lines: a line for each piece of evidence.
        overlaps: duplicates, and persons in several splits.
        effort: seed and size of the forests.
        warnings: warnings for the reader.
    """

    data: AuditedSet
    rows: Index
    held_out: str
    lines: tuple[AuditLine, ...]
    overlaps: Overlaps
    effort: Effort
    warnings: tuple[str, ...] = field(default=())

    @property
    def sentences(self) -> list[str]:
        """Warnings beside the lines: laws by class, duplicates, split persons, cues."""
        return [*self.data.laws, *self.overlaps.sentences, *self.data.on_cue]

    def lines_above(self, share: float, parts: Sequence[EvidencePart]) -> list[AuditLine]:
        """Lines of some parts, from which the class is told more often than that.

        When a movement begins in seconds is not among them, as its length bounds that.
        """
        judged = [
            line
            for line in self.lines
            if line.evidence.part in parts
            and not (line.evidence.part == EvidencePart.NUMBERS and line.evidence.may_be_movement)
        ]
        return [line for line in judged if line.result is not None and line.result.share > share]


def audit(
    path: str | Path,
    progress: Progress = NO_PROGRESS,
    map_name: str | None = None,
    table: Path | None = None,
    effort: Effort | None = None,
    max_samples: int = 300,
) -> Audit:
    """Audit a data set.

    Args:
        path: dataset.h5 or its folder, a tree of images, or a CSV file with a column `class`.
        progress: is told how far it is.
        map_name: map whose images are looked at; None takes the first.
        table: CSV file of further columns of the samples; None for nothing.
        effort: size of the forests and seed; None is the usual one.
        max_samples: largest number of samples of a class from which it is guessed, drawn at random.

    Raises:
        FolderError: a file cannot be used.
    """
    effort = effort or Effort()
    data = open_for_audit(Path(path), map_name, table)
    rows = draw_rows(data, max_samples, effort.seed)
    warnings = list[str]()
    if rows.size < len(data):
        warnings.append(f"classes are guessed from {rows.size} of {len(data)} samples")
    group, held_out = _groups(data, rows, warnings)
    evidence = [replace(e, values=e.values[rows]) for e in data.evidence]
    evidence += clouds_of(data, rows)
    scan = scan_pictures(data, rows, progress)
    if scan is not None:
        features = list(_read_pictures(data, rows, scan.far_bands(rows), progress))
        size, label = scan.size, data.label[rows]
        evidence += picture_evidence(features, label, size, data.is_simulated, data.image)
    recording = np.arange(rows.size)
    if data.recording is not None:
        recording = numbered([data.recording[row] for row in rows])
    lines = _guess(evidence, data.label[rows], (group, recording), effort, progress)
    overlaps = find_overlaps(data, scan)
    warnings += [*_left_out(data, rows, group), *data.too_few_on_cue]
    return Audit(data, rows, held_out, lines, overlaps, effort, tuple(warnings))


def clouds_of(data: AuditedSet, rows: Index) -> list[Evidence]:
    """Evidence of the clouds of some rows of a data set; none where it has no clouds."""
    if not data.has_clouds:
        return []
    with open_dataset(data.where) as opened:
        return cloud_evidence(opened, rows, data.is_simulated)


def draw_rows(data: AuditedSet, max_samples: int, seed: int) -> Index:
    """Rows of at most so many samples of each class, drawn at random, in order."""
    rng = stream(seed, TRAINING, name="audit rows")
    drawn = []
    for number in range(len(data.classes)):
        rows = np.flatnonzero(data.label == number)
        if rows.size > max_samples:
            rows = rng.choice(rows, max_samples, replace=False)
        drawn.append(rows)
    return np.sort(np.concatenate(drawn))


def _groups(data: AuditedSet, rows: Index, warnings: list[str]) -> tuple[Index, str]:
    """Number of the person, recording or sample of each row, and which of these it is."""
    for names, kind in ((data.person, "person"), (data.recording, "recording")):
        if names is None:
            continue
        group = numbered([names[row] for row in rows])
        pairs = np.unique(np.stack([data.label[rows], group]), axis=1)[0]
        if np.count_nonzero(np.bincount(pairs) >= 2) >= 2:
            return group, kind
        warnings.append(
            f"too few {kind}s have each class to hold some out: samples are held out, and what "
            f"tells {kind}s apart tells their classes"
        )
    return np.arange(rows.size), "sample"


def _left_out(data: AuditedSet, rows: Index, group: Index) -> list[str]:
    """Warn of classes that have a single group, and so cannot be guessed."""
    pairs = np.unique(np.stack([data.label[rows], group]), axis=1)[0]
    counts = np.bincount(pairs, minlength=len(data.classes))
    alone = [name for name, count in zip(data.classes, counts, strict=True) if count == 1]
    if not alone:
        return []
    return [f"left out, as one person, recording or sample alone has it: {', '.join(alone)}"]


@dataclass(frozen=True)
class PictureScan:
    """Results of a first look at images: digests, thumbnails, and bands where bodies are."""

    rows: Index  # [M] rows of the data set
    digests: list[str]  # [M]
    thumbnails: Levels  # [M, SIDE, SIDE]
    size: tuple[int, int]  # (H, W) of the first
    contrast: Float  # [M, SIDE] how far something stands out in each band of rows

    def far_bands(self, rows: Index) -> list[int]:
        """Bands of rows that bodies reach least in some rows of the data set."""
        return bands_far_from_bodies(self.contrast[np.isin(self.rows, rows)])


def scan_pictures(data: AuditedSet, rows: Index, progress: Progress) -> PictureScan | None:
    """Look at all images of a data set; at those of some rows, where there are too many.

    Returns:
        What was found; None where there are no images.
    """
    if data.images is None:
        return None
    looked_at = np.arange(len(data)) if len(data) <= MAX_IMAGES else rows
    digests, thumbnails, contrast = list[str](), list[Levels](), list[Float]()
    progress.stage("looking at images", looked_at.size, 0, "image")
    for row in looked_at.tolist():
        levels = data.images.pixels.read(row)[..., 0]
        size = f"{levels.shape}".encode()
        digests.append(hashlib.blake2b(levels.tobytes() + size, digest_size=16).hexdigest())
        thumbnails.append(thumbnail_of(levels))
        contrast.append(band_contrast(levels))
        progress.advance(1)
    height, width = data.images.pixels.read(int(looked_at[0])).shape[:2]
    shrunk, stands_out = np.stack(thumbnails), np.stack(contrast)
    return PictureScan(looked_at, digests, shrunk, (height, width), stands_out)


def _read_pictures(
    data: AuditedSet, rows: Index, bands: list[int], progress: Progress
) -> Iterator[PictureFeatures]:
    """Yield the features of each image."""
    assert data.images is not None
    progress.stage("measuring images", rows.size, 0, "image")
    for row in rows.tolist():
        yield picture_features(data.images.pixels.read(row)[..., 0], bands, data.file_of(row))
        progress.advance(1)


def _guess(
    evidence: Sequence[Evidence],
    label: Index,
    groups: tuple[Index, Index],
    effort: Effort,
    progress: Progress,
) -> tuple[AuditLine, ...]:
    """Guess the class from each piece of evidence; constant and empty evidence is left out.

    Args:
        label: [N] class of each.
        groups: numbers [N] of the groups held out: usual ones, and where evidence tells the person.
        effort: size of the forests and seed.
        progress: is told of each piece.
    """
    evidence = [piece for piece in evidence if _has_values(piece.values)]
    count = max(effort.permutations, 40 * len(evidence))  # so that Holm's p can be small
    effort = replace(effort, permutations=count)
    progress.stage("guessing classes", len(evidence), 0, "line")
    results = []
    for piece in evidence:
        rows = np.arange(label.size)
        if piece.leaves_out_missing:
            rows = np.flatnonzero(np.isfinite(piece.values).all(axis=1))
        group = groups[1] if piece.tells_who else groups[0]
        name = f"{piece.part} {piece.name}"
        ranks = None if piece.ranks is None else piece.ranks[rows]
        values, truth = piece.values[rows], label[rows]
        results.append(class_share(values, truth, group[rows], effort, name, ranks))
        progress.advance(1)
    tested = [number for number, result in enumerate(results) if result is not None]
    p = np.full(len(results), np.nan)
    p[tested] = holm(np.array([result.p for result in results if result is not None]))
    lines = zip(evidence, results, p.tolist(), strict=True)
    return tuple(AuditLine(*line) for line in lines)


def _has_values(values: Float) -> bool:
    """Whether any column of values [N, D] differs from sample to sample."""
    return any(np.unique(column).size > 1 for column in values.T)


def find_overlaps(data: AuditedSet, scan: PictureScan | None) -> Overlaps:
    """Find duplicates among the images that were looked at, and what is in several splits."""
    across = {
        kind: count_across_splits(names, data.split)
        for kind, names in (
            ("person", data.person),
            ("recording", data.recording),
            ("scene", data.scene),
        )
    }
    if scan is None:
        return Overlaps(Pairs(0, 0, 0), Pairs(0, 0, 0), across)
    label, names = data.label[scan.rows], [data.names[row] for row in scan.rows]
    split = None if data.split is None else data.split[scan.rows]
    pairs = (identical_pairs(scan.digests), near_pairs(scan.thumbnails, scan.digests))
    identical, near = (Pairs.of(kind, label, split, names) for kind in pairs)
    return Overlaps(identical, near, across)
