"""What cheaper data costs its user: the accuracy of a fixed network trained on it.

Compared at an SNR where the task is neither trivial nor hopeless: where every network is right, or
none is, no setting can matter.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from radhar_cli.tradeoff.trial import (
    DistinctMessages,
    Experiment,
    TestResult,
    Trial,
    TrialData,
    score,
)

# Within -120 dB of the cube, a map of 256 levels cannot tell the direct engine from it.
REFERENCE = ("engine={kind: direct, tolerance_db: -120, fallback: cube}",)
BAND = (0.70, 0.95)
FIRST_SNR_DB, STEP_DB = 0.0, 5.0


@dataclass(frozen=True)
class Accuracy:
    """Share of the test images of a trial that are recognised.

    Attributes:
        name: of the trial.
        mean: over the seeds.
        low, high: Wilson's 95 % interval of the mean for the number of test images. All seeds see
            the same images, so they do not make it narrower.
        seeds: the share of each.
        images: tested on.
    """

    name: str
    mean: float
    low: float
    high: float
    seeds: tuple[float, ...]
    images: int


def measure(experiment: Experiment, trials: Sequence[Trial], snr_db: float) -> list[Accuracy]:
    """Train and test every trial with every seed; cached results are reused.

    A data set that several trials ask for is built once, and deleted after the last of them.

    Raises:
        ConfigError: an override that does not fit; nothing was computed.
        SceneError, UnfinishedError, FolderError: as `radhar generate`.
        FolderError: test images of another size, map or classes than those learned from.
        TrainingError: as `radhar train`.
    """
    experiment = replace(experiment, progress=DistinctMessages(experiment.progress))
    setups = [TrialData.of(experiment, trial, snr_db) for trial in trials]
    accuracies = []
    for number, setup in enumerate(setups):
        scores = [score(experiment, setup, seed) for seed in experiment.sizes.seeds]
        accuracies.append(_accuracy(setup.trial.name, scores))
        experiment.remove_data(keep={name for later in setups[number + 1 :] for name in later.data})
    experiment.remove_all()
    return accuracies


def _accuracy(name: str, scores: Sequence[TestResult]) -> Accuracy:
    from radhar_cli.learning.metrics import wilson

    images = scores[0].images
    right = sum(one.right for one in scores) / len(scores)
    low, high = wilson(round(right), images)
    return Accuracy(name, right / images, low, high, tuple(one.share for one in scores), images)


def find_snr(experiment: Experiment) -> float:
    """SNR (dB) at which training and testing on reference data is right in 70 to 95 % of cases.

    Judged by the first seed: 0 dB, then steps of 5 dB; once the band lies between two tries, the
    middle of them. Where none of the tries hits the band, the nearest.

    Raises:
        as `measure`.
    """
    experiment = replace(experiment, progress=DistinctMessages(experiment.progress))

    def accuracy_at(snr_db: float) -> float:
        setup = TrialData.of(experiment, Trial("reference", REFERENCE, REFERENCE), snr_db)
        share = score(experiment, setup, experiment.sizes.seeds[0]).share
        experiment.progress.say(f"at {snr_db:g} dB the reference is right in {100 * share:.1f} %")
        experiment.remove_data(keep=setup.data)
        return share

    return searched(accuracy_at, experiment.sizes.snr_tries)


def searched(accuracy_at: Callable[[float], float], tries: int) -> float:
    """The first SNR (dB) on the way of `find_snr` that hits the band, else the nearest to it.

    Args:
        accuracy_at: share of right answers at an SNR (dB), which grows with it.
        tries: at most so many calls.
    """
    low, high = BAND
    missed: dict[float, float] = {}
    noisy: float | None = None  # below the band, and the cleanest such; clean: above it
    clean: float | None = None
    snr_db = FIRST_SNR_DB
    for _ in range(tries):
        share = accuracy_at(snr_db)
        if low <= share <= high:
            return snr_db
        missed[snr_db] = max(low - share, share - high)
        if share < low:
            noisy = snr_db
        else:
            clean = snr_db
        if noisy is not None and clean is not None:
            snr_db = (noisy + clean) / 2
        else:
            snr_db += STEP_DB if share < low else -STEP_DB
    return min(missed, key=missed.__getitem__)
