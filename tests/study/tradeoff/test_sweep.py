"""`radhar tradeoff`: every kind of radar, what it writes, and that it goes on after a stop."""

import csv
import json

import pytest
from helpers.command_line import ROOT
from helpers.listener import Listener
from helpers.slow import slow_but
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.errors import ConfigError
from radhar_cli.scene.scene import scene_numbers
from radhar_cli.study.tradeoff import study
from radhar_cli.study.tradeoff.differences import signal_error
from radhar_cli.study.tradeoff.samples import ScenePlace, Scenes
from radhar_cli.study.tradeoff.settings import DEFAULT, Change, settings_of
from radhar_cli.study.tradeoff.sweep import AccuracyNumbers, Row, Sweep
from radhar_cli.study.trials import Budget

FMCW = """
motion: {model: paper}
activities: [stationary, punching, walking]
duration_s: 1.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500, adc_rate_hz: 1e6}
maps: [stft]
image: {size_px: 48, cfar: {guard: [2, 1], training: [10, 5]}}
"""
PEOPLE = """
activities: [walking]
duration_s: 1.0
motion: {place: {range_m: 3}}
image: {size_px: 48}
"""
KINDS = {
    "fmcw": FMCW,
    "gated": FMCW + "processing: {range_sum: gated}\n",
    "sfcw": PEOPLE
    + "radar: {waveform: sfcw, carrier_hz: 2e9, bandwidth_hz: 1e9, steps: 80, dwell_s: 20e-6, "
    "prf_hz: 200}\nmaps: [rtm, stft]\n",
    "cw": PEOPLE + "radar: {waveform: cw, carrier_hz: 24e9, prf_hz: 1000, output: real}\n",
    "impulse": PEOPLE.replace("image: {", "image: {kind: signed, ")
    + "radar: {waveform: impulse, carrier_hz: 1e9, bandwidth_hz: 1e9, prf_hz: 64, "
    "profile_m: [0, 10], profile_samples: 512}\nmaps: [rtm]\n",
    "board": PEOPLE.replace("duration_s: 1.0", "duration_s: 0.3")
    + "radar: {device: IWR1443BOOST, cfg: iwr1443boost}\ncloud: {chain: board}\n"
    "maps: [range_doppler, points]\n",
}
# Settings of the fast tests, which the kinds have in common or alone.
TRIED = (
    *("engine.tolerance_db: -120", "engine.precision: double", "body.scatterers: segments"),
    *("processing.overlap_fraction: 0.8", "half as many frames", "processing.clutter: mean"),
    *("radar.steps: 40", "radar.prf_hz: 32", "radar.prf_hz: 500", "a noise corner at PRF/20"),
)


def tradeoff(config, out, *more):
    return CliRunner().invoke(
        program(), ["tradeoff", str(config), "-o", str(out), "--quick", "--minutes", "60", *more]
    )


@pytest.fixture
def few(monkeypatch):
    """Few settings, and as few rounds as there may be."""

    def tried(config):
        return [setting for setting in settings_of(config) if setting.name in TRIED]

    monkeypatch.setattr(study, "settings_of", tried)
    monkeypatch.setattr(study, "LEAST_PAIRS", 1)
    monkeypatch.setattr(study, "MOST_ROUNDS", 1)
    monkeypatch.setattr("radhar_cli.study.tradeoff.study.ROUND_S", 0.0)


def write(folder, kind):
    path = folder / f"{kind}.yaml"
    path.write_text(KINDS[kind])
    return path


def numbers_of(out):
    return json.loads((out / "tradeoff.json").read_text())


def rows_of(out):
    return {row.name: row for row in Sweep.read(numbers_of(out)).rows}


@pytest.mark.parametrize("kind", slow_but(KINDS, ("fmcw", "board")))
def test_every_kind_of_radar(few, tmp_path, kind):
    """Files agree, errors are below the tolerance, and other pictures are told from errors."""
    out = tmp_path / "out"
    outcome = tradeoff(write(tmp_path, kind), out)
    assert outcome.exit_code == 0, outcome.output
    rows = rows_of(out)
    assert {path.name for path in out.iterdir()} == {
        f"tradeoff.{suffix}" for suffix in ("csv", "json", "md", "png", "html")
    }
    with (out / "tradeoff.csv").open() as file:
        assert {line["setting"] for line in csv.DictReader(file)} == set(rows)
    page = (out / "tradeoff.md").read_text()
    assert all(name in page for name in rows)
    assert all(sentence in outcome.output for sentence in numbers_of(out)["recommendation"])
    assert "Recommended: " in outcome.output
    default = rows[DEFAULT]
    assert default.error_db < -80
    assert all(row.error_db < -80 for row in rows.values() if row.effect is Change.ERROR)
    changed = rows["body.scatterers: segments"]
    assert changed.effect is Change.PICTURE
    assert changed.over_one > 0.01
    assert set(numbers_of(out)["floors_db"]) >= set(default.maps)
    if kind == "board":
        assert set(default.maps) == {"range_doppler"}
        assert default.error_of == "the cube"
        assert default.points.moved < 0.01  # a point in hundreds follows from rounding
        assert rows["half as many frames"].points.per_frame > 0
    if kind == "gated":
        assert default.error_of == "the gate's bins"


class TestGate:
    def test_its_error_is_that_of_the_bins_that_frames_show(self, tmp_path):
        """An error in a bin that no frame shows does not count; in one that is shown it does."""
        scenes = Scenes(write(tmp_path, "gated"), (), quick=True)
        raw = ScenePlace(scenes, "walking").simulate(("engine.kind=cube",))
        bins = raw.values["range_signals"]
        assert raw.needed.any()
        assert not raw.needed.all()
        for shown, error_db in ((False, float("-inf")), (True, None)):
            changed = bins + (raw.needed if shown else ~raw.needed) * abs(bins).max()
            other = raw._replace(values={"range_signals": changed})
            name, measured_db = signal_error(other, raw)
            assert name == "range_signals"
            assert measured_db == error_db or measured_db > -20


def test_networks_are_trained_for_what_saves_time():
    """The config as it is comes first; what saves nothing is not learned."""
    from radhar_cli.study.tradeoff.accuracy import measure_accuracies

    times = {"sample_ms": 8.0, "rounds": 5}
    default = Row("default", DEFAULT, (), DEFAULT, Change.ERROR, is_default=True)
    fast, slow = (
        Row(
            *("body", name, (name,), DEFAULT, Change.PICTURE),
            **{**times, "ratio": ratio, "ratio_low": ratio, "ratio_high": ratio},
        )
        for name, ratio in (("fast", 0.5), ("slow", 1.5))
    )
    learned = []

    class Networks:
        def measure(self, setting, seeds, budget):
            learned.append(setting)
            return AccuracyNumbers((0.8, 0.9), 0.85, 0.2, 1.5)

    sweep = Sweep([default, fast, slow])
    for _ in range(2):  # what is there is not made again
        measure_accuracies(Networks(), sweep, 2, Budget(60), lambda: None)
        assert learned == [(), ("fast",)]
        assert [row.accuracy is not None for row in sweep.rows] == [True, True, False]


class TestStops:
    def test_what_is_measured_is_kept_and_the_same_command_goes_on(
        self, few, tmp_path, monkeypatch
    ):
        config, out = write(tmp_path, "fmcw"), tmp_path / "out"
        measure, calls = study.TradeoffStudy.measure, []

        def stop_at_third(self, setting):
            calls.append(setting.name)
            if len(calls) == 3:
                raise KeyboardInterrupt
            return measure(self, setting)

        monkeypatch.setattr(study.TradeoffStudy, "measure", stop_at_third)
        stopped = tradeoff(config, out)
        assert stopped.exit_code == 130
        assert "the same command resumes" in stopped.output
        kept = rows_of(out)
        assert list(kept) == calls[:2]
        assert "## Settings" in (out / "tradeoff.md").read_text()  # readable as it is
        monkeypatch.setattr(study.TradeoffStudy, "measure", measure)
        assert tradeoff(config, out).exit_code == 0
        done = rows_of(out)
        assert {name: done[name] for name in kept} == kept
        assert len(done) > len(kept)
        assert not list(out.rglob("*unfinished*"))

    def test_results_of_another_config_are_not_gone_on_with(self, few, tmp_path):
        config, out = write(tmp_path, "cw"), tmp_path / "out"
        assert tradeoff(config, out).exit_code == 0
        refused = tradeoff(config, out, "--set", "radar.prf_hz=2000")
        assert refused.exit_code != 0
        assert "radar.prf_hz" in str(refused.exception)
        replaced = tradeoff(config, out, "--set", "radar.prf_hz=2000", "--overwrite")
        assert replaced.exit_code == 0, replaced.output

    @pytest.mark.parametrize("wrong", ["ratio", "points", "maps"])
    def test_a_damaged_result_is_named(self, few, tmp_path, wrong):
        config, out = write(tmp_path, "cw"), tmp_path / "out"
        assert tradeoff(config, out).exit_code == 0
        numbers = numbers_of(out)
        numbers["settings"][0][wrong] = "abc"
        (out / "tradeoff.json").write_text(json.dumps(numbers))
        refused = tradeoff(config, out)
        assert refused.exit_code != 0
        assert "is no result of this version of radhar" in str(refused.exception)

    def test_settings_without_time_are_named(self, few, tmp_path):
        config = write(tmp_path, "fmcw")
        sweep = Sweep()
        scenes = Scenes(config, (), quick=True)
        study.TradeoffStudy(scenes, sweep, Budget(0.0), Listener(), lambda: None).run()
        assert [row.name for row in sweep.rows] == [DEFAULT]
        assert sweep.rows[0].scenes == 1  # of three, which would leave no time for settings
        resumed = study.TradeoffStudy(scenes, sweep, Budget(60.0), Listener(), lambda: None)
        assert len(resumed.comparisons) == 1
        assert "engine.precision: double" in {omission.name for omission in sweep.unmeasured}


class TestSettings:
    def scenes(self, folder, kind, *more):
        return Scenes(write(folder, kind), more, quick=False)

    @pytest.mark.parametrize("kind", KINDS)
    def test_names_are_told_apart(self, tmp_path, kind):
        settings = settings_of(self.scenes(tmp_path, kind).config())
        assert len({setting.name for setting in settings}) == len(settings)

    def test_a_setting_that_the_config_forbids_is_named_with_its_reason(self, tmp_path):
        listener, sweep = Listener(), Sweep()
        scenes = self.scenes(tmp_path, "fmcw", "processing.highpass.cutoff_hz=300")
        allowed = study.TradeoffStudy(scenes, sweep, Budget(0), listener, lambda: None)
        names = {setting.name for setting in allowed.allowed_settings()}
        assert "processing.clutter: highpass" not in names
        messages = [message for message in listener.messages if "highpass" in message]
        assert len(messages) == 1
        assert messages[0].startswith("left out: processing.clutter: highpass: ")
        assert "\n" not in messages[0]

    def test_a_reason_that_follows_a_list_of_names_is_told_whole(self):
        error = ConfigError(
            "c.yaml:7: maps = []: should be some of rtm, stft: no cloud.chain: best"
        )
        assert study.reason_of(error) == "no cloud.chain: best"
        assert study.reason_of(ConfigError("c.yaml:7: x = 1: should be 2")) == "should be 2"

    def test_scenes_do_not_depend_on_engine_and_maps(self, tmp_path):
        scenes = self.scenes(tmp_path, "fmcw")
        usual = scene_numbers(ScenePlace(scenes, "walking").draw())
        for setting in settings_of(scenes.config()):
            if setting.group in ("engine", "maps", "image", "processing"):
                scene = ScenePlace(scenes, "walking").draw(setting.overrides)
                assert usual.items() <= scene_numbers(scene).items()

    def test_what_a_config_does_not_have_is_tried(self, tmp_path):
        path = tmp_path / "people.yaml"
        path.write_text(FMCW.replace("model: paper", "model: human") + "wall: {}\n")
        names = {setting.name for setting in settings_of(Scenes(path, (), quick=True).config())}
        assert {"another person, who walks", "wall.rays: refracted", "wall.echoes: exact"} <= names
        assert {"beams of 70 x 30 degrees", "maps with fsst", "radar.prf_hz: 250"} <= names
        assert "wall.rays: plane" not in names

    def test_gates_are_compared_without_maps_that_forbid_them(self, tmp_path):
        scenes = self.scenes(tmp_path, "fmcw", "maps=[stft, fsst]")
        settings = {setting.name: setting for setting in settings_of(scenes.config())}
        assert settings["processing.range_sum: gated"].base == ("maps=[stft]",)


SHIPPED = sorted(
    path
    for path in (ROOT / "configs").rglob("*.yaml")
    if path.parent.name != "train" and "\nradars:" not in path.read_text()
)


@pytest.mark.slow
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: str(path.relative_to(ROOT / "configs")))
def test_every_shipped_config(path, tmp_path, monkeypatch):
    """All settings of all configs, with the smallest effort: a row, or a line that says why not."""
    monkeypatch.setattr(study, "MOST_ROUNDS", 1)
    monkeypatch.setattr("radhar_cli.study.tradeoff.study.ROUND_S", 0.0)
    monkeypatch.setattr(Scenes, "samples", lambda self: [ScenePlace(self, first_slug(self))])
    outcome = tradeoff(path, tmp_path / "out")
    assert outcome.exit_code == 0, outcome.output
    numbers = numbers_of(tmp_path / "out")
    measured = {row["name"] for row in numbers["settings"]}
    left_out = {omission["name"] for omission in numbers["left_out"]}
    every = {setting.name for setting in settings_of(Scenes(path, (), quick=True).config())}
    unmeasured = {omission["name"] for omission in numbers["unmeasured"]}
    assert measured | left_out | unmeasured == every | {DEFAULT}
    assert numbers["floors_db"]
    assert "Recommended: " in outcome.output


def first_slug(scenes):
    slugs = [activity.slug for activity in scenes.config().chosen_activities]
    return "walking" if "walking" in slugs else slugs[0]
