"""The settings of the sweep, each with its baseline for time and its exact data for error."""

import json
from dataclasses import dataclass
from functools import reduce
from operator import getitem

from radhar_cli.config.identity import resolved
from radhar_cli.config.number import nominal
from radhar_cli.config.schema import MAP_NAMES, Config, EngineConfig

BUDGETS = (-20, -30, -40, -50, -60, -70, -80, -100, -120)
SIZES = (64, 128, 256, 512)
CLUTTER = ("difference", "mean", "highpass", "none")
SEGMENTS = ("body.scatterers=segments", "body.shadowing=true")
WITHOUT_SHADOWS = ("body.scatterers=segments", "body.shadowing=false")
# What has a default by model, and is not of the motion itself.
KEPT = (
    "duration_s",
    "on_invalid",
    "radar.bandwidth_hz",
    "radar.prf_hz",
    "motion.range_m",
    "motion.angle_deg",
    "processing.window_s",
    "processing.window_fraction",
)
CUBE = ("engine.kind=cube",)
DIRECT = ("engine.kind=direct", f"engine.tolerance_db={EngineConfig().tolerance_db:g}")


@dataclass(frozen=True)
class Setting:
    """One row of the sweep. All overrides are dotted `key=value` pairs.

    Attributes:
        group: budget, precision, engine, image size, image kind, map or switch.
        name: as printed.
        overrides: the setting itself; its time is measured with them.
        compared: of the data whose error is measured: `overrides`, or for a switch, without it.
        exact: of the exact data that the error is relative to.
        baseline: of the run that the time is divided by, on the same scenes, interleaved.
        baseline_name: as printed.
        of_signal: whether it changes the signal, not a map alone.
        noisy: whether its errors are those of data with the config's noise.
    """

    group: str
    name: str
    overrides: tuple[str, ...]
    compared: tuple[str, ...]
    exact: tuple[str, ...]
    baseline: tuple[str, ...] = DIRECT
    baseline_name: str = "the default"
    of_signal: bool = True
    noisy: bool = False

    @property
    def is_default(self) -> bool:
        """Whether this is what a config without an `engine:` gets."""
        return self.group == "budget" and self.overrides == DIRECT


def budget(tolerance_db: float) -> tuple[str, ...]:
    """Overrides for a budget of the direct engine."""
    return ("engine.kind=direct", f"engine.tolerance_db={tolerance_db:g}")


def sweep(config: Config) -> list[Setting]:
    """The settings that make sense for a config."""
    return [*_engines(), *_images(config), *_switches(config)]


def _engines() -> list[Setting]:
    rows = [
        Setting("budget", f"{db} dB", budget(db), budget(db), CUBE)
        for db in sorted({*BUDGETS, round(EngineConfig().tolerance_db)}, reverse=True)
    ]
    double = (*DIRECT, "engine.precision=double")
    rows.append(Setting("precision", "double", double, double, CUBE))
    rows.append(Setting("engine", "cube", CUBE, CUBE, CUBE))
    return rows


def _images(config: Config) -> list[Setting]:
    rows = []
    for size in SIZES:
        sized = (*DIRECT, f"image.size_px={size}")
        rows.append(Setting("image size", f"{size} px", sized, sized, CUBE))
    kind = "cfar" if config.image.kind == "decibel" else "decibel"
    on = f"image.kind={kind}"
    rows.append(Setting("image kind", kind, (*DIRECT, on), (*DIRECT, on), (*CUBE, on)))
    for name in MAP_NAMES:
        one = f"maps=[{name}]"
        rows.append(Setting("map", name, (*DIRECT, one), (*DIRECT, one), (*CUBE, one)))
    return rows


def _switches(config: Config) -> list[Setting]:
    fsst, dense = "maps=[fsst]", "processing.fsst_hop_pulses=1"
    switches = [
        _switch(*_other_motion(config)),
        _switch(*_other_scatterers(config)),
        _over("shadowing", SEGMENTS, WITHOUT_SHADOWS, "segments without shadowing"),
        _gate(),
        *_clutter(config),
        _switch("room: 3 reflectors", "room.reflectors=3"),
        *_receiver(config),
        _switch("residual video phase", "radar.residual_video_phase=true"),
        Setting(
            "switch",
            "motion within the chirp",
            (*CUBE, "engine.motion_in_chirp=true"),
            CUBE,
            (*CUBE, "engine.motion_in_chirp=true"),
            CUBE,
            "the cube",
        ),
        _over("FSST at every sample", (fsst, dense), (fsst,), "the FSST at the STFT's hop", False),
    ]
    if config.wall is not None:
        switches += [
            _switch("refracted rays", "wall.rays=refracted"),
            _switch("Fresnel, perpendicular", "wall.fresnel=perpendicular"),
            _switch("Fresnel, parallel", "wall.fresnel=parallel"),
        ]
    return switches


def _other_motion(config: Config) -> tuple[str, ...]:
    """Name and overrides of the other model of motion; all else stays, whatever its defaults."""
    other = "paper" if config.motion.model == "human" else "human"
    kept = resolved(config)
    if config.processing.window_s is config.processing.window_fraction is None:
        duration, prf = nominal(config.duration_s), nominal(config.radar.prf_hz)
        pulses = config.processing.window_pulses(duration, prf, nominal(config.radar.carrier_hz))
        kept["processing"]["window_s"] = pulses / prf
    name = f"motion: {other} instead of {config.motion.model}"
    return (
        name,
        f"motion.model={other}",
        *(f"{key}={json.dumps(reduce(getitem, key.split('.'), kept))}" for key in KEPT),
    )


def _other_scatterers(config: Config) -> tuple[str, ...]:
    """Name and overrides of the other model of what scatters."""
    own = config.body.scatterers
    other = "points" if own == "segments" else "segments"
    return f"scatterers: {other} instead of {own}", f"body.scatterers={other}"


def _gate() -> Setting:
    """Sums of powers over a gate of range bins; maps of the STFT alone have it."""
    on, off = (
        ("maps=[stft]", "processing.doppler=gate"),
        ("maps=[stft]", "processing.doppler=half_band"),
    )
    return _over("doppler: gate instead of half_band", on, off, "the half_band's STFT", False)


def _clutter(config: Config) -> list[Setting]:
    """The other clutter filters; they give signals of other lengths, so images are compared."""
    own = config.processing.clutter
    return [
        _over(
            f"clutter: {other} instead of {own}",
            (f"processing.clutter={other}",),
            (f"processing.clutter={own}",),
            "the default",
            False,
        )
        for other in CLUTTER
        if other != own
    ]


def _receiver(config: Config) -> list[Setting]:
    """Noise that is not white, on the same white noise: no two engines draw the same."""
    prf = nominal(config.radar.prf_hz)
    impairments = {
        "noise corner at PRF/20": f"receiver.noise_corner_hz={prf / 20:g}",
        "interference line at PRF/8": f"receiver.lines=[{{doppler_hz: {prf / 8:g}}}]",
    }
    return [
        Setting("switch", name, (*DIRECT, on), DIRECT, (*DIRECT, on), noisy=True)
        for name, on in impairments.items()
    ]


def _over(
    name: str, on: tuple[str, ...], off: tuple[str, ...], off_name: str, of_signal: bool = True
) -> Setting:
    """A switch that is compared with something other than the default."""
    without, exact = (*DIRECT, *off), (*CUBE, *on)
    return Setting("switch", name, (*DIRECT, *on), without, exact, without, off_name, of_signal)


def _switch(name: str, *on: str) -> Setting:
    """Physics that is off by default: what it costs, and what is missed without it."""
    return Setting("switch", name, (*DIRECT, *on), DIRECT, (*CUBE, *on))
