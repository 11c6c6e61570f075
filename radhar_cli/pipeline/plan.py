"""Which stages a request needs: model only what a scene requires.

Every stage names what it needs; a plan is the closure of the products asked for, in running order.
Nothing else runs: `run.py` walks the plan and has no other way to start a stage.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from radhar_cli.config.experiment import MAP_NAMES, Config

# In the order in which few of them are held at once: each follows the one it is made from, which
# is then done with.
SIGNALS = ("plain", "denoised", "compensated", "compensated_denoised")
# Numbers and small objects, which may be looked up after a run whoever read them.
KEPT = ("wall", "paths", "signal_power")


@dataclass(frozen=True)
class Stage:
    """One step of a recording's synthesis.

    Attributes:
        name: ``kind`` or ``kind:variant``.
        needs: the stages whose products it reads.
        does: one line for people.
    """

    name: str
    needs: tuple[str, ...]
    does: str

    @property
    def kind(self) -> str:
        return self.name.partition(":")[0]

    @property
    def variant(self) -> str:
        return self.name.partition(":")[2]


@dataclass(frozen=True)
class Plan:
    """The stages of one request, each after everything it needs.

    Attributes:
        stages: in running order.
        asked: the products that were asked for, which are kept.
    """

    stages: tuple[Stage, ...]
    asked: tuple[str, ...]

    def __contains__(self, name: str) -> bool:
        return any(stage.name == name for stage in self.stages)

    def wanted_by(self, name: str) -> tuple[str, ...]:
        """The stages that read this one's product; none where it is what was asked for."""
        return tuple(stage.name for stage in self.stages if name in stage.needs)

    @cached_property
    def done_with(self) -> dict[str, tuple[str, ...]]:
        """{stage: the intermediate products that nobody reads any more once it has run}."""
        last = {need: stage.name for stage in self.stages for need in stage.needs}
        kept = {*self.asked, *KEPT}
        return {
            stage.name: tuple(n for n in stage.needs if last[n] == stage.name and n not in kept)
            for stage in self.stages
        }


def signal_of(map_name: str) -> str:
    """Which of SIGNALS a Doppler-time map shows."""
    return map_name.partition("_")[2] or "plain"


def plan_images(config: Config) -> Plan:
    """The plan of a data set: levels and entropy of every map, those of one signal together."""
    maps = sorted(config.maps, key=lambda name: SIGNALS.index(signal_of(name)))
    return plan(config, [f"{kind}:{name}" for name in maps for kind in ("entropy", "levels")])


def plan(config: Config, products: Iterable[str]) -> Plan:
    """Return the stages that these products need, in running order."""
    graph = _graph(config)
    ordered: dict[str, Stage] = {}

    def visit(name: str) -> None:
        if name not in ordered:
            for need in graph[name].needs:
                visit(need)
            ordered[name] = graph[name]

    asked = tuple(products)
    for product in asked:
        visit(product)
    return Plan(tuple(ordered.values()), asked)


def _graph(config: Config) -> dict[str, Stage]:
    """Every stage there could be for this config."""
    stages = [*_scene_stages(config), *_echo_stages(config)]
    stages += [*_signal_stages(config), *_map_stages(config)]
    return {stage.name: stage for stage in stages}


def _scene_stages(config: Config) -> list[Stage]:
    walled = config.wall is not None
    return [
        Stage("wall", (), "chords and faces of every leg through the wall"),
        Stage(
            "paths",
            ("wall",) if walled else (),
            "delay and amplitude of the 13 scatterers",
        ),
        Stage("torso_track", ("paths",), "delay of the torso at every pulse"),
    ]


def _echo_stages(config: Config) -> list[Stage]:
    noisy = config.snr_db is not None
    powered = ("signal_power",) if noisy else ()
    after = ", after MTI" if config.processing.mti else ""
    if config.engine.kind == "cube":
        return [
            Stage("signal_power", ("paths",), "P_s, which the noise refers to"),
            Stage(
                "beat_cube",
                ("paths", *powered),
                "the whole beat matrix, MTI and range compression"
                + (", noise on every sample" if noisy else ""),
            ),
            Stage("signal:plain", ("beat_cube",), "slow-time signal: sum over the kept bins"),
            Stage("rtm", ("beat_cube",), "range power at the pulses shown"),
        ]
    return [
        Stage("echo", ("paths",), "closed-form echo: knots, table of the half-band sum"),
        Stage("signal_power", ("echo",), "P_s, which the noise refers to"),
        Stage("slow_time", ("echo",), f"slow-time signal of the paths{after}"),
        Stage("slow_time_noise", powered, f"receiver noise after compression and sum{after}"),
        Stage(
            "signal:plain",
            ("slow_time", *(("slow_time_noise",) if noisy else ())),
            "slow-time signal of paths and noise",
        ),
        Stage("range_noise", powered, "receiver noise of those range profiles"),
        Stage(
            "range_profiles",
            ("paths", *(("range_noise",) if noisy else ())),
            "range profiles at the pulses that the range-time map shows",
        ),
        Stage("rtm", ("range_profiles",), "power of the range profiles"),
    ]


def _signal_stages(config: Config) -> list[Stage]:
    del config
    return [
        Stage(
            "signal:compensated",
            ("signal:plain", "torso_track"),
            "bulk Doppler compensation",
        ),
        Stage("signal:denoised", ("signal:plain",), "Savitzky-Golay filter"),
        Stage(
            "signal:compensated_denoised",
            ("signal:compensated",),
            "Savitzky-Golay filter after compensation",
        ),
    ]


def _map_stages(config: Config) -> list[Stage]:
    own_length = config.processing.stft_fft_length is not None
    own_hop = config.processing.fsst_hop_pulses is not None
    stages = []
    for variant in SIGNALS:
        suffix = "" if variant == "plain" else f"_{variant}"
        spectrum = f"{'padded_spectrum' if own_length else 'spectrum'}:{variant}"
        of_fsst = f"{'fsst_spectrum' if own_hop else 'spectrum'}:{variant}"
        stages += [
            Stage(f"spectrum:{variant}", (f"signal:{variant}",), "windowed FFT of every frame"),
            Stage(
                f"padded_spectrum:{variant}",
                (f"signal:{variant}",),
                "windowed FFT of every frame, zero-padded to stft_fft_length",
            ),
            Stage(
                f"fsst_spectrum:{variant}",
                (f"signal:{variant}",),
                "windowed FFT of every frame, every fsst_hop_pulses",
            ),
        ]
        for name, need, does in (
            (f"stft{suffix}", spectrum, "power of the STFT"),
            (f"fsst{suffix}", of_fsst, "second transform, synchrosqueezing, power"),
        ):
            stages.append(Stage(name, (need,), does))
            stages.append(Stage(f"reduced:{name}", (need,), f"{does}; resized; entropy"))
    stages.append(Stage("reduced:rtm", ("rtm",), "range-time map, resized; entropy"))
    for name in MAP_NAMES:
        stages.append(Stage(f"entropy:{name}", (f"reduced:{name}",), "entropy of the power map"))
        stages.append(Stage(f"levels:{name}", (f"reduced:{name}",), "decibels, grey levels"))
    return stages
