"""Kinds of maps, and the names that configs and files have for them."""

import pytest
from radhar_cli.config.schema import MAP_NAMES

from radhar_cli.processing.map_kind import (
    DOPPLER_TIME_KINDS,
    MAP_KINDS,
    RTM,
    UNTREATED,
    MapKind,
    Transform,
    Treatment,
)


def test_names_are_those_of_the_config_in_its_order() -> None:
    assert tuple(MAP_KINDS) == tuple(MAP_NAMES)


@pytest.mark.parametrize("name", MAP_KINDS)
def test_parse_undoes_str(name: str) -> None:
    assert str(MapKind.parse(name)) == name


def test_a_name_says_what_is_done() -> None:
    both = MapKind(Transform.FSST, Treatment(compensated=True, denoised=True))
    assert MapKind.parse("fsst_compensated_denoised") == both
    assert MapKind.parse("stft_denoised").treatment == Treatment(denoised=True)
    assert MapKind.parse("stft") == MapKind(Transform.STFT, UNTREATED)


@pytest.mark.parametrize("name", ["rtm_denoised", "stft_denoised_compensated", "range_doppler", ""])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="should be one of rtm, stft"):
        MapKind.parse(name)


def test_all_but_the_range_time_map_show_doppler() -> None:
    assert not RTM.is_doppler_time
    assert all(kind.is_doppler_time for kind in DOPPLER_TIME_KINDS)
