"""`radhar tradeoff`: what it measures and writes."""

import csv
import json

import pytest
from helpers.listener import Listener
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.scene import scene_numbers
from radhar_cli.tradeoff import study
from radhar_cli.tradeoff.settings import Scenes, sweep

CONFIG = """
motion: {model: paper}
activities: [stationary, punching, walking]
duration_s: 1.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 1000, adc_rate_hz: 1e6}
maps: [stft]
image: {size_px: 48, cfar: {guard: [2, 1], training: [10, 5]}}
"""
TRIED = (
    *("-40 dB", "-60 dB", "-80 dB", "-100 dB", "-120 dB", "cube", "double"),
    *("residual video phase", "FSST at every sample", "refracted rays"),
    *(
        "scatterers: segments instead of points",
        "shadowing",
        "range_sum: gated instead of coherent",
    ),
    *("clutter: mean instead of difference", "room: 3 reflectors"),
    *("noise corner at PRF/20", "interference line at PRF/8"),
)


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text(CONFIG)
    return path


def tried(config):
    return [setting for setting in sweep(config) if setting.name in TRIED]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A config and its finished sweep, a few settings of each kind; who changes it takes a copy."""
    place = tmp_path_factory.mktemp("sweep")
    path = place / "c.yaml"
    path.write_text(CONFIG)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "sweep", tried)
        patch.setattr("radhar_cli.tradeoff.measures.SECONDS", 0.0)
        outcome = tradeoff(path, place / "out")
    assert outcome.exit_code == 0, outcome.output
    return path, place / "out"


def tradeoff(config, out, *more):
    return CliRunner().invoke(
        program(), ["tradeoff", str(config), "-o", str(out), "--quick", *more]
    )


def rows_of(out):
    rows = json.loads((out / "tradeoff.json").read_text())["settings"]
    return {row["setting"]: row for row in rows}


class TestCommand:
    def test_writes_three_files_that_agree(self, done):
        config, out = done
        rows = rows_of(out)
        with (out / "tradeoff.csv").open() as file:
            table = list(csv.DictReader(file))
        assert [row["setting"] for row in table] == list(rows)
        text = (out / "tradeoff.md").read_text()
        assert all(name in text for name in rows)
        assert str(config) in text
        assert {path.name for path in out.iterdir()} == {
            f"tradeoff.{x}" for x in ("csv", "json", "md")
        }

    def test_numbers_are_what_they_should_be(self, done):
        rows = rows_of(done[1])
        for db in (-40, -60, -80, -100, -120):
            row = rows[f"{db} dB"]
            assert row["signal_error_db"] < db
            assert row["time_ratio"] > 0
            assert row["refused"] == 0
        assert rows["-40 dB"]["signal_error_db"] > rows["-120 dB"]["signal_error_db"]
        assert rows["-40 dB"]["ssim"] <= rows["-120 dB"]["ssim"] <= 1
        cube = rows["cube"]
        assert cube["exact"]
        assert cube["signal_error_db"] is None
        assert cube["pixels_changed"] == 0
        assert cube["time_ratio"] > 0
        assert rows["double"]["measured_error_db"] < -80
        assert sum(row["default"] for row in rows.values()) == 1

    def test_a_switch_shows_what_is_missed_without_it(self, done):
        rows = rows_of(done[1])
        assert "refracted rays" not in rows  # no wall, no rays through it
        for name, signal in (
            ("residual video phase", (-80, 0)),
            ("FSST at every sample", (-300, -60)),
            ("scatterers: segments instead of points", (-10, 20)),
            ("shadowing", (-60, -10)),
            ("range_sum: gated instead of coherent", (-300, -60)),  # the coherent sum stays
            ("room: 3 reflectors", (-80, 0)),
            ("noise corner at PRF/20", (-80, 0)),  # the same white noise on both sides
            ("interference line at PRF/8", (-80, 0)),
        ):
            assert signal[0] < rows[name]["signal_error_db"] < signal[1], name
            assert rows[name]["refused"] == 0
        mean = rows["clutter: mean instead of difference"]
        assert mean["signal_error_db"] is None  # one pulse more: nothing to subtract
        dense = rows["FSST at every sample"]
        assert max(dense["ssim"], mean["ssim"]) < 0.999
        assert dense["time_over"] == "the FSST at the STFT's hop"
        assert rows["range_sum: gated instead of coherent"]["pixels_changed"] > 0.1


class TestSettings:
    def scenes(self, config, *more):
        return Scenes(config, more, quick=False)

    def test_every_setting_is_a_config(self, config):
        for more in ((), ("wall={}",)):
            scenes = self.scenes(config, *more)
            for setting in sweep(scenes.config()):
                for overrides in (
                    setting.overrides,
                    setting.compared,
                    setting.exact,
                    setting.baseline,
                ):
                    assert scenes.config(overrides)

    def test_one_that_the_config_forbids_is_left_out_and_named(self, config):
        """A high-pass above PRF/2 cannot be, the other settings can."""
        listener = Listener()
        scenes = self.scenes(config, "processing.highpass.cutoff_hz=600")
        possible = study.allowed_settings(scenes, listener)
        assert not any("highpass" in setting.name for setting in possible)
        (message,) = listener.messages
        assert "processing.highpass" in message

    def test_names_are_told_apart_and_one_is_the_default(self, config):
        settings = sweep(self.scenes(config, "wall={}").config())
        assert len({(s.group, s.name) for s in settings}) == len(settings)
        assert sum(s.is_default for s in settings) == 1

    def test_scenes_do_not_depend_on_the_setting(self, config):
        scenes = self.scenes(config)
        usual = scene_numbers(scenes.draw("walking", scenes.config()))
        for setting in sweep(scenes.config()):
            scene = scenes.draw("walking", scenes.config(setting.overrides))
            assert usual.items() <= scene_numbers(scene).items()

    def test_people_and_rays_that_a_config_does_not_have_are_tried(self, tmp_path):
        path = tmp_path / "people.yaml"
        path.write_text(CONFIG.replace("model: paper", "model: human") + "wall: {}\n")
        names = {setting.name for setting in sweep(Scenes(path, (), quick=True).config())}
        assert {"another person, who walks", "straight rays", "refracted rays"} <= names
        assert {"beams of 70 x 30 degrees", "reflections inside the wall"} <= names
        assert "plane rays" not in names

    def test_the_other_body_setting_is_the_one_the_config_lacks(self, config):
        scenes = self.scenes(config, "body.scatterers=segments")
        names = [setting.name for setting in sweep(scenes.config())]
        assert "scatterers: points instead of segments" in names
        assert "shadowing" in names

    def test_gates_are_compared_without_maps_that_forbid_them(self, config):
        scenes = self.scenes(config, "maps=[stft, fsst]")
        names = [setting.name for setting in study.allowed_settings(scenes, Listener())]
        assert "range_sum: gated instead of coherent" in names
