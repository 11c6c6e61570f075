"""Scenes of the sweep; settings, each with a baseline for time and exact data for error."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.engine import EngineConfig
from radhar_cli.config.number import nominal
from radhar_cli.config.radar import BoardRadar
from radhar_cli.config.room import WallConfig
from radhar_cli.scene import Scene
from radhar_cli.scene_checks.drawing import draw_valid_scene

# Of what differs most: a standing person's arms, a walk, a fall.
QUICK = ("punching", "walking", "walking_to_falling")
BUDGETS = (-20, -30, -40, -50, -60, -70, -80, -100, -120)
CLUTTER = ("difference", "mean", "highpass", "none")
CUBE = ("engine.kind=cube",)
DIRECT = ("engine.kind=direct", f"engine.tolerance_db={EngineConfig().tolerance_db:g}")


@dataclass(frozen=True)
class Scenes:
    """Scenes of the sweep: samples 0 of the activities of a config file."""

    path: Path  # config file
    overrides: tuple[str, ...]  # of the command line; those of a setting come after them
    quick: bool  # whether three activities are enough

    def config(self, further: Sequence[str] = ()) -> Config:
        """Config under further overrides.

        Raises:
            ConfigError: the overrides do not fit it.
        """
        return _config(self.path, (*self.overrides, *further))

    def names(self) -> list[str]:
        """Slugs of the activities; of three where `quick`."""
        slugs = [activity.slug for activity in self.config().chosen_activities]
        quick_slugs = [slug for slug in slugs if slug in QUICK] or slugs[: len(QUICK)]
        return quick_slugs if self.quick else slugs

    def draw(self, slug: str, config: Config) -> Scene:
        """Scene of sample 0 of an activity; settings of engine, maps and image do not change it."""
        activity = next(a for a in config.chosen_activities if a.slug == slug)
        return draw_valid_scene(config, activity, 0)[0]


@cache
def _config(path: Path, overrides: tuple[str, ...]) -> Config:
    return load_config(path, overrides)


@dataclass(frozen=True)
class Setting:
    """One row of the sweep; all overrides are dotted `key=value` pairs."""

    group: str  # budget, precision, engine or switch
    name: str  # as printed
    overrides: tuple[str, ...]  # the setting itself; its time is measured with them
    # of the data whose error is measured: `overrides`, or for a switch, without it
    compared: tuple[str, ...]
    exact: tuple[str, ...]  # of the exact data that the error is relative to
    # of the run that the time is divided by, on the same scenes, interleaved
    baseline: tuple[str, ...] = DIRECT
    baseline_name: str = "the default"  # as printed
    noisy: bool = False  # whether its errors are those of data with the config's noise

    @property
    def is_default(self) -> bool:
        """Whether this is what a config without an `engine:` gets."""
        return self.group == "budget" and self.overrides == DIRECT


def sweep(config: Config) -> list[Setting]:
    """Settings of the sweep that make sense for a config."""
    return [*_engine_settings(), *_switch_settings(config)]


def _engine_settings() -> list[Setting]:
    budgets = sorted({*BUDGETS, round(EngineConfig().tolerance_db)}, reverse=True)
    overrides: dict[tuple[str, str], tuple[str, ...]] = {
        ("budget", f"{db} dB"): ("engine.kind=direct", f"engine.tolerance_db={db:g}")
        for db in budgets
    }
    overrides["precision", "double"] = (*DIRECT, "engine.precision=double")
    overrides["engine", "cube"] = CUBE
    return [
        Setting(*group_and_name, setting, setting, CUBE)
        for group_and_name, setting in overrides.items()
    ]


CORRIDOR = (
    "room.box_m={x: [-2, 1000], y: [-4, 4], height: 3}",
    "room.faces={floor: concrete, ceiling: concrete, left: concrete, right: concrete}",
)
BEAM = "radar.beam={azimuth_deg: 70, elevation_deg: 30}"


def _switch_settings(config: Config) -> list[Setting]:
    """Settings of physics and transforms that a config may leave out."""
    switches = _common_switches(config)
    if config.motion.model == "human" and not config.people:
        switches.append(switch_off_by_default("another person, who walks", "people=[{}]"))
    if not isinstance(config.radar, BoardRadar) and config.radar.beam is None:
        switches.append(switch_off_by_default("beams of 70 x 30 degrees", BEAM))
    if config.room.faces is None and config.room.back_wall_m is None:
        switches += _room_switches()
    if config.wall is not None:
        switches += _wall_switches(config.wall)
    return switches


def _common_switches(config: Config) -> list[Setting]:
    """Settings that every config may have."""
    body_kind, clutter = config.body.scatterers, config.processing.clutter
    other_body_kind = "points" if body_kind == "segments" else "segments"
    dense, in_chirp = "processing.fsst_hop_pulses=1", (*CUBE, "engine.motion_in_chirp=true")
    bodies = [f"body.scatterers=segments body.shadowing={on}".split() for on in ("true", "false")]
    gates = [("maps=[stft]", f"processing.range_sum={kind}") for kind in ("gated", "coherent")]
    prf = nominal(config.radar.prf_hz)
    noises = {  # on the same white noise: no two engines draw the same
        "noise corner at PRF/20": (*DIRECT, f"receiver.noise_corner_hz={prf / 20:g}"),
        "interference line at PRF/8": (*DIRECT, f"receiver.tones=[{{doppler_hz: {prf / 8:g}}}]"),
    }
    return [
        switch_off_by_default(
            f"scatterers: {other_body_kind} instead of {body_kind}",
            f"body.scatterers={other_body_kind}",
        ),
        switch_with_baseline("shadowing", bodies, "segments without shadowing"),
        switch_with_baseline("range_sum: gated instead of coherent", gates, "the coherent STFT"),
        *(_clutter_switch(kind, clutter) for kind in CLUTTER if kind != clutter),
        switch_off_by_default("room: 3 reflectors", "room.reflectors=[{}, {}, {}]"),
        *(Setting("switch", name, on, DIRECT, on, noisy=True) for name, on in noises.items()),
        switch_off_by_default("residual video phase", "radar.residual_video_phase=true"),
        Setting("switch", "motion within the chirp", in_chirp, CUBE, in_chirp, CUBE, "the cube"),
        switch_with_baseline(
            "FSST at every sample",
            [("maps=[fsst]", dense), ("maps=[fsst]",)],
            "the FSST at the STFT's hop",
        ),
    ]


def _clutter_switch(kind: str, default: str) -> Setting:
    """Setting of another canceller than that of the config."""
    overrides = [(f"processing.clutter={canceller}",) for canceller in (kind, default)]
    return switch_with_baseline(f"clutter: {kind} instead of {default}", overrides, "the default")


def _room_switches() -> list[Setting]:
    """Settings of rooms, for a config without one."""
    return [
        switch_off_by_default("a corridor of concrete, 8 m wide", *CORRIDOR),
        switch_off_by_default("the corridor with two bounces", *CORRIDOR, "room.order=2"),
        switch_with_baseline(
            "the same seen by beams", [(*CORRIDOR, BEAM), (BEAM,)], "beams in the open"
        ),
    ]


def _wall_switches(wall: WallConfig) -> list[Setting]:
    """Settings of rays and reflections, for a config with a wall."""
    on, off = ((*CUBE, "wall.rays=plane", f"wall.echoes={kind}") for kind in ("exact", "none"))
    return [
        Setting("switch", "reflections inside the wall", on, off, on, off, "the cube"),
        *(
            switch_off_by_default(f"{rays} rays", f"wall.rays={rays}")
            for rays in ("straight", "plane", "refracted")
            if rays != wall.rays
        ),
        switch_off_by_default("Fresnel, perpendicular", "wall.fresnel=perpendicular"),
        switch_off_by_default("Fresnel, parallel", "wall.fresnel=parallel"),
    ]


def switch_with_baseline(name: str, on_off: Sequence[Sequence[str]], off_name: str) -> Setting:
    """Switch that is compared with something other than the default.

    Args:
        name: name of the setting.
        on_off: overrides with the switch on, and without it.
        off_name: name of the baseline.
    """
    on, off = on_off
    without, exact = (*DIRECT, *off), (*CUBE, *on)
    return Setting("switch", name, (*DIRECT, *on), without, exact, without, off_name)


def switch_off_by_default(name: str, *on: str) -> Setting:
    """Switch of physics that is off by default: its cost, and the error of leaving it out."""
    return Setting("switch", name, (*DIRECT, *on), DIRECT, (*CUBE, *on))
