"""Products of maps: range-time and Doppler-time maps of signals, and their images."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple, TypeAlias

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.extensions import own_products
from radhar_cli.processing.cadence import cadence_map
from radhar_cli.processing.doppler_power import (
    DopplerPower,
    compute_fsst_power,
    compute_stft_power,
)
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.map_kind import CADENCE_KINDS, RTM, MapKind, Transform
from radhar_cli.processing.power_map import Axis, MapImage, PowerMap
from radhar_cli.processing.scale import Scale
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.images import (
    ImageForm,
    draw_doppler_image,
    draw_map,
    level_scale_of,
    scale_of,
)
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.signal import bins_name, signal_name
from radhar_cli.scene.scene import Scene

SINGLE_RANGE_DB = 70.0  # of images in float32, in which a pixel in 1e5 differs by a level
# Makes windows for a duration (s), pulses a second and a carrier (Hz).
MakeFrames: TypeAlias = Callable[[ProcessingConfig, float, float, float], Frames]
WINDOWS: tuple[tuple[str, MakeFrames, str], ...] = (
    ("frames", ProcessingConfig.make_frames, "STFT"),
    ("fsst_frames", ProcessingConfig.make_fsst_frames, "FSST"),
)


class DopplerTransform(NamedTuple):
    """Computation of the power of a Doppler-time map from a signal.

    Attributes:
        needs: names of its inputs: signal, windows, and of a gated map the gate.
        compute: computes the power of those, in double or (`single=True`) single precision.
        description: description of the power, for people.
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
        needs = (name, "image_scale")
        yield Product(image_name(name), needs, draw, f"its {_describe_image(config)}")
    for name, kind in CADENCE_KINDS.items():
        transform = doppler_transform(config, kind)
        if transform is not None:
            yield from _doppler_rows(config, kind, transform, is_held=name in config.maps)
            yield from _cadence_rows(config, name, kind)


def scale_products() -> Iterator[Product]:
    """Rows of the scales of images, and of frame maps, which are no masks."""
    for name, make, output in (
        ("image_scale", scale_of, "image"),
        ("level_scale", level_scale_of, "grey levels"),
    ):
        scale = partial(_make_scale, make=make)
        yield Product(name, ("scene",), scale, f"law from power to {output}")


def _make_scale(scene: Scene, make: Callable[[AnyConfig], Scale]) -> Scale:
    """Make a scale of images by the numbers that a scene has drawn."""
    return make(scene.config)


def window_products() -> Iterator[Product]:
    """Rows of the windows of the Doppler-time maps of one channel."""
    for name, make, transform in WINDOWS:
        windows = partial(make_windows, make=make)
        yield Product(name, ("scene", "waveform"), windows, f"of the {transform}")


def make_windows(scene: Scene, waveform: Waveform, make: MakeFrames) -> Frames:
    """Make the windows of a Doppler-time map of a recording."""
    return make(scene.config.processing, waveform.duration, waveform.prf, waveform.f0)


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
    """Rows of a Doppler-time map, in float64, and of its image, from float32 where that will do.

    The power behind the image is computed where it is read, block by block, or once and held for
    the cadences, too.
    """
    does = f"power of the {transform.description}"
    make = partial(make_doppler_map, compute=transform.compute)
    yield Product(str(kind), transform.needs, make, does, is_array=True)
    single = fits_single(config)
    compute = partial(transform.compute, single=single)
    if is_held:
        compute = partial(hold_power, compute=compute)
    does = f"the same{', in float32' * single}, {'held' if is_held else 'when read'}"
    yield Product(power_name(kind), transform.needs, compute, does)
    draw = partial(draw_doppler_image, form=ImageForm.of(config))
    needs = (power_name(kind), "image_scale")
    yield Product(image_name(str(kind)), needs, draw, f"its {_describe_image(config)}")


def _cadence_rows(config: AnyConfig, name: str, kind: MapKind) -> Iterator[Product]:
    """Rows of the cadences of a Doppler-time map, and of their image."""
    highest_hz = config.image.cadence_limit_hz
    make = partial(cadence_map, highest_hz=highest_hz)
    yield Product(name, (str(kind),), make, f"cadences of the {kind}", is_array=True)
    draw = partial(draw_cadences, form=ImageForm.of(config), highest_hz=highest_hz)
    needs, does = (power_name(kind), "image_scale"), f"their {_describe_image(config)}"
    yield Product(image_name(name), needs, draw, does)


def fits_single(config: AnyConfig) -> bool:
    """Whether images of Doppler-time maps may be made in float32.

    A mask compares cells with their neighbours, down to the noise, if there is any.
    """
    if config.engine.precision != "auto" or config.output.power:
        return False
    if config.image.kind == "cfar":
        return config.has_noise
    return config.image.dynamic_range_db <= SINGLE_RANGE_DB


def make_doppler_map(*inputs: Any, compute: Callable[..., DopplerPower]) -> PowerMap:
    """Make a Doppler-time map of the inputs of a transform."""
    return compute(*inputs).as_map()


def hold_power(*inputs: Any, compute: Callable[..., DopplerPower]) -> DopplerPower:
    """Compute the power of a Doppler-time map once, for all that is made of it."""
    return compute(*inputs).hold_power()


def draw_cadences(
    power: DopplerPower, scale: Scale, form: ImageForm, highest_hz: float
) -> MapImage:
    """Draw the cadence-velocity diagram of a Doppler-time map."""
    return draw_map(cadence_map(power.as_map(), highest_hz), scale, form)


def _describe_image(config: AnyConfig) -> str:
    return f"{'CFAR mask' if config.image.kind == 'cfar' else 'image'} and entropy"
