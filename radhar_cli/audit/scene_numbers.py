"""Numbers of simulated scenes that are not the movement, out of the annotations of the config.

A number belongs to the movement if its key says which movements use it (`People`, `Paper`): speeds,
rates, sizes, durations. Everything else is where, when, who, and through what: the place, the
heading, the body, the SNR, walls and rooms, other people. When a movement begins or ends is no part
of it either, though its keys name movements: those are the keys of `timing` that name an instant.
"""

import re
from collections.abc import Iterator, Mapping

import numpy as np

from radhar_cli.audit.evidence import Evidence, EvidencePart
from radhar_cli.config.annotations import Paper, People, annotations
from radhar_cli.config.data_set import Config
from radhar_cli.config.motion import TimingConfig
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.scene_fields import ERROR, ONSET
from radhar_cli.numerics.arrays import Float, Index

# Ends of the names of keys of `timing` that say when, not how long.
INSTANT = re.compile(r"timing\.(\w+_(start|begin|stop)_s|onset)$")
ON_CUE_S = 0.25  # standard deviation of an onset below which it is the same in all samples
FEW_VALUES = 6  # that are written as a choice


def is_instant(key: str) -> bool:
    """Whether a dotted key says when something begins or ends."""
    return INSTANT.match(key) is not None


def is_onset(key: str) -> bool:
    """Whether a column says when the sample's own person begins."""
    of_timing = is_instant(key) and key.rpartition(".")[2] in TimingConfig.model_fields
    return of_timing or key == ONSET.key


def is_of_movement(key: str) -> bool:
    """Whether the number of a dotted key is a part of the class's movement.

    Numbers of other people in the scene (`people.0.motion...`) are none. The second at which the
    movement begins follows from the onset, which is a number of its own, and from what people do.
    """
    if key.startswith("people.") or is_instant(key):
        return False
    if key.startswith("classes."):  # durations of parts, or which file is followed
        return True
    about = annotations(Config).get(key, ())
    return any(isinstance(mark, People | Paper) and mark.names for mark in about)


def audited_numbers(data: Dataset) -> dict[str, Float]:
    """Numbers that are not the movement and vary, {dotted key: [N] in the units of the keys}.

    Instants come as one number, `timing.*`: each class has its own.
    """
    numbers, instants = dict[str, Float](), dict[str, Float]()
    for field in data.fields:
        if field.key in (ERROR.key, ONSET.key) or is_of_movement(field.key):
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
    """Earliest instant of each sample, under the keys of all instants, beside a share of `onset`.

    It is kept where it does not vary, too: then every movement begins on cue.
    """
    share = {key: values for key, values in instants.items() if key.endswith(".onset")}
    seconds = {key: values for key, values in instants.items() if key not in share}
    onsets = {key: values for key, values in share.items() if varies(values)}
    if seconds:
        table = np.stack([*seconds.values()])
        earliest = np.min(np.where(np.isnan(table), np.inf, table), axis=0)
        onsets[" ".join(seconds)] = np.where(np.isfinite(earliest), earliest, np.nan)
    return onsets


def scene_evidence(data: Dataset) -> list[Evidence]:
    """Evidence of each scene number that is not the movement, and of all of them together."""
    singles = [
        _evidence_of(key, values) for key, values in audited_numbers(data).items() if varies(values)
    ]
    if len(singles) < 2:
        return singles
    table = np.column_stack([_filled(single) for single in singles if not single.tells_who])
    together = Evidence(
        EvidencePart.NUMBERS,
        f"all {table.shape[1]} numbers together",
        table,
        cure="draw each number above by one law for all classes",
    )
    return [*singles, together]


def _evidence_of(key: str, values: Float) -> Evidence:
    """Evidence of one number."""
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
        cure_of(key, values),
        leaves_out_missing=not is_other,
    )


def _words(key: str) -> str:
    """A key as tables name it: instants, which stand for several, by what they are."""
    return "when it begins or ends (timing)" if " " in key else key


def cure_of(key: str, values: Float) -> str:
    """What to write into a config, so that a number is drawn alike for all classes.

    Args:
        key: dotted key, or several, with spaces between.
        values: [N] what was drawn, all classes together.
    """
    known = annotations(Config)
    law, keys = one_law(values), key.split()
    if key == "motion.range_m" and "motion.place.range_m" in known:
        keys = ["motion.place.range_m"]
    if is_instant(keys[0]) and not key.endswith(".onset"):
        if "timing.onset" in known:
            return "leave " + ", ".join(keys) + " null and write timing.onset: {uniform: [0, 1]}"
        law = _law_of_instants(values)
    return "; ".join(f"{name}: {law}" for name in keys)


def one_law(values: Float) -> str:
    """A law, as YAML, that reaches over all values [N] that were drawn."""
    known = np.unique(values[np.isfinite(values)])
    if known.size <= FEW_VALUES:
        return f"{{choice: [{', '.join(f'{value:.4g}' for value in known)}]}}"
    return f"{{uniform: [{known[0]:.3g}, {known[-1]:.3g}]}}"


def _law_of_instants(values: Float) -> str:
    """A law of instants that differ by at least a second."""
    known = values[np.isfinite(values)]
    low, high = float(known.min()), float(known.max())
    return f"{{uniform: [{min(low, 0.2):.3g}, {max(high, low + 2):.3g}]}}"


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


def onsets_on_cue(data: Dataset, label: Index) -> Iterator[tuple[str, str, float, float]]:
    """Yield (class, keys, mean s, standard deviation s) of onsets that hardly vary in a class."""
    seconds = {field.key: data.scene[field.name][:] for field in data.fields if is_onset(field.key)}
    for key, values in seconds.items():
        if not key.endswith("_s"):
            continue
        for number, name in enumerate(data.classes):
            known = values[label == number]
            known = known[np.isfinite(known)]
            if known.size >= 2 and known.std() < ON_CUE_S:
                yield name, key, float(known.mean()), float(known.std())
