"""The table of products: name, needs and function of all that can be made of a scene.

Order (paper, figure "Signal processing overflow"): canceller -> range compression -> [range-time
map] -> sum over the kept bins -> [compensation] -> [denoising] -> STFT or FSST. With
`processing.range_sum: gated` the sum comes last, over the powers of some bins.

    scene      what is simulated                     paths     delay and amplitude over time
    slow_time  noiseless, before the canceller       signal    what the Doppler maps show
    range_signals  of the gate's bins                range_profiles  what the range-time map shows
    <map>      PowerMap                              image:<map>  MapImage

Each module of this package has the rows of one kind of product, and the functions that make them,
which take values and can be called alone.
"""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import assert_never

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.radar import ArrayRadar, CwRadar, FmcwRadar, ImpulseRadar, SfcwRadar
from radhar_cli.errors import ConfigError
from radhar_cli.extensions import own_products
from radhar_cli.processing.map_kind import TREATMENTS, kind_of, treatment_of
from radhar_cli.scene.products.direct import direct_products
from radhar_cli.scene.products.exact import exact_products
from radhar_cli.scene.products.gated import gate_products, gated_direct_products
from radhar_cli.scene.products.impulse import impulse_products
from radhar_cli.scene.products.maps import image_name, map_products, window_products
from radhar_cli.scene.products.paths import scene_products
from radhar_cli.scene.products.plan import Plan, Product, plan
from radhar_cli.scene.products.receiver import receiver_products
from radhar_cli.scene.products.signal import keep_in_phase, signal_name, treatment_products

ONE_CHANNEL = ("antennas", "paths", "receiver")  # products that a board has for each channel


def plan_images(config: Config) -> Plan:
    """Plan the products of a data set: the image of every map, by signal, and what it stores.

    Raises:
        ConfigError: `output.products` names one that the radar or the engine does not make, or
            that is no array.
    """
    extensions = {product.name for product in own_products()}
    of_signals = [
        name for name in config.maps if kind_of(name) is not None and name not in extensions
    ]
    by_signal = sorted(of_signals, key=lambda name: TREATMENTS.index(treatment_of(name)))
    others = [name for name in config.maps if name not in of_signals]
    requested = [image_name(name) for name in (*by_signal, *others)]
    if config.has_error:
        requested.append("accuracy")
    requested += config.stored.values()
    if config.output.slow_time:
        requested.append(signal_name())
    if config.output.column_labels:
        requested.append("motions")
    table = products(config)
    storable = extensions | {name for name, product in table.items() if product.is_array}
    unknown = [name for name in config.output.products if config.stored[name] not in storable]
    if unknown:
        names = ", ".join(name for name in table if name in storable)
        right = f"should be arrays that this radar and engine make: {names}"
        raise ConfigError(f"output.products = {json.dumps(unknown)}: {right}")
    return plan(table, requested, ["scene"])


def products(config: Config) -> dict[str, Product]:
    """Collect every product that a scene of a config can have, {name: product}.

    Raises:
        ConfigError: a product of a user's own would replace one that a board does not have.
    """
    rows = (
        *scene_products(config),
        *treatment_products(config),
        *map_products(config),
        *_radar_products(config),
        *own_products(),
    )
    table = {row.name: row for row in rows}
    if isinstance(config.radar, CwRadar) and config.radar.output == "real":
        table["signal_iq"] = replace(table["signal"], name="signal_iq")
        table["signal"] = Product(
            "signal", ("signal_iq",), keep_in_phase, "in-phase channel", is_array=True
        )
    return table


def products_of_signals(config: AnyConfig) -> dict[str, Product]:
    """Collect every product that a recorded signal can have, {name: product}."""
    rows = (
        *treatment_products(config),
        *map_products(config),
        *gate_products(config),
        *own_products(),
    )
    return {row.name: row for row in rows}


def _radar_products(config: Config) -> Iterator[Product]:
    """Rows of the echo of the radar of a config."""
    match config.radar:
        case ArrayRadar():
            from radhar_cli.scene.products.board import board_products  # slow to import

            _refuse_products_of_one_channel()
            yield from board_products(config)
        case ImpulseRadar():
            yield from _channel_products(config)
            yield from impulse_products(config)
        case FmcwRadar() | SfcwRadar() | CwRadar():
            yield from _channel_products(config)
            yield from _engine_products(config)
        case _:
            assert_never(config.radar)


def _channel_products(config: Config) -> Iterator[Product]:
    """Rows of one channel, for either engine."""
    yield from window_products()
    yield from receiver_products(config)
    yield from gate_products(config)


def _engine_products(config: Config) -> Iterator[Product]:
    """Rows of the engine that makes beats: direct or exact."""
    if config.engine.kind != "direct":
        yield from exact_products(config)
        return
    yield from direct_products(config)
    if config.processing.range_sum == "gated":
        yield from gated_direct_products(config)


def _refuse_products_of_one_channel() -> None:
    """Raise ConfigError for a product of a user's own that a board does not use."""
    for product in own_products():
        if product.name in ONE_CHANNEL:
            raise ConfigError(
                f"product {product.name}: has no effect with radar.cfg or radar.frame; should "
                "be 'channels' or 'cube'"
            )
