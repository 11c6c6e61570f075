"""Clutter and gate: what cannot be is refused in words."""

import pytest
from pydantic import ValidationError

from radhar_cli.config import Config


def refused(**document: object) -> list[tuple[str, str]]:
    with pytest.raises(ValidationError) as error:
        Config.model_validate(document)
    return [(p.key, p.right) for p in error.value.errors()[0]["ctx"]["problems"]]


@pytest.mark.parametrize(
    ("highpass", "key"),
    [
        ({"cutoff_hz": 2500.0}, "cutoff_hz"),
        ({"cutoff_hz": 0.1}, "cutoff_hz"),
    ],
)
def test_a_cut_off_is_below_half_the_prf_and_above_what_float64_holds(highpass, key):
    """At 77 GHz and 5 kHz, PRF/2 is 4.74 m/s."""
    radar = {"prf_hz": 5000}
    ((found, right),) = refused(
        radar=radar, processing={"clutter": "highpass", "highpass": highpass}
    )
    assert found == f"processing.highpass.{key}"
    assert "below PRF/2 in every scene" in right
    assert Config(processing={"clutter": "mean", "highpass": highpass})  # which is not used


def test_the_lowest_drawable_prf_limits_the_cutoff():
    processing = {"clutter": "highpass", "highpass": {"cutoff_hz": 300.0}}
    assert Config(processing=processing)
    ((key, _),) = refused(radar={"prf_hz": {"uniform": [500, 5000]}}, processing=processing)
    assert key == "processing.highpass.cutoff_hz"


def test_a_gate_excludes_the_fsst():
    ((key, right),) = refused(processing={"range_sum": "gated"}, maps=["stft", "fsst_denoised"])
    assert key == "maps"
    assert "by their phase" in right


@pytest.mark.parametrize("gate_m", [4.0, [6.0, 8.0], [9.0, 10.0]])
def test_a_gate_must_lie_within_the_half_band(gate_m):
    """Of 7.49 m at 4 GHz."""
    processing = {"range_sum": "gated", "gate_m": gate_m}
    ((key, right),) = refused(radar={"bandwidth_hz": 4e9}, processing=processing)
    assert key == "processing.gate_m"
    assert "7.495 m" in right
    assert Config(processing={"gate_m": gate_m})  # which is not used


@pytest.mark.parametrize(
    ("processing", "maps"), [({"range_sum": "gated"}, "stft"), ({"clutter": "mean"}, "rtm")]
)
def test_recordings_whose_bins_no_memory_holds_are_refused(processing, maps):
    ((key, right),) = refused(
        processing=processing, maps=[maps], duration_s=500.0, motion={"model": "paper"}
    )
    assert key == f"processing.{next(iter(processing))}"
    assert "held at once" in right
