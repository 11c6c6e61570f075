"""Products of maps: range-time and Doppler-time maps of signals, and their images."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.extensions import own_products
from radhar_cli.processing.cadence import cadence_map
from radhar_cli.processing.doppler_power import (
    DopplerPower,
    compute_fsst_power,
    compute_stft_power,
)
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.map_kind import CADENCE_KINDS, RTM, MapKind, Transform
from radhar_cli.processing.power_map import Axis, MapImage, PowerMap
from radhar_cli.processing.scale import Scale
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene.assembly.processing import frames_of, fsst_frames_of
from radhar_cli.scene.products.images import (
    ImageForm,
    draw_doppler_image,
    draw_map,
    level_scale_of_scene,
    scale_of_scene,
)
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.signal import bins_name, signal_name
from radhar_cli.scene.scene import Scene

SINGLE_RANGE_DB = 70.0  # of images in float32, in which a pixel in 1e5 differs by a level


class DopplerTransform(NamedTuple):
    """How the power of a Doppler-time map is computed of a signal.

    Attributes:
        needs: names of its inputs: signal, windows, and of a gated map the gate.
        compute: computes the power of those, in double or (`single=True`) single precision.
        description: what the power is of, for people.
    """

    needs: tuple[str, ...]
    compute: Callable[..., DopplerPower]
    description: str


def power_name(kind: MapKind) -> str:
    """Name of the product that is the held power of a Doppler-time map."""
    return f"power:{kind}"


def image_name(map_name: str) -> str:
    """Name of the product that is the image of a map."""
    return f"image:{map_name}"


def map_products(config: AnyConfig) -> Iterator[Product]:
    """Rows of the maps of signals, those of a user's own, and their images."""
    rtm = partial(
        make_range_time_map,
        gain_power=config.processing.range_gain_power,
        has_sign=config.image.kind == "signed",
        limits_m=config.image.range_limits_m,
    )
    does = "power of the range profiles"
    yield Product(str(RTM), ("range_profiles",), rtm, does, is_array=True)
    yield from scale_products()
    draw = partial(draw_map, form=ImageForm.of(config))
    for name in (str(RTM), *(product.name for product in own_products())):
        yield Product(
            image_name(name), (name, "image_scale"), draw, f"its {_describe_image(config)}"
        )
    for name, kind in CADENCE_KINDS.items():
        transform = doppler_transform(config, kind)
        if transform is not None:
            yield from _doppler_rows(config, kind, transform, is_held=name in config.maps)
            yield from _cadence_rows(config, name, kind, transform)


def scale_products() -> Iterator[Product]:
    """Rows of the scales of images, and of frame maps, which are no masks."""
    yield Product("image_scale", ("scene",), scale_of_scene, "law from power to image")
    does = "law from power to grey levels"
    yield Product("level_scale", ("scene",), level_scale_of_scene, does)


def window_products() -> Iterator[Product]:
    """Rows of the windows of the Doppler-time maps of one channel."""
    needs = ("scene", "waveform")
    yield Product("frames", needs, make_stft_frames, "of the STFT")
    yield Product("fsst_frames", needs, make_fsst_frames, "of the FSST")


def make_stft_frames(scene: Scene, waveform: Waveform) -> Frames:
    """Make the windows of the STFT of a recording."""
    return frames_of(scene.config, waveform.duration, waveform.prf, waveform.f0)


def make_fsst_frames(scene: Scene, waveform: Waveform) -> Frames:
    """Make the windows of the FSST of a recording."""
    return fsst_frames_of(scene.config, waveform.duration, waveform.prf, waveform.f0)


def make_range_time_map(
    profiles: Signal,
    gain_power: float = 0.0,
    has_sign: bool = False,
    limits_m: tuple[float, float] | None = None,
) -> PowerMap:
    """Make the range-time map: the power of range profiles, summed over the channels.

    Args:
        profiles: range profiles [channel, bin, pulse].
        gain_power: exponent p of the gain (R/largest R)^p of the bins.
        has_sign: whether the map also has the real samples of the first channel.
        limits_m: nearest and farthest range of its image, m; None for all.
    """
    x, ranges = profiles.x, profiles.ranges
    assert ranges is not None
    if gain_power > 0 and ranges[-1] > 0:  # of the one bin at range 0 it is 1
        x = x * ((ranges / ranges[-1]) ** gain_power)[:, None]
    power = (x.real**2 + x.imag**2).sum(axis=0)
    real = x[0].real if has_sign else None
    rows = Axis("range", "m", ranges, profiles.range_step)
    columns = Axis("time", "s", profiles.t, 1 / profiles.prf)
    return PowerMap(power, rows, columns, real).within(limits_m)


def doppler_transform(config: AnyConfig, kind: MapKind) -> DopplerTransform | None:
    """Transform that a config makes a kind of map by; None where it has no such map.

    A gate adds up powers or magnitudes of range bins, which have no FSST.
    """
    processing, limits_mps = config.processing, config.image.doppler_limits_mps
    signal = signal_name(kind.treatment)
    is_gated = processing.range_sum == "gated"
    if kind.transform is Transform.FSST:
        if is_gated:
            return None
        compute: Callable[..., DopplerPower] = partial(
            compute_fsst_power, threshold=processing.fsst_threshold, limits_mps=limits_mps
        )
        return DopplerTransform((signal, "fsst_frames"), compute, "FSST")
    compute = partial(
        compute_stft_power, fft_length=processing.stft_fft_length, limits_mps=limits_mps
    )
    if not is_gated:
        return DopplerTransform((signal, "frames"), compute, "STFT")
    compute = partial(compute, sums_magnitudes=processing.gate_sum == "magnitude")
    summed = "magnitudes" if processing.gate_sum == "magnitude" else "powers"
    needs = (bins_name(kind.treatment), "frames", "gate")
    return DopplerTransform(needs, compute, f"STFTs, {summed} summed over the gate")


def _doppler_rows(
    config: AnyConfig, kind: MapKind, transform: DopplerTransform, is_held: bool
) -> Iterator[Product]:
    """Rows of a Doppler-time map, in float64, and of its image, from float32 where that will do."""
    does = f"power of the {transform.description}"
    make = partial(make_doppler_map, compute=transform.compute)
    yield Product(str(kind), transform.needs, make, does, is_array=True)
    single = fits_single(config)
    draw = partial(
        draw_doppler_map,
        compute=partial(transform.compute, single=single),
        form=ImageForm.of(config),
    )
    does += f"{', in float32' * single}; its {_describe_image(config)}"
    if is_held:  # for its cadences, too
        draw = partial(draw_held_power, form=ImageForm.of(config))
        yield Product(image_name(str(kind)), (power_name(kind), "image_scale"), draw, does)
        return
    yield Product(image_name(str(kind)), ("image_scale", *transform.needs), draw, does)


def _cadence_rows(
    config: AnyConfig, name: str, kind: MapKind, transform: DopplerTransform
) -> Iterator[Product]:
    """Rows of the cadences of a Doppler-time map, and of their image, which share its power."""
    highest_hz = config.image.cadence_limit_hz
    compute = partial(transform.compute, single=fits_single(config))
    hold = partial(hold_power, compute=compute)
    yield Product(power_name(kind), transform.needs, hold, f"power of the {kind}, held")
    make = partial(cadence_map, highest_hz=highest_hz)
    yield Product(name, (str(kind),), make, f"cadences of the {kind}", is_array=True)
    draw = partial(draw_cadences, form=ImageForm.of(config), highest_hz=highest_hz)
    does = f"their {_describe_image(config)}"
    yield Product(image_name(name), (power_name(kind), "image_scale"), draw, does)


def fits_single(config: AnyConfig) -> bool:
    """Whether images of Doppler-time maps may be made in float32.

    A mask compares cells with their neighbours, down to the noise, if there is any.
    """
    if config.engine.precision != "auto" or config.output.power:
        return False
    if config.image.kind == "cfar":
        return config.has_noise
    return config.image.dynamic_range_db <= SINGLE_RANGE_DB


def make_doppler_map(
    signal: Signal,
    frames: Frames,
    gate: Gate | None = None,
    *,
    compute: Callable[..., DopplerPower],
) -> PowerMap:
    """Make a Doppler-time map of a signal in float64.

    Args:
        signal: signal, or range bins of a gate.
        frames: windows.
        gate: range bins that each window adds up; None for a signal of one row.
        compute: computes the power.
    """
    return _compute(signal, frames, gate, compute).as_map()


def draw_doppler_map(
    scale: Scale,
    signal: Signal,
    frames: Frames,
    gate: Gate | None = None,
    *,
    compute: Callable[..., DopplerPower],
    form: ImageForm,
) -> MapImage:
    """Draw the image of a Doppler-time map of a signal, which is not held as a whole.

    Args:
        scale: law from power to levels.
        signal: signal, or range bins of a gate.
        frames: windows.
        gate: range bins that each window adds up; None for a signal of one row.
        compute: computes the power.
        form: size of the image, and whether it has decibels.
    """
    return draw_doppler_image(_compute(signal, frames, gate, compute), scale, form)


def hold_power(
    signal: Signal,
    frames: Frames,
    gate: Gate | None = None,
    *,
    compute: Callable[..., DopplerPower],
) -> DopplerPower:
    """Compute the power of a Doppler-time map once, for all that is made of it.

    Args:
        signal: signal, or range bins of a gate.
        frames: windows.
        gate: range bins that each window adds up; None for a signal of one row.
        compute: computes the power.
    """
    return _compute(signal, frames, gate, compute).hold_power()


def draw_held_power(power: DopplerPower, scale: Scale, form: ImageForm) -> MapImage:
    """Draw the image of a Doppler-time map whose power is held."""
    return draw_doppler_image(power, scale, form)


def draw_cadences(
    power: DopplerPower, scale: Scale, form: ImageForm, highest_hz: float
) -> MapImage:
    """Draw the cadence-velocity diagram of a Doppler-time map whose power is held."""
    return draw_map(cadence_map(power.as_map(), highest_hz), scale, form)


def _compute(
    signal: Signal, frames: Frames, gate: Gate | None, compute: Callable[..., DopplerPower]
) -> DopplerPower:
    """Compute the power of a signal, or of the range bins of a gate."""
    return compute(signal, frames) if gate is None else compute(signal, frames, gate)


def _describe_image(config: AnyConfig) -> str:
    return f"{'CFAR mask' if config.image.kind == 'cfar' else 'image'} and entropy"
