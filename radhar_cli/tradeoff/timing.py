"""Time per sample, as a ratio to another setting's on the same scenes at the same time."""

from time import process_time
from typing import NamedTuple

from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.run import run
from radhar_cli.tradeoff.scenes import Scenes
from radhar_cli.tradeoff.settings import Setting

# How long a setting is timed in a round, at most this and one scene more.
SECONDS = 0.6
ECHO = (
    *("motions", "paths", "direct", "echo", "signal_power", "slow_time", "signal"),
    *("room", "snr_paths", "beat_cube", "range_profiles", "gate", "gated_echo", "range_signals"),
)


class Times(NamedTuple):
    """One round of one setting.

    Attributes:
        sample_ms: from scene to levels and entropy, a sample.
        echo_ms: of that, paths and echo.
        ratio, echo_ratio: the same over those of the baseline.
    """

    sample_ms: float
    echo_ms: float
    ratio: float
    echo_ratio: float


def time_setting(scenes: Scenes, setting: Setting, turn: int) -> Times:
    """Time a setting and its baseline in turns, scene by scene, for a fraction of a second."""
    names = scenes.names()
    own, usual = [0.0, 0.0], [0.0, 0.0]
    count = 0
    for step in range(len(names)):
        slug = names[(turn + step) % len(names)]
        both = [(setting.baseline, usual), (setting.overrides, own)]
        for overrides, spent in both if (turn + step) % 2 else reversed(both):
            for part, seconds in enumerate(_seconds(scenes, slug, overrides)):
                spent[part] += seconds
        count += 1
        if own[0] + usual[0] > SECONDS:
            break
    return Times(1e3 * own[0] / count, 1e3 * own[1] / count, own[0] / usual[0], own[1] / usual[1])


def _seconds(scenes: Scenes, slug: str, overrides: tuple[str, ...]) -> tuple[float, float]:
    config = scenes.config(overrides)
    scene, plan = scenes.draw(slug, config), plan_images(config)
    start = process_time()
    recording = run(plan, {"scene": scene})
    whole = process_time() - start
    return whole, sum(t for name, t in recording.seconds.items() if name in ECHO)
