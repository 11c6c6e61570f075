"""Settings of a TI board: fewer frames, loops, samples, transmitters and receivers; its points."""

import json
import re
from collections.abc import Callable, Iterator, Sequence

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import (
    BoardRadar,
    ChirpFramesRadar,
    FramesRadar,
    Steps,
)
from radhar_cli.study.tradeoff.setting import Setting, Worth, keyed

CHIRP_END, LOOPS, PERIOD = 2, 3, 5  # places in a line of frameCfg
SAMPLES, RATE = 10, 11  # in one of profileCfg
RX_MASK = 1  # in one of channelCfg


def board_settings(radar: BoardRadar, config: Config) -> Iterator[Setting]:
    """Yield settings of a board's .cfg and of its points.

    Args:
        radar: radar of the config.
        config: config of the data set.
    """
    timing = radar.timing
    changed = {
        "half as many frames": _scaled("frameCfg", {PERIOD: 2}),
        f"{timing.loops // 2} loops a frame": _scaled("frameCfg", {LOOPS: 0.5}),
        "half as many samples a chirp": _scaled("profileCfg", {SAMPLES: 0.5, RATE: 0.5}),
    }
    transmitters = len(timing.masks)
    for count in range(transmitters - 1, 0, -1):
        name = f"{count} transmitter{'s' * (count > 1)}"
        changed[name] = _set("frameCfg", {CHIRP_END: count - 1})
    receivers = len(timing.receivers)
    if receivers > 2:
        mask = sum(1 << receiver for receiver in timing.receivers[: receivers // 2])
        changed[f"{receivers // 2} receivers"] = _set("channelCfg", {RX_MASK: mask})
    for name, change in changed.items():
        text = change(radar.cfg)
        if text != radar.cfg:
            yield Setting("board", name, (f"radar.cfg={json.dumps(text)}",), worth=Worth.SAVES)
    if "points" in config.maps:
        yield from _point_settings(config)


def frame_settings(radar: FramesRadar, config: Config) -> Iterator[Setting]:
    """Yield settings of a radar's frames and of its points.

    Args:
        radar: radar of the config.
        config: config of the data set.
    """
    timing = radar.timing
    yield keyed("radar", f"radar.frame.period_s={2 * timing.period_s:g}", Worth.SAVES)
    if timing.loops > 1:
        yield keyed("radar", f"radar.frame.chirps={timing.loops // 2}", Worth.SAVES)
    if isinstance(radar, Steps):
        yield half_as_many_steps(radar)
    elif isinstance(radar, ChirpFramesRadar):
        yield keyed("radar", f"radar.adc_rate_hz={radar.adc_rate_hz / 2:g}", Worth.SAVES)
    if "points" in config.maps:
        yield from _point_settings(config)


def half_as_many_steps(radar: Steps) -> Setting:
    """Setting of half as many steps, each twice as long, of a sweep.

    Args:
        radar: radar of the config.
    """
    overrides = (f"radar.steps={radar.steps // 2}", f"radar.dwell_s={2 * radar.dwell_s:g}")
    return Setting("radar", f"radar.steps: {radar.steps // 2}", overrides, worth=Worth.SAVES)


def _point_settings(config: Config) -> Iterator[Setting]:
    """Yield other ways to find points."""
    cloud = config.cloud
    other_chain = "board" if cloud.chain == "best" else "best"
    yield keyed("points", f"cloud.chain={other_chain}", Worth.SAVES)
    if cloud.chain != "best":
        quantise = str(not cloud.quantise).lower()
        yield keyed("points", f"cloud.quantise={quantise}", Worth.PROCESSING)
    else:
        yield keyed("points", "cloud.pfa=0.001", Worth.PROCESSING)


def _scaled(command: str, factors: dict[int, float]) -> Callable[[str], str]:
    """Function that multiplies numbers of the lines of a command, by their places."""

    def change(words: Sequence[str]) -> list[str]:
        scaled = [*words]
        for place, factor in factors.items():
            value = float(words[place]) * factor
            scaled[place] = f"{value:g}" if "." in words[place] or factor > 1 else f"{int(value)}"
        return scaled

    return lambda text: _with_lines(text, command, change)


def _set(command: str, values: dict[int, int]) -> Callable[[str], str]:
    """Function that replaces numbers of the lines of a command, by their places."""

    def change(words: Sequence[str]) -> list[str]:
        replaced = [*words]
        for place, value in values.items():
            replaced[place] = str(value)
        return replaced

    return lambda text: _with_lines(text, command, change)


def _with_lines(text: str, command: str, change: Callable[[Sequence[str]], list[str]]) -> str:
    """Text of a .cfg in which the lines of a command are changed, word by word."""

    def replace(line: re.Match[str]) -> str:
        try:
            return " ".join(change(line[0].split()))
        except (IndexError, ValueError):  # a line of another form, which reading refuses
            return line[0]

    return re.sub(rf"^{command}\b.*$", replace, text, flags=re.MULTILINE)
