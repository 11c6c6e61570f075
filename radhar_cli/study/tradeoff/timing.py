"""Processor time of samples under a setting, beside that of what it is compared with."""

from collections.abc import Sequence
from statistics import median
from time import process_time
from typing import NamedTuple

from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import plan_images
from radhar_cli.study.tradeoff.scenes import Scenes, SweepSample
from radhar_cli.study.tradeoff.setting import Overrides, Setting

# Length of a round of a setting at which no further scene is begun, s.
SECONDS = 0.6
LEAST_ROUNDS = 3  # without which nothing is concluded
# From so many rounds on, the interval leaves out the outermost ones.
MANY_ROUNDS = 6


class Times(NamedTuple):
    """Times of one round of one setting."""

    sample_ms: float  # from drawing a scene to levels and entropy, a sample
    ratio: float  # over that of what it is compared with


class Ratio(NamedTuple):
    """Time of a setting over that of what it is compared with, over some rounds."""

    sample_ms: float  # median time of a sample, ms
    value: float
    low: float  # lower end of an interval of the median; the smallest of few rounds
    high: float
    rounds: int

    @classmethod
    def of(cls, rounds: Sequence[Times]) -> "Ratio":
        """Ratio of some rounds, one at least.

        The interval of six rounds or more leaves out the smallest and the largest, and so on: it
        holds the median in nine of ten cases or more.
        """
        ratios = sorted(times.ratio for times in rounds)
        cut = 0 if len(ratios) < MANY_ROUNDS else (len(ratios) - 3) // 3
        return cls(
            median(times.sample_ms for times in rounds),
            median(ratios),
            ratios[cut],
            ratios[-1 - cut],
            len(ratios),
        )


def time_setting(scenes: Scenes, setting: Setting, turn: int) -> Times:
    """Time a setting and what it is compared with in turns, scene by scene.

    Args:
        scenes: scenes of the sweep.
        setting: the setting.
        turn: number of the round, which decides with which scene it begins.
    """
    samples = scenes.samples()
    setting_s = base_s = 0.0
    for step in range(turn, turn + len(samples)):
        sample = samples[step % len(samples)]
        if step % 2:
            base_s += sample_seconds(scenes, sample, setting.base)
        setting_s += sample_seconds(scenes, sample, setting.overrides)
        if not step % 2:
            base_s += sample_seconds(scenes, sample, setting.base)
        if setting_s + base_s > SECONDS:
            break
    return Times(1e3 * setting_s / (step - turn + 1), setting_s / base_s)


def sample_seconds(scenes: Scenes, sample: SweepSample, overrides: Overrides) -> float:
    """Processor time of a sample: drawn, checked, simulated, and its images made, s."""
    config = scenes.config(overrides)
    plan = plan_images(config)
    start = process_time()
    run(plan, {"scene": scenes.draw(sample, config)})
    return process_time() - start
