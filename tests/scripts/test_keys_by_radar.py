"""Every key, with every radar and model of motion, has an effect, is refused, or is warned of."""

import keys_by_radar as script
import pytest

from radhar_cli.config.data_set import Config
from radhar_cli.errors import RadharError

# Of `radhar generate --recordings`, and of several radars, which a config of one has not.
ELSEWHERE = {"recordings", "radars", "other_radars"}


# What a reading of the code once found silent, and keys of every section.
SAMPLE = ["receiver.noise_figure_db", "radar.position_m", "processing.overlap_fraction"]
SAMPLE += [key for key in script.leaves()[::40] if not key.startswith(script.OF_PEOPLE)]


def test_keys_act_as_the_page_says() -> None:
    known, text = dict(script.fields(Config)), script.PAGE.read_text()
    for key in SAMPLE:
        found = {radar: script.outcome(radar, key, known[key]) for radar in script.RADARS}
        assert script._row(key, found) in text


@pytest.mark.slow
def test_every_key_acts_or_says_that_it_does_not() -> None:
    """And the page that says so is as `python scripts/keys_by_radar.py` writes it."""
    of_radars, of_motion = script.outcomes_of_radars(), script.outcomes_of_people()
    assert script.page(of_radars, of_motion) == script.PAGE.read_text()
    # What a reading of the code found silent.
    for radar in ("fmcw", "sfcw", "cw"):
        assert of_radars["receiver.noise_figure_db"][radar].word == "effect"
        assert of_radars["radar.position_m"][radar].word == "refused"
    for key in ("tx_m", "rx_m", "residual_video_phase"):
        assert of_radars[f"radar.{key}"]["board"].word == "refused"
    assert of_radars["processing.overlap_fraction"]["board"].word == "warned"
    assert of_radars["radar.waveform"]["board"].word == "refused"
    assert of_motion["motion.paper.gait_hz"]["human"].word == "warned"
    for found in (of_radars, of_motion):
        for key, row in found.items():
            assert "effect" in {one.word for one in row.values()} or key in ELSEWHERE


def test_every_key_of_the_schema_is_tried() -> None:
    leaves = set(script.leaves())
    for name in Config.model_fields.keys() - {"stream"}:  # which no radar changes
        assert any(key.split(".")[0] == name for key in leaves)
    assert {"radar.beam", "radar.beam.pan_deg", "wall.layers", "people"} <= leaves


def test_a_key_that_does_nothing_is_an_error() -> None:
    silent = {"radar.tx_m": {"board": script.Outcome("nothing", "0.7")}}
    with pytest.raises(RadharError, match=r"radar\.tx_m with board: nothing"):
        script.page(silent, {})
    acts = {"wall": {"fmcw": script.Outcome("warned, yet acts", "{}")}}
    with pytest.raises(RadharError, match="wall with fmcw: warned, yet acts"):
        script.page({}, acts)
