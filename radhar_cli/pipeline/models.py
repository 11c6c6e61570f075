"""Unpack a scene into the objects of the physics: the one place where keys and units are read."""

from collections.abc import Mapping
from math import radians

from radhar_cli.body.activities import Gait, Timing
from radhar_cli.body.pose import Body
from radhar_cli.config.experiment import Config
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scenario import Scene


def waveform_of(scene: Scene, config: Config) -> Waveform:
    """The waveform of a scene."""
    v = scene.values
    return Waveform(
        fc=v["radar.carrier_hz"],
        bandwidth=v["radar.bandwidth_hz"],
        chirp=v["radar.chirp_s"],
        adc_rate=v["radar.adc_rate_hz"],
        prf=v["radar.prf_hz"],
        duration=v["duration_s"],
        fft_length=config.processing.range_fft_length,
        centred=config.processing.range_reference == "centre",
        residual_video_phase=config.radar.residual_video_phase,
    )


def antennas_of(scene: Scene) -> Antennas:
    """The antennas of a scene."""
    v = scene.values
    return Antennas(
        tx=_vector(v, "radar.tx_m"),
        rx=_vector(v, "radar.rx_m"),
        gain=10 ** (v["radar.antenna_gain_dbi"] / 10),
        isolation_db=v["radar.antenna_isolation_db"],
    )


def wall_of(scene: Scene, config: Config) -> Wall | None:
    """The wall of a scene, if there is one."""
    v = scene.values
    if config.wall is None:
        return None
    return Wall(
        center=_vector(v, "wall.center_m"),
        size=_vector(v, "wall.size_m"),
        eps_r=v["wall.eps_r"],
        loss_tangent=v["wall.loss_tangent"],
        rays=config.wall.rays,
        fresnel=config.wall.fresnel,
    )


def body_of(scene: Scene) -> Body:
    """The person of a scene and what they do; numbers that the activity does not use are 0."""
    v = scene.values

    def angle(key: str) -> float:
        return radians(v.get(f"motion.{key}_deg", 0.0))

    def timing(key: str) -> float:
        return v.get(f"timing.{key}_s", 0.0)

    return Body(
        number=scene.activity.number,
        height=v["subject.height_m"],
        weight=v["subject.weight_kg"],
        start=(v["motion.range_m"], v["motion.cross_range_m"]),
        angle=angle("angle"),
        gait=Gait(
            frequency=v.get("motion.gait_hz", 0.0),
            thigh=angle("thigh"),
            calf=angle("calf"),
            arm=angle("arm"),
            turn=angle("turn"),
            speed=v.get("motion.speed_mps", 0.0),
        ),
        timing=Timing(
            seat_start=timing("seat_start"),
            seat_duration=timing("seat_duration"),
            rise_start=timing("rise_start"),
            rise_duration=timing("rise_duration"),
            walk_start=timing("walk_start"),
            walk_stop=timing("walk_stop"),
            sit_duration=timing("sit_duration"),
            fall_duration=timing("fall_duration"),
            blend=timing("blend"),
        ),
    )


def _vector(values: Mapping[str, float], key: str) -> tuple[float, float, float]:
    return values[f"{key}.0"], values[f"{key}.1"], values[f"{key}.2"]
