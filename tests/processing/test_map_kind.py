"""Kinds of maps, and the names that configs and files have for them."""

import pytest

from radhar_cli.processing.map_kind import (
    DOPPLER_TIME_KINDS,
    MAP_KINDS,
    RTM,
    TREATMENTS,
    UNTREATED,
    MapKind,
    Transform,
    Treatment,
    treatment_of,
)


def test_names_are_those_that_configs_and_files_have() -> None:
    assert tuple(MAP_KINDS) == (
        "rtm",
        *("stft", "stft_denoised", "stft_compensated", "stft_compensated_denoised"),
        *("fsst", "fsst_denoised", "fsst_compensated", "fsst_compensated_denoised"),
    )


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


def test_a_treatment_has_a_name_of_its_own() -> None:
    assert [str(treatment) for treatment in TREATMENTS] == [
        "raw",
        "denoised",
        "compensated",
        "compensated_denoised",
    ]


def test_a_map_of_ones_own_shows_an_untreated_signal() -> None:
    assert treatment_of("my_denoised_map") == UNTREATED
    assert treatment_of("fsst_denoised") == Treatment(denoised=True)


def test_all_but_the_range_time_map_show_doppler() -> None:
    assert not RTM.is_doppler_time
    assert all(kind.is_doppler_time for kind in DOPPLER_TIME_KINDS)
