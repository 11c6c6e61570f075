"""A wall that lets nothing through leaves noise, and a line says so."""

import pytest

from radhar_cli.config.data_set import Config
from radhar_cli.scene.checks.warnings import config_warnings


@pytest.mark.parametrize(
    ("wall", "more", "said"),
    [
        ({"loss_tangent": 1.0}, {"radar": {"carrier_hz": 77e9}}, True),
        ({"loss_tangent": 1e6}, {}, True),
        ({"loss_tangent": 0.03}, {"radar": {"carrier_hz": 2e9, "bandwidth_hz": 5e8}}, False),
        ({"loss_tangent": 1e6}, {"snr_reference": "received"}, False),
        ({"loss_tangent": 1e6}, {"snr_db": None}, False),
    ],
)
def test_noise_alone_is_warned_of(
    wall: dict[str, float], more: dict[str, object], said: bool
) -> None:
    config = Config.model_validate({"wall": wall, "activities": ["walking"], **more})
    told = [line for line in config_warnings(config) if "noise alone" in line]
    assert bool(told) == said
