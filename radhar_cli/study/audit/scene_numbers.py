"""Numbers of simulated scenes that are not the movement (`config.class_laws`), as evidence."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from radhar_cli.config.class_laws import is_instant, is_of_movement
from radhar_cli.config.data_set import Config
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.scene_fields import ERROR, ONSET
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.study.audit.evidence import Evidence, EvidencePart

ON_CUE_S = 0.25  # standard deviation of an onset below which it is the same in all samples
ENOUGH = 10  # samples of a class from which that is said
FEW_VALUES = 6  # that are written as a choice


def audited_numbers(data: Dataset) -> dict[str, Float]:
    """Numbers that are not the movement and vary, {dotted key: [N] in the units of the keys}.

    Instants come as one number, `timing.*`: each class has its own.
    """
    numbers, instants = dict[str, Float](), dict[str, Float]()
    for field in data.fields:
        if field.key == ERROR.key or is_of_movement(field.key):
            continue
        values = data.scene[field.name][:] / field.factor
        if is_instant(field.key):
            instants[field.key] = values
        elif varies(values):
            numbers[field.key] = values
    if instants:
        numbers |= _onsets(instants)
    if data.config.split.subjects is not None:
        numbers["subject"] = data.scene["subject"][:].astype(float)
    return numbers


def varies(values: Float) -> bool:
    """Whether values [N] differ, or some are missing."""
    known = values[np.isfinite(values)]
    if not known.size:
        return False
    spread = float(known.max() - known.min())
    return spread > 1e-9 * float(np.abs(known).max()) or 0 < known.size < values.size


def _onsets(instants: Mapping[str, Float]) -> dict[str, Float]:
    """Return the onsets that were drawn, and the times at which movements begin, by key.

    Where the data set does not say when, it is the earliest of the instants that were drawn, under
    the keys of all of them.
    """
    known = (ONSET.key, "timing.onset")
    onsets = {key: instants[key] for key in known if key in instants and varies(instants[key])}
    seconds = {key: values for key, values in instants.items() if key not in known}
    if seconds and ONSET.key not in instants:
        table = np.stack([*seconds.values()])
        earliest = np.min(np.where(np.isnan(table), np.inf, table), axis=0)
        onsets[" ".join(seconds)] = np.where(np.isfinite(earliest), earliest, np.nan)
    return onsets


def scene_evidence(data: Dataset) -> list[Evidence]:
    """Evidence of each scene number that is not the movement, and of all of them together.

    When a movement begins, in seconds, is not among the latter where its share is: both together
    tell how long the movement takes.
    """
    has_place = isinstance(data.config, Config) and data.config.motion.model != "paper"
    numbers = audited_numbers(data).items()
    singles = [_evidence_of(key, values, has_place) for key, values in numbers if varies(values)]
    if len(singles) < 2:
        return singles
    drawn = [single for single in singles if not single.tells_who and single.key != ONSET.key]
    table = np.column_stack([_filled(single) for single in drawn])
    together = Evidence(
        EvidencePart.NUMBERS,
        f"all {table.shape[1]} numbers together",
        table,
        cure="draw each number above by one law for all classes",
    )
    return [*singles, together]


def _evidence_of(key: str, values: Float, has_place: bool) -> Evidence:
    """Evidence of one number, whose config may say where people are at an instant."""
    if key == "subject":
        return Evidence(
            EvidencePart.NUMBERS,
            "who it is",
            values[:, None],
            "split.subjects",
            "samples_per_class should be a multiple of split.subjects",
            tells_who=True,
        )
    is_other = key.startswith("people.")
    return Evidence(
        EvidencePart.NUMBERS,
        _words(key),
        values[:, None],
        key,
        cure_of(key, values, has_place),
        may_be_movement=key == ONSET.key,  # how long it takes bounds when it begins
        leaves_out_missing=not is_other,
    )


def _words(key: str) -> str:
    """A key as tables name it: instants, which stand for several, by what they are."""
    if key == ONSET.key:
        return "when the movement begins (s)"
    return "when it begins or ends (timing)" if key.startswith("timing.") and " " in key else key


def cure_of(key: str, values: Float, has_place: bool) -> str:
    """Advise on a config, so that a number is drawn alike for all classes.

    Args:
        key: dotted key, or several, with spaces between.
        values: [N] what was drawn, all classes together.
        has_place: whether the model of motion knows motion.place.
    """
    if key == ONSET.key:
        return (
            "timing.onset: {uniform: [0, 1]}, and a smaller timing.visible; durations do the rest"
        )
    law, keys = one_law(values), key.split()
    if has_place and key in ("motion.range_m", "motion.cross_range_m"):
        place = key.replace("motion.", "motion.place.")
        return f"leave {key} null, and write {place}: {law}"
    if is_instant(keys[0]):
        drawn = [name for name in keys if name != "timing.onset"]
        null = f"leave {', '.join(drawn)} null, and write " if drawn else ""
        return f"{null}timing.onset: {{uniform: [0, 1]}}"
    return f"{keys[0]}: {law}"


def one_law(values: Float) -> str:
    """A law, as YAML, that reaches over all values [N] that were drawn."""
    known = np.unique(values[np.isfinite(values)])
    if known.size <= FEW_VALUES:
        return f"{{choice: [{', '.join(f'{value:.4g}' for value in known)}]}}"
    return f"{{uniform: [{known[0]:.3g}, {known[-1]:.3g}]}}"


def _filled(single: Evidence) -> Float:
    """Values [N] of a number; where a class has none, values that others have, in turn.

    So that it is missing tells nothing: whether a movement has a number is the movement's.
    """
    values = single.values[:, 0].copy()
    missing = np.flatnonzero(np.isnan(values))
    if single.leaves_out_missing and missing.size < values.size:
        pool = values[~np.isnan(values)]
        draws = np.random.default_rng(0).integers(pool.size, size=missing.size)
        values[missing] = pool[draws]
    return values


class CueSentences(NamedTuple):
    """Warnings of onsets that hardly vary within a class, a sentence for each key."""

    on_cue: list[str]
    too_few: list[str]  # of classes with too few samples to tell


def sentences_on_cue(data: Dataset, label: Index) -> CueSentences:
    """Sentences on the onsets of samples with labels [N] that hardly vary within a class."""
    on_cue, too_few = dict[str, list[str]](), dict[str, list[str]]()
    for field in data.fields:
        if not is_instant(field.key) or not field.key.endswith("_s"):
            continue
        values = data.scene[field.name][:]
        for number, name in enumerate(data.classes):
            known = values[label == number]
            known = known[np.isfinite(known)]
            if known.size < 2 or known.std() >= ON_CUE_S:
                continue
            if known.size < ENOUGH:
                too_few.setdefault(field.key, []).append(f"{name} ({known.size})")
            else:
                words = f"{name} {known.mean():.2f} s (sd {known.std():.2f})"
                on_cue.setdefault(field.key, []).append(words)
    return CueSentences(
        [f"{key} is on cue: {', '.join(classes)}" for key, classes in on_cue.items()],
        [
            f"{key}: too few samples to tell whether it is on cue: {', '.join(classes)}"
            for key, classes in too_few.items()
        ],
    )
