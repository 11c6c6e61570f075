"""Unpack a scene into the objects of the physics: keys and units of radar, wall, room, receiver."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from math import inf, log, radians, sqrt
from typing import TypeAlias, assert_never

import numpy as np

from radhar_cli.bodies.segment_paths import Body
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.number import nominal, support
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.config.radar import (
    BeamConfig,
    BoardRadar,
    CwRadar,
    FmcwRadar,
    ImpulseRadar,
    SfcwRadar,
)
from radhar_cli.config.room import DielectricConfig, LayerConfig
from radhar_cli.motion.paper.activities import PaperGait, Timing
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion
from radhar_cli.motion.reflectors import TONES, Reflectors
from radhar_cli.motion.segments import landmark_names, segments_between, thickness
from radhar_cli.numerics.randomness import NOISE, stream
from radhar_cli.numerics.rounding import half_up
from radhar_cli.processing import canceller
from radhar_cli.processing.cfar import CellAveraging
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.radar.detection import Detection
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.layers import Layer, Layers
from radhar_cli.radar.materials import Material, permittivity
from radhar_cli.radar.propagation import Aim, Antennas, boresight_axes
from radhar_cli.radar.room import FACES, Box, Face, Leg, names_of, reflected_legs
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.flicker import FlickerNoise
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.interference import InterferenceLine
from radhar_cli.receiver.noise import WhiteNoise
from radhar_cli.scene import Person, Scene, nominal_scene

Vector: TypeAlias = tuple[float, float, float]


def board_of(radar: BoardRadar[float], seconds: float = 0.0) -> Board:
    """Make the board of a `radar.cfg`, with the frames of so many seconds, at least one."""
    header, array = radar.header, radar.elements
    assert array is not None  # refused where the config is read
    frames = max(int(seconds / header.period_s + 1e-9), 1)
    return Board(
        array=array,
        start=header.start_hz,
        fc=header.carrier_hz,
        slope=header.slope_hz,
        adc_rate=header.adc_rate_hz,
        samples=header.samples,
        slot=header.slot_s,
        order=header.order,
        receivers=header.receivers,
        loops=header.loops,
        frames=min(frames, header.frames or frames),
        period=header.period_s,
        position=radar.position_m,
        yaw=radians(radar.yaw_deg),
        tilt=radians(radar.tilt_deg),
        half_power_deg=radar.half_power_deg,
        half_wavelength=radar.half_wavelength_m,
        gain=10 ** (radar.antenna_gain_dbi / 10),
        backoff_db=header.profile.backoff_db,
    )


def detection_of(radar: BoardRadar, processing: ProcessingConfig) -> Detection:
    """Read detection from the .cfg, as far as the board heeds it; clutter is the config's."""
    detection = replace(radar.header.detection, remove_mean=processing.clutter == "mean")
    device = DEVICES.get(str(radar.device))
    return detection if device is None or device.heeds_limits else detection.without_limits()


def waveform_of(scene: Scene) -> Waveform:
    """Make the waveform of a scene."""
    radar, processing = scene.radar, scene.config.processing
    kind: Callable[..., Waveform] = Waveform
    residual_video_phase, centred = False, processing.range_reference == "centre"
    match radar:
        case BoardRadar():
            return board_of(radar, scene.seconds).waveform
        case ImpulseRadar():
            kind = partial(Impulse, profile=radar.profile_m, samples=radar.profile_samples)
        case CwRadar():
            centred = False
        case FmcwRadar() | SfcwRadar():
            residual_video_phase = radar.residual_video_phase
        case _:
            assert_never(radar)
    return kind(
        fc=radar.carrier_hz,
        bandwidth=radar.bandwidth_hz,
        chirp=radar.chirp_s,
        adc_rate=radar.adc_rate_hz,
        prf=radar.prf_hz,
        duration=scene.seconds,
        fft_length=processing.range_fft_length,
        centred=centred,
        residual_video_phase=residual_video_phase,
    )


def antennas_of(scene: Scene) -> Antennas:
    """Make the antennas of a scene; for a board those of its first channel."""
    radar = scene.radar
    if isinstance(radar, BoardRadar):
        board = board_of(radar)
        return board.antennas(*board.pairs[0])
    return Antennas(
        tx=radar.tx_m,
        rx=radar.rx_m,
        gain=10 ** (radar.antenna_gain_dbi / 10),
        isolation_db=radar.antenna_isolation_db,
        aim=None if radar.beam is None else aim_of(radar.beam, radar.tx_m, radar.rx_m),
    )


def wall_of(scene: Scene) -> Wall | None:
    """Make the wall of a scene, or None where it has none.

    Layers are one slab of their mean refractive index, in the middle of the band, besides.
    """
    radar, wall = scene.radar, scene.wall
    if wall is None:
        return None
    depth, width, height = wall.size_m
    eps_r, loss_tangent = wall.eps_r, wall.loss_tangent
    if wall.layers is None:
        assert depth is not None  # refused where the config is read
        layers: tuple[Layer, ...] = (Layer(depth, eps_r * (1 - 1j * loss_tangent)),)
    else:
        layers = tuple(map(_layer, wall.layers))
        depth = sum(layer.thickness for layer in layers)
        middle = np.array(radar.carrier_hz + radar.bandwidth_hz / 2)
        n = sum(layer.thickness * np.sqrt(layer.eps(middle)) for layer in layers) / depth
        eps = complex(n * n)
        eps_r, loss_tangent = eps.real, -eps.imag / eps.real
    exact = Layers(layers, parallel=radar.polarisation == "horizontal")
    return Wall(
        center=wall.center_m,
        size=(depth, width, height),
        eps_r=eps_r,
        loss_tangent=loss_tangent,
        rays=wall.rays,
        fresnel=wall.fresnel,
        layers=exact if wall.echoes == "exact" else None,
    )


def _layer(layer: LayerConfig[float]) -> Layer:
    """Layer of a wall: of a material, or of a permittivity."""
    if layer.material is not None:
        return Layer(layer.thickness_m, layer.material)
    assert layer.eps_r is not None  # refused where the config is read
    return Layer(layer.thickness_m, layer.eps_r * (1 - 1j * layer.loss_tangent))


def motion_of(person: Person) -> Motion:
    """Make a person's motion: by the activity's own function, its files, or the model of `motion`.

    Raises:
        MotionFileError: a motion file cannot be used.
    """
    if person.activity.motion is not None:
        return person.activity.motion(person)
    if person.config.files_of(person.activity) is not None:
        from radhar_cli.assembly.motion_files import file_motion

        return file_motion(person)
    if person.motion.model == "human":
        from radhar_cli.assembly.people import human_motion  # slow to import

        return human_motion(person)
    return _paper_body(person)


def moving(person: Person) -> Motion:
    """`motion_of`, built once a person; its positions are remembered."""
    if "motion" not in person.held:
        person.held["motion"] = cache_motion(motion_of(person))
    found: Motion = person.held["motion"]
    return found


def body_of(person: Person, motion: Motion) -> Body:
    """Make the body of a person, with the segments that the joints of their motion have."""
    whole = motion.motion if isinstance(motion, ScattererSubset) else motion
    stature, weight = person.subject.height_m, person.subject.weight_kg
    return Body(whole, segments_between(landmark_names(whole)), stature, thickness(stature, weight))


def aim_of(beam: BeamConfig[float], tx: Vector, rx: Vector) -> Aim:
    """Make the aim of two antennas with a beam of -min(12 (az/bw)^2 + 12 (el/bw)^2, most_db) dB.

    Args:
        beam: widths, boresight and least gain.
        tx: place of the transmitter, m.
        rx: place of the receiver, m.
    """
    x, y, z = (np.array(tx) + np.array(rx)) / 2
    half = sqrt(log(2) * 20 / (6 * log(10))) / 2  # -3 dB there, and not a half
    widths = half * beam.azimuth_deg, half * beam.elevation_deg
    axes = boresight_axes(radians(beam.pan_deg), radians(beam.tilt_deg))
    return Aim((x, y, z), axes, widths, 10 ** (-beam.most_db / 10), of_each=True)


def box_of(scene: Scene) -> Box | None:
    """Box of the faces of a scene's room; None without faces, or for a floor alone."""
    box = scene.room.box_m
    return None if scene.room.faces is None or box is None else Box(box.x, box.y, box.height)


def ways_of(scene: Scene) -> list[tuple[Leg, Leg]]:
    """Ways of the transmitter's and the receiver's leg by faces of the room, or by a back wall."""
    radar, room = scene.radar, scene.room
    if room.back_wall_m is not None:
        reflection = 10 ** (room.back_wall_reflection_db / 20)
        way = Leg((Face("back", FACES["back"], room.back_wall_m, constant_reflection=reflection),))
        return [(way, way)]
    if room.faces is None:
        return []
    box, faces = box_of(scene), []
    face_offsets = {"floor": 0.0} if box is None else box.face_offsets
    normal = FACES["floor" if radar.polarisation == "vertical" else "left"]
    for name, material in room.faces.given.items():
        parallel, reflection_coefficient = FACES[name] != normal, None
        if material == "metal":
            reflection_coefficient = -1.0 if parallel else 1.0
        eps = _permittivity(material, radar.carrier_hz + radar.bandwidth_hz / 2)
        faces.append(
            Face(name, FACES[name], face_offsets[name], eps, parallel, reflection_coefficient)
        )
    outside = min(p[0] for p in antennas_of(scene).places) < face_offsets.get("front", -inf)
    return list(reflected_legs(faces, scene.config.room.order, outside))


def kinds_of(config: Config) -> list[str]:
    """Names of the ways by which people are seen, as "floor/-", the straight one, "-/-", first."""
    scene = nominal_scene(config, config.chosen_activities[0])
    return ["-/-", *map(names_of, ways_of(scene))]


def _permittivity(material: Material | DielectricConfig[float], frequency: float) -> complex:
    if isinstance(material, str):
        return complex(permittivity(material, np.array(frequency)))
    return complex(material.eps_r * (1 - 1j * material.loss_tangent))


def reflectors_of(scene: Scene) -> Reflectors | None:
    """Make the reflectors that stand in the room of a scene; None where there are none."""
    each, antennas = scene.room.reflectors, antennas_of(scene)
    if not each:
        return None
    rng = noise_stream(scene, "room.reflectors")
    return Reflectors(
        places=np.array([one.position_m for one in each]),
        rcs=10 ** (np.array([one.rcs_dbsm for one in each]) / 10),
        sd=np.array([one.residual_m for one in each]),
        fastest=np.array([one.highest_hz for one in each]),
        fractions=rng.random((len(each), TONES)),
        phases=rng.random((len(each), TONES)),
        towards=(np.array(antennas.tx) + np.array(antennas.rx)) / 2,
    )


def impairments_of(scene: Scene, noise: WhiteNoise, w: Waveform) -> tuple[Impairment, ...]:
    """Make the impairments that a receiver adds to white noise.

    Coloured noise is the channel's own, as white noise is. Interference comes from outside: tones
    are the same in all channels, phases included.
    """
    receiver, impairments = scene.receiver, list[Impairment]()
    corner, slope = receiver.noise_corner_hz, receiver.noise_slope_db
    if corner > 0:
        impairments.append(FlickerNoise(noise.sigma, noise.stream, corner, slope))
    of_scene = partial(noise_stream, scene)
    for number, tone in enumerate(receiver.tones):
        line = noise.sigma * 10 ** (tone.level_db / 20), tone.doppler_hz, w
        times = tone.on_s, tone.off_s
        impairments.append(
            InterferenceLine(*line, of_scene, f"line {number}", *times, tone.both_sides)
        )
    return tuple(impairments)


def _paper_body(person: Person) -> PaperBody:
    subject, motion, timing = person.subject, person.motion, person.timing
    return PaperBody(
        activity=person.activity.slug,
        height=subject.height_m,
        weight=subject.weight_kg,
        start=(motion.range_m, motion.cross_range_m),
        angle=radians(motion.angle_deg),
        gait=PaperGait(
            frequency=motion.paper.gait_hz,
            thigh=radians(motion.paper.thigh_deg),
            calf=radians(motion.paper.calf_deg),
            arm=radians(motion.paper.arm_deg),
            turn=radians(motion.rotating.turn_deg),
            speed=motion.walking.speed_mps,
        ),
        timing=Timing(**{one.name: getattr(timing, f"{one.name}_s") for one in fields(Timing)}),
    )


def canceller_of(config: AnyConfig, prf: float) -> canceller.Canceller:
    """Make the canceller of a config, for `prf` pulses per second."""
    highpass = config.processing.highpass
    match config.processing.clutter:
        case "difference":
            return canceller.FIRST_DIFFERENCE
        case "mean":
            return canceller.MeanRemoval()
        case "none":
            return canceller.NO_CANCELLER
    return canceller.HighPass(
        highpass.order, highpass.cutoff(prf), highpass.zero_phase, highpass.remove_mean
    )


def max_samples(config: AnyConfig) -> int:
    """Length of the longest slow-time signal after the canceller that a config draws."""
    pulses = half_up(support(config.duration_s)[1], support(config.radar.prf_hz)[1])
    return pulses - 1 if config.processing.clutter == "difference" else pulses


def cfar_of(config: AnyConfig) -> CellAveraging:
    """Make the CFAR of a config; numbers that are still to be drawn are taken at their middle."""
    cfar = config.image.cfar
    return CellAveraging(
        guard=cfar.guard,
        training=cfar.training,
        pfa=nominal(cfar.pfa),
        decibel=cfar.domain == "decibel",
        floor_db=nominal(cfar.floor_db),
        wrap=cfar.edges == "wrap",
    )


def frames_of(config: AnyConfig, duration: float, prf: float, f0: float) -> Frames:
    """Make the windows of the STFT of a recording.

    Args:
        config: length and overlap of the windows.
        duration: duration of the recording, s.
        prf: pulses per second.
        f0: frequency that Dopplers refer to, Hz, from which a default length follows.
    """
    processing = config.processing
    length = processing.window_pulses(duration, prf, f0)
    return Frames.of(length, processing.overlap_fraction)


def fsst_frames_of(config: AnyConfig, duration: float, prf: float, f0: float) -> Frames:
    """Make the windows of the FSST: `frames_of`, with a hop of its own if the config has one."""
    frames, hop = frames_of(config, duration, prf, f0), config.processing.fsst_hop_pulses
    return frames if hop is None else Frames(frames.length, hop)


def channel_of(scene: Scene, antennas: Antennas) -> str:
    """Name of a receive channel: "" for the antennas of the config, else the antennas' numbers."""
    if antennas == antennas_of(scene):
        return ""
    numbers = (*antennas.tx, *antennas.rx, antennas.gain, antennas.isolation_db)
    return " ".join(str(float(number)) for number in numbers)


def noise_stream(scene: Scene, name: str, channel: object = "") -> np.random.Generator:
    """Random stream of a scene's noise.

    Args:
        scene: the scene, whose seed, class and index name the stream.
        name: what the noise is.
        channel: name of the receive channel (`channel_of`).
    """
    key = (scene.activity.index, scene.index)
    name = f"{name} channel {channel}" if channel else name
    return stream(scene.config.seed, NOISE, *key, name=name)
