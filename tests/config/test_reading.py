"""YAML to Config; for every mistake the file, line, key, value and what would be right."""

import json
from pathlib import Path
from textwrap import dedent
from typing import NamedTuple

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config, load_config, resolved
from radhar_cli.config.reading import Override, load_section
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.reading import stored_config
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.schema.annotations import at
from radhar_cli.schema.number import Choice, Normal, Uniform, Vary
from radhar_cli.schema.section import for_activity


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.yaml"
    path.write_text(dedent(text), encoding="utf-8")
    return path


def read(folder: Path, text: str, *overrides: str) -> Config:
    return load_config(written(folder, text), overrides)


def mistakes(folder: Path, text: str, *overrides: str) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read(folder, text, *overrides)
    return str(caught.value).splitlines()


def test_an_empty_file_is_all_defaults(tmp_path: Path) -> None:
    assert read(tmp_path, "") == Config()
    assert read(tmp_path, "# nothing but a comment\n") == Config()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("77e3", 77e3),
        ("77E3", 77e3),
        ("7.7e4", 7.7e4),
        ("+77e+3", 77e3),
        ("1e-3", 1e-3),
        (".5e1", 5.0),
        ("5.", 5.0),
        ("1_000.5", 1000.5),
        ("24", 24.0),
    ],
)
def test_numbers_as_engineers_write_them(tmp_path: Path, text: str, value: float) -> None:
    config = read(tmp_path, f"motion: {{range_m: {text}}}")
    assert config.motion.range_m == value


def test_a_number_in_quotes_stays_text(tmp_path: Path) -> None:
    (line,) = mistakes(tmp_path, 'radar: {carrier_hz: "77e9"}')
    assert 'radar.carrier_hz = "77e9"' in line


def test_every_form_of_a_number(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        """
        subject:
          height_m: {uniform: [1.5, 1.9]}
          weight_kg: {normal: [80, 10], min: 50, max: 120}
        motion:
          walking: {speed_mps: {choice: [1, 1.5]}}
          paper: {thigh_deg: {vary: [30, 0.2]}, gait_hz: 1}
        """,
    )
    assert config.subject.height_m == Uniform(uniform=(1.5, 1.9))
    assert config.subject.weight_kg == Normal(normal=(80, 10), min=50, max=120)
    assert config.motion.walking.speed_mps == Choice(choice=(1, 1.5))
    assert config.motion.paper.thigh_deg == Vary(vary=(30, 0.2))
    assert config.motion.paper.gait_hz == 1.0


def test_a_number_by_activity_with_slugs_and_labels(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        """
        motion:
          range_m:
            per_activity: {default: {uniform: [2, 3]}, walking: 1, S9: 1.5, s10: {vary: [1, 0.1]}}
        """,
    )
    by_label = {a.label: for_activity(config.motion.range_m, a) for a in ACTIVITIES}
    assert by_label.pop("S8") == 1.0
    assert by_label.pop("S9") == 1.5
    assert by_label.pop("S10") == Vary(vary=(1, 0.1))
    assert set(by_label.values()) == {Uniform(uniform=(2, 3))}
    assert len(by_label) == 9


def test_slug_and_label_are_the_same_config(tmp_path: Path) -> None:
    text = "motion: {{walking: {{speed_mps: {{per_activity: {{default: 1, {}: 2}}}}}}}}"
    assert read(tmp_path, text.format("walking")) == read(tmp_path, text.format("S8"))


def test_overrides(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        "radar: {prf_hz: 500}\nwall: null\nmotion: {range_m: 3}\n",
        "radar.prf_hz=128",
        "radar.carrier_hz=2e9",
        "subject.height_m={uniform: [1.6, 1.7]}",
        "wall.eps_r=4",
        "motion.range_m.per_activity.default=2",
        "motion.range_m.per_activity.S8=1",
        "maps=[rtm, fsst]",
        " snr_db = null",
    )
    assert config == read(
        tmp_path,
        """
        radar: {prf_hz: 128, carrier_hz: 2e9}
        subject: {height_m: {uniform: [1.6, 1.7]}}
        wall: {eps_r: 4}
        motion: {range_m: {per_activity: {default: 2, walking: 1}}}
        maps: [rtm, fsst]
        snr_db: null
        """,
    )


def test_the_last_of_repeated_overrides_wins(tmp_path: Path) -> None:
    assert read(tmp_path, "seed: 1", "seed=2", "seed=3").seed == 3
    config = read(tmp_path, "", "radar={prf_hz: 128}", "radar.prf_hz=256", "radar.chirp_s=2e-5")
    assert (config.radar.prf_hz, config.radar.chirp_s) == (256, 2e-5)


def test_an_override_changes_one_key_only_where_values_share_an_anchor(tmp_path: Path) -> None:
    text = "motion: {paper: {thigh_deg: &swing {vary: [30, 0.2]}, calf_deg: *swing}}"
    config = read(tmp_path, text, "motion.paper.calf_deg.vary=[45, 0.1]")
    assert config.motion.paper.calf_deg == Vary(vary=(45, 0.1))
    assert config.motion.paper.thigh_deg == Vary(vary=(30, 0.2))


@pytest.mark.parametrize("override", ["seed", "=3", "radar..prf_hz=3", ".seed=3", "radar.=3"])
def test_an_override_without_key_or_value(tmp_path: Path, override: str) -> None:
    (line,) = mistakes(tmp_path, "", override)
    assert f"--set {override}" in line
    assert "key=value" in line


def test_an_override_that_is_not_yaml(tmp_path: Path) -> None:
    (line,) = mistakes(tmp_path, "", "radar.tx_m=[0, 1")
    assert "--set radar.tx_m" in line
    assert "not valid YAML" in line


def test_a_bad_override_names_key_and_value(tmp_path: Path) -> None:
    (line,) = mistakes(tmp_path, "radar:\n  prf_hz: 128\n", "radar.prf_hz=-5")
    assert "radar.prf_hz = -5: should be above 0" in line
    assert ":2:" not in line  # the file's line 2 is right, the override is not


class Broken(NamedTuple):
    """A config with one mistake; its message: line, key and value, then what would be right."""

    text: str
    what: str
    right: str


WALL = "wall: {}\n"
BROKEN = [
    # Unknown keys, at every depth.
    Broken("sead: 1", "1: sead = 1", "unknown key; did you mean 'seed'"),
    Broken("seed: 1\nzzz: 1", "2: zzz = 1", "unknown key"),
    Broken(
        "radar:\n  carrier: 77e9", "2: radar.carrier = 77000000000.0", "did you mean 'carrier_hz'"
    ),
    Broken("image:\n  color_map: gray", '2: image.color_map = "gray"', "'colour_map'"),
    Broken(
        "processing:\n  savgol:\n    odrer: 3", "3: processing.savgol.odrer = 3", "mean 'order'"
    ),
    Broken(
        "subject:\n  height_m:\n    uniform: [1, 2]\n    mx: 3",
        "4: subject.height_m.mx = 3",
        "unknown key",
    ),
    Broken(
        "motion:\n  range_m:\n    per_activity: {default: 1}\n    walking: 2",
        "4: motion.range_m.walking = 2",
        "unknown key",
    ),
    # Values of the wrong kind.
    Broken("seed: 1.5", "1: seed = 1.5", "integer"),
    Broken("seed: true", "1: seed = true", "integer"),
    Broken("seed: -1", "1: seed = -1", "greater than or equal to 0"),
    Broken(
        "radar: {frame: {chirps: 64}, carrier_hz: 77}",
        "1: radar.carrier_hz = 77",
        "1000000 Hz (77 GHz is 77e9)",
    ),
    Broken(
        "radar: {frame: {chirps: 64}, bandwidth_hz: 250}",
        "1: radar.bandwidth_hz = 250",
        "1000 Hz (250 MHz is 250e6)",
    ),
    Broken("maps: [range-doppler]", '1: maps.0 = "range-doppler"', "is called range_doppler"),
    Broken("maps: [RDM]", '1: maps.0 = "RDM"', "is called range_doppler"),
    Broken("seed: 9223372036854775808", "1: seed = 9223372036854775808", "less than"),
    Broken("samples_per_class: 0", "1: samples_per_class = 0", "greater than or equal to 1"),
    Broken("duration_s: four", '1: duration_s = "four"', "should be a number or one of {uniform"),
    Broken("duration_s: yes", '1: duration_s = "yes"', "should be a number"),
    Broken("seed: null", "1: seed = null", "should be a valid integer"),
    Broken("duration_s: .nan", "1: duration_s = NaN", "finite number"),
    Broken("duration_s: .inf", "1: duration_s = Infinity", "finite number"),
    Broken("snr_db: [30, 20]", "1: snr_db = [30, 20]", "{choice: [a, b, ...]}"),
    Broken("radar: 77e9", "1: radar = 77000000000.0", "should be"),
    Broken("radar:\n  tx_m: [0, 1, a]", '2: radar.tx_m.2 = "a"', "should be a number"),
    Broken(
        "radar:\n  tx_m: [0, 1]", "2: radar.tx_m = [0, 1]", "should be a list of 3 values, not of 2"
    ),
    Broken(
        "processing: {clutter: mti}",
        '1: processing.clutter = "mti"',
        "'difference', 'mean', 'highpass' or 'none'",
    ),
    *(
        Broken(
            f"processing: {{range_sum: gated, gate_m: {wrong}}}",
            f"1: processing.gate_m = {wrong}",
            "above 0, or [from, to]",
        )
        for wrong in ("[1, 2, 3]", "[2, 1]", "0", "-1", '"wide"', "null", "[true, 2]", "[-1, 2]")
    ),
    Broken("snr_reference: wall", '1: snr_reference = "wall"', "'free_space' or 'received'"),
    Broken("on_invalid: drop", '1: on_invalid = "drop"', "'keep', 'redraw' or 'error'"),
    Broken("engine:\n  kind: fast", '2: engine.kind = "fast"', "'direct' or 'cube'"),
    # Values out of bounds.
    Broken("duration_s: 0", "1: duration_s = 0", "above 0"),
    Broken(
        "subject:\n  height_m: {normal: [1.7, 0.5]}",
        '2: subject.height_m = {"normal": [1.7, 0.5]}',
        "above 0 (this one reaches from -1.3 to 4.7)",
    ),
    Broken("motion: {angle_deg: 400}", "1: motion.angle_deg = 400", "-360 to 360 degrees"),
    Broken("motion: {range_m: 1e7}", "1: motion.range_m = 10000000.0", "within 1e6 m"),
    Broken("timing: {blend_s: -0.1}", "1: timing.blend_s = -0.1", "0 or more"),
    Broken("wall: {eps_r: 0.5}", "1: wall.eps_r = 0.5", "1 or more"),
    Broken("wall:\n  size_m: [0, 5, 2]", "2: wall.size_m.0 = 0", "above 0"),
    Broken("wall:\n  rays: bent", '2: wall.rays = "bent"', "'straight', 'plane' or 'refracted'"),
    Broken(
        "wall: {fresnel: s}", '1: wall.fresnel = "s"', "'normal', 'perpendicular' or 'parallel'"
    ),
    Broken("snr_db: 301", "1: snr_db = 301", "from -300 to 300 dB"),
    Broken("image: {dynamic_range_db: 0}", "1: image.dynamic_range_db = 0", "greater than 0"),
    Broken("output: {png_level: 10}", "1: output.png_level = 10", "less than or equal to 9"),
    Broken(
        "processing: {range_fft_length: 401}", "1: processing.range_fft_length = 401", "multiple"
    ),
    Broken("processing: {window_s: 0}", "1: processing.window_s = 0", "greater than 0"),
    # Distributions that are none.
    Broken(
        "subject:\n  height_m: {uniform: [1.9, 1.5]}",
        '2: subject.height_m = {"uniform": [1.9, 1.5]}',
        "low <= high",
    ),
    Broken("snr_db: {normal: [10, -1]}", '1: snr_db = {"normal": [10, -1]}', "sd >= 0"),
    Broken(
        "snr_db: {normal: [10, 1], min: 99}",
        '1: snr_db = {"normal": [10, 1], "min": 99}',
        "within 6 standard deviations",
    ),
    Broken(
        "snr_db:\n  normal: [10, 1]\n  min: low",
        '3: snr_db.min = "low"',
        "should be a valid number",
    ),
    Broken("snr_db: {vary: [10, 2]}", '1: snr_db = {"vary": [10, 2]}', "fraction from 0 to 1"),
    Broken("snr_db: {choice: []}", '1: snr_db = {"choice": []}', "1 value or more"),
    Broken(
        "snr_db: {uniform: [1, 2], choice: [1]}",
        '1: snr_db = {"uniform": [1, 2], "choice": [1]}',
        "should be a number or one of",
    ),
    # Activities and maps.
    Broken("activities: [wlking]", '1: activities = ["wlking"]', "did you mean 'walking'"),
    Broken("activities: [S8, walking]", '1: activities = ["S8", "walking"]', "each class once"),
    Broken("activities: []", "1: activities = []", "at least one"),
    Broken("maps: [stft, stft]", '1: maps = ["stft", "stft"]', "each map once"),
    Broken(
        "motion: {rise_overlap: 0.2}", "1: motion.rise_overlap = 0.2", "is now a dwell_s below 0"
    ),
    Broken("motion: {squat: 1}", "1: motion.squat = 1", "nothing measured depends on it"),
    Broken("maps: [point_cloud]", '1: maps.0 = "point_cloud"', "is called points"),
    Broken("maps: [range_doppler]", '1: maps = ["range_doppler"]', "of the frames of a board"),
    Broken("receivers: 4", "1: receivers = 4", "come with radar.cfg"),
    Broken("people: 2", "1: people = 2", "should be a list"),
    Broken(
        "radar:\n  cfg: iwr1443boost\n  device: IWR6843",
        '3: radar.device = "IWR6843"',
        "IWR6843ISK-ODS",
    ),
    Broken(
        "radar:\n  device: IWR6843ISK", '2: radar.device = "IWR6843ISK"', "is a key of radar.cfg"
    ),
    Broken(
        "radar: {waveform: cw, chirp_s: 1e-5}", "1: radar.chirp_s = 1e-05", "cw, which has none"
    ),
    Broken("radar: {steps: 4}", "1: radar.steps = 4", "a key of radar.waveform: sfcw"),
    Broken("radar: {waveform: lfm}", '1: radar.waveform = "lfm"', "fmcw, sfcw, cw or impulse"),
    Broken("radar: {cfg: a.cfg}", '1: radar.cfg = "a.cfg"', "should be the path of a TI .cfg"),
    Broken("maps: [sfft]", '1: maps.0 = "sfft"', "should be 'rtm', 'stft'"),
    Broken("maps: []", "1: maps = []", "at least 1"),
    Broken(
        "motion:\n  paper: {gait_hz:\n    {per_activity: {}}}",
        "3: motion.paper.gait_hz.per_activity = {}",
        "should name one activity or more, or `default`",
    ),
    Broken(
        "motion:\n  paper: {gait_hz: {per_activity: {default: 1, skipping: 2}}}",
        "2: motion.paper.gait_hz.per_activity.skipping = 2.0",
        "'skipping' is not an activity; no model moves like this; motion files can",
    ),
    Broken(
        "seed: 1\nsamples_per_class: {per_activity: {default: 3, sittng_down: 2}}",
        "2: samples_per_class.per_activity.sittng_down = 2",
        "did you mean 'sitting_down'?",
    ),
    Broken(
        "samples_per_class: {per_activity: {default: 3, S8: 0}}",
        "1: samples_per_class.per_activity.S8 = 0",
        "greater than or equal to 1",
    ),
    Broken(
        "classes: {home: {sequence: [walking]}}\n"
        "timing: {walk_stop_s: {per_activity: {default: 3, hone: 2}}}",
        "2: timing.walk_stop_s.per_activity.hone = 2.0",
        "did you mean 'home'?",
    ),
    Broken(
        "classes: {home: {sequence: [walking]}}\n"
        "samples_per_class: {per_activity: {default: 3, Home: 2, home: 1}}",
        "2: samples_per_class.per_activity.Home = 2",
        "is home, named here, too",
    ),
    # One mistake, though `home` is then no class that `activities` could name.
    Broken(
        "classes: {home: {sequence: [waking]}}\nactivities: [home]\n"
        "motion: {range_m: {per_activity: {default: 3, home: 5}}}",
        '1: classes.home = {"sequence": ["waking"]}',
        "'waking' is not a movement; did you mean 'walking'?",
    ),
    Broken(
        "split: {by: subject, subjects: 3}\nsamples_per_class: {per_activity: {default: 3, S8: 2}}",
        "1: split.subjects = 3",
        "at most samples_per_class = 2 of walking",
    ),
    Broken(
        "motion:\n  paper: {gait_hz: {per_activity: {default: 1, S8: 1, walking: 2}}}",
        '2: motion.paper.gait_hz.per_activity = {"default": 1, "S8": 1, "walking": 2}',
        "walking once",
    ),
    Broken(
        "motion:\n  paper: {gait_hz:\n    {per_activity:\n      {default: 1,\n      S8: -1}}}",
        "5: motion.paper.gait_hz.per_activity.S8 = -1",
        "0 or more",
    ),
    # Sections that contradict themselves.
    Broken(
        "processing:\n  savgol: {order: 5, frame: 10}",
        '2: processing.savgol = {"order": 5, "frame": 10}',
        "odd and above the order",
    ),
    Broken(
        "split: {train: 0.8, validation: 0.3}",
        '1: split = {"train": 0.8, "validation": 0.3}',
        "add up to 1.1",
    ),
    Broken(
        "split: {by: subject}", '1: split = {"by": "subject"}', "'subjects: n' with 'by: subject'"
    ),
    Broken(
        "split: {subjects: 3}", '1: split = {"subjects": 3}', "'subjects: n' with 'by: subject'"
    ),
    # Sections that contradict each other.
    Broken(
        "split: {by: subject, subjects: 301}",
        "1: split.subjects = 301",
        "at most samples_per_class = 300",
    ),
    Broken(
        "radar:\n  chirp_s: 2.1e-4\n  prf_hz: 5000",
        "2: radar.chirp_s = 0.00021",
        "at most the pulse interval 1/prf_hz = 0.0002 s",
    ),
    Broken(
        "radar:\n  prf_hz: {uniform: [100, 1e5]}\n  chirp_s: 40e-6",
        "3: radar.chirp_s = 4e-05",
        "1/prf_hz = 1e-05 s",
    ),
    Broken(
        "radar:\n  adc_rate_hz: 3.7e4",
        "2: radar.adc_rate_hz = 37000.0",
        "at least 2 ADC samples per chirp (adc_rate_hz * chirp_s is 1)",
    ),
    Broken(
        "radar:\n  adc_rate_hz: 27e9",
        "2: radar.adc_rate_hz = 27000000000.0",
        "at most 1048576 ADC samples",
    ),
    Broken(
        "processing:\n  range_fft_length: 398",
        "2: processing.range_fft_length = 398",
        "at least the 400 ADC samples",
    ),
    Broken("duration_s: 1e-4\nmaps: [rtm]", "1: duration_s = 0.0001", "at least 2 pulses"),
    Broken(
        "duration_s: 1e6\nmotion: {model: paper}", "1: duration_s = 1000000.0", "16777216 pulses"
    ),
    Broken(
        "duration_s: 0.0148\nmotion: {model: paper}",
        "1: duration_s = 0.0148",
        "at least 8 pulses (it has 7)",
    ),
    Broken(
        "duration_s: 8e-4",
        "1: duration_s = 0.0008",
        "at most the 7 pulses there are (it has 8)",
    ),
    Broken(
        "duration_s: 0.005\nprocessing:\n  window_s: 0.005",
        "3: processing.window_s = 0.005",
        "at most the 49 pulses there are (it has 50)",
    ),
    Broken(
        "processing: {window_s: 0.0005}",
        "1: processing.window_s = 0.0005",
        "window of window_s * prf_hz at least 8 pulses (it has 5)",
    ),
    Broken("body: {scatterers: point}", '1: body.scatterers = "point"', "'segments' or 'surfaces'"),
    Broken("body: {points_per_segment: 0}", "1: body.points_per_segment = 0", "or equal to 1"),
    Broken(
        "duration_s: 0.01\nmaps: [stft_denoised]\nprocessing:\n  savgol: {order: 3, frame: 101}",
        "4: processing.savgol.frame = 101",
        "at most the 99 pulses",
    ),
    Broken(
        "processing:\n  stft_fft_length: 1999\n  window_s: 0.2",
        "2: processing.stft_fft_length = 1999",
        "at least the window of 2000 pulses",
    ),
    Broken(
        "engine:\n  motion_in_chirp: true",
        "2: engine.motion_in_chirp = true",
        "false with engine.kind: direct",
    ),
    Broken(
        WALL + "radar:\n  tx_m: [0.9, 0, 1]", "3: radar.tx_m = [0.9, 0.0, 1.0]", "outside the wall"
    ),
    Broken(
        WALL + "radar:\n  rx_m: [0.88, 0, 1]",
        "3: radar.rx_m = [0.88, 0.0, 1.0]",
        "outside the wall, whose faces count as inside",
    ),
    Broken(
        WALL + "radar:\n  rx_m: [{uniform: [0, 0.9]}, 0, 1]",
        '3: radar.rx_m = [{"uniform": [0.0, 0.9]}, 0.0, 1.0]',
        "outside the wall",
    ),
]


@pytest.mark.parametrize("broken", BROKEN, ids=lambda b: f"{b.what} {b.right}"[:60])
def test_each_mistake_is_reported_in_one_line(tmp_path: Path, broken: Broken) -> None:
    (line,) = mistakes(tmp_path, broken.text)
    start = f"{tmp_path / 'scene.yaml'}:{broken.what}: "
    assert line.startswith(start)
    assert broken.right in line.removeprefix(start)


NAMES_OF_FORMS = (
    *("number", "uniform", "normal", "choice", "vary", "same", "per_activity"),
    *("movements", "dielectric", "material"),
)


@pytest.mark.parametrize("name", NAMES_OF_FORMS)
@pytest.mark.parametrize(
    "section", ["", "subject", "motion", "radar.beam", "wall", "room", "split", "image.cfar"]
)
def test_an_unknown_key_is_named_whatever_its_name(tmp_path: Path, section: str, name: str) -> None:
    key = f"{section}.{name}".lstrip(".")
    document: dict[str, object] = {name: 3}
    for part in reversed(section.split(".") if section else []):
        document = {part: document}
    (line,) = mistakes(tmp_path, json.dumps(document))
    assert f": {key} = 3: is " in line


@pytest.mark.parametrize("name", NAMES_OF_FORMS)
@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("people: [{activity: walking, motion: {NAME: 3}}]", "people.0.motion"),
        ("classes: {hop: {sequence: [kicking], NAME: 3}}", "classes.hop"),
        ("wall: {layers: [{material: concrete, NAME: 3}], echoes: exact}", "wall.layers.0"),
        ("room: {faces: {floor: {NAME: 3}}}", "room.faces.floor"),
        ("motion: {range_m: {uniform: [1, 2], NAME: 3}}", "motion.range_m"),
    ],
)
def test_an_unknown_key_of_lists_and_mappings_is_named(
    tmp_path: Path, text: str, place: str, name: str
) -> None:
    if f"{name}: " in text or (place, name) == ("motion.range_m", "per_activity"):
        return  # a key there
    (line,) = mistakes(tmp_path, text.replace("NAME", name))
    assert f": {place}" in line
    if place != "motion.range_m" or name not in ("normal", "choice", "vary"):  # of two forms
        assert f": {place}.{name} = 3: is an unknown key" in line


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            "motion: {range_m: {uniform: [1, x]}}",
            'motion.range_m.uniform.1 = "x": should be a valid number, from -1e+06 to 1e+06 m',
        ),
        (
            "motion: {range_m: {normal: [1, x]}}",
            'motion.range_m.normal.1 = "x": should be a valid number',
        ),
        (
            "motion: {walking: {speed_mps: {per_activity: {walking: {choice: [1, x]}}}}}",
            "motion.walking.speed_mps.per_activity.walking.choice.1 = "
            '"x": should be a valid number',
        ),
        ("wall: {layers: [{material: beton}]}", 'wall.layers.0.material = "beton": should be'),
        ("wall: {layers: []}", "wall.layers = []: should have at least 1 item, not 0"),
        (
            "wall: {material: concrete}",
            "is a key of layers: wall.layers: [{material: concrete}], or wall.eps_r",
        ),
        (
            "classes: {kicking: {past_end: loop}}",
            "should have a `sequence` of movements, or `files` of motion",
        ),
        (
            "classes: {hop: {files: [a.bvh], sequence: [kicking]}}",
            "should be left out: a class has a `sequence` or `files`, not both",
        ),
        ("radar: {beam: {start: 1}}", "radar.beam.start = 1: is an unknown key"),
        (
            "subject: {height_m: {per_activity: {walking: 1.7}}}",
            "has no per_activity, it is the same for every activity: should be a number or one",
        ),
    ],
)
def test_one_mistake_gives_one_message(tmp_path: Path, text: str, says: str) -> None:
    (line,) = mistakes(tmp_path, text)
    assert says in line


def test_all_mistakes_are_reported_together(tmp_path: Path) -> None:
    lines = mistakes(tmp_path, "sead: 1\nradar:\n  prf_hz: -1\nsnr_db: loud\n")
    assert {line.split(": ")[1].split(" =")[0] for line in lines} == {
        "sead",
        "radar.prf_hz",
        "snr_db",
    }


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("seed: 1\nseed: 2\n", 2, "'seed' appears twice"),
        ("radar:\n  prf_hz: 1\n  chirp_s: 1\n  prf_hz: 2\n", 4, "'prf_hz' appears twice"),
        ("seed: 1\nmaps: [stft\n", 3, "not valid YAML"),
        ("seed: 1\nradar: prf: 2\n", 2, "not valid YAML"),
        ("seed: 1\n\tmaps: [stft]\n", 2, "not valid YAML"),
        ("seed: 1\n---\nseed: 2\n", 2, "another document"),
        ("seed: !!python/object:os.system x\n", 1, "not valid YAML"),
        ("radar: &a {tx_m: *a}\n", 1, "not valid YAML"),
    ],
)
def test_invalid_yaml_is_refused(tmp_path: Path, text: str, line: int, says: str) -> None:
    (message,) = mistakes(tmp_path, text)
    assert message.startswith(f"{tmp_path / 'scene.yaml'}:{line}: ")
    assert says in message


@pytest.mark.parametrize(("text", "key"), [("null: 2\n", "None"), ("? [seed]\n: 1\n", "seed")])
def test_a_non_text_key_is_not_reported_as_a_duplicate(tmp_path: Path, text: str, key: str) -> None:
    (message,) = mistakes(tmp_path, text)
    assert message.startswith(f"{tmp_path / 'scene.yaml'}:1: ")
    assert key in message
    assert "twice" not in message


@pytest.mark.parametrize("text", ["- seed\n- 1\n", "seed\n", "3\n", "[]\n"])
def test_files_without_a_mapping_are_refused(tmp_path: Path, text: str) -> None:
    (message,) = mistakes(tmp_path, text)
    assert message.startswith(f"{tmp_path / 'scene.yaml'}: ")
    assert "mapping" in message


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"nowhere\.yaml: no such file"):
        load_config(tmp_path / "nowhere.yaml")
    with pytest.raises(ConfigError, match="cannot be read"):
        load_config(tmp_path)
    binary = tmp_path / "image.yaml"
    binary.write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff\xfe")
    with pytest.raises(ConfigError, match=r"image\.yaml: cannot be read as text"):
        load_config(binary)
    binary.write_bytes(b"seed: \x00")
    with pytest.raises(ConfigError, match=r"image\.yaml: not valid YAML"):
        load_config(binary)


def answer(path: Path) -> str:
    try:
        load_config(path)
    except ConfigError as error:
        return str(error)
    return ""


@given(text=st.text(alphabet="ab: -[]{}&*!,'\"\n?|>#%@1.~", max_size=40))
@settings(
    deadline=None,
    max_examples=150,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_any_input_gives_a_config_or_a_config_error(tmp_path: Path, text: str) -> None:
    path = tmp_path / "typed.yaml"
    path.write_text(text, encoding="utf-8")
    told = answer(path)
    assert not told or told.startswith(str(path))


FULL = """
seed: 7
activities: [S12, walking]
duration_s: {choice: [3.5, 4]}
radar: {tx_m: [0.1, {uniform: [-0.2, -0.1]}, 1.5], prf_hz: 1000}
subject: {height_m: {normal: [1.7, 0.1], min: 1.5}, weight_kg: {vary: [80, 0.1]}}
motion: {model: paper, range_m: {per_activity: {default: {uniform: [2, 3]}, S8: 1}}}
timing: {blend_s: {per_activity: {default: 0.3, S12: 0}}}
wall: {loss_tangent: {uniform: [0.01, 0.05]}}
snr_db: null
maps: [fsst, rtm]
image: {size_px: [64, 128]}
split: {by: subject, subjects: 10, train: 0.7, validation: 0.2, test: 0.1}
"""


@pytest.mark.parametrize("text", ["", "seed: 3", "wall: {}", FULL])
def test_the_stored_config_is_the_same_config(tmp_path: Path, text: str) -> None:
    config = read(tmp_path, text)
    assert Config.model_validate(json.loads(json.dumps(resolved(config)))) == config


@pytest.mark.parametrize("stored", [[1], {"seed": -1}, None, {"recordings": {}}])
def test_a_stored_config_that_is_broken_names_its_file(stored: object) -> None:
    with pytest.raises(FolderError, match=r"^dataset\.h5: "):
        stored_config(stored, "dataset.h5")


@pytest.mark.parametrize(
    ("override", "place"),
    [
        ("radar.prf_hz=-1", "--set radar.prf_hz = -1: "),
        ("radar={prf_hz: -1}", "--set radar: radar.prf_hz = -1: "),
        (
            Override("engine.tolerance_db", "3", "--tolerance"),
            "--tolerance: engine.tolerance_db = 3: ",
        ),
        ("rada.x=1", '--set rada.x: rada = {"x": 1}: '),
    ],
)
def test_mistakes_in_set_name_the_option(
    tmp_path: Path, override: str | Override, place: str
) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("seed: 1\nradar: {prf_hz: 100}\nengine: {tolerance_db: -60}\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path, ["seed=2", override])
    assert str(caught.value).startswith(place)


def test_a_mistake_of_file_and_option_together_names_both(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("seed: 1\nsplit: {train: 0.5, validation: 0.5}\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path, ["split.train=0.9"])
    assert str(caught.value).startswith(f"{path}:2: split (--set split.train) = ")


@pytest.mark.parametrize("name", ["val", "validation"])
def test_validation_may_be_called_as_its_folder_is(tmp_path: Path, name: str) -> None:
    assert read(tmp_path, f"split: {{train: 0.7, {name}: 0.3}}").split.validation == 0.3
    overridden = read(tmp_path, "split: {train: 0.8}", "split.train=0.7", f"split.{name}=0.3")
    assert overridden.split.validation == 0.3
    (line,) = mistakes(tmp_path, f"seed: 1\nsplit:\n  {name}: -1\n")
    assert ":3: split.validation = -1: should be" in line


def test_validation_has_one_value(tmp_path: Path) -> None:
    (line,) = mistakes(tmp_path, "split: {val: 0.2, validation: 0.2}")
    assert "split.val = 0.2: is an unknown key" in line


def test_a_default_that_an_option_spoils_names_the_option(tmp_path: Path) -> None:
    """The mistake is of the whole config, of which no file was given."""
    with pytest.raises(ConfigError, match=r"^--target: should have model: cloudnet"):
        load_section(TrainConfig, None, [Override("target", "skeleton", "--target")])


def test_activities_that_are_not_named_keep_the_default_of_the_key(tmp_path: Path) -> None:
    """That of the model where the key has one, whether it is a number or differs by activity."""
    text = "classes: {run: {sequence: [walking]}}\nactivities: [walking, kicking, run]\n"
    usual = read(tmp_path, text)
    for key in ("walking.speed_mps", "range_m", "cross_range_m", "paper.gait_hz", "angle_deg"):
        given = read(
            tmp_path, text, f"motion.{key}={{per_activity: {{run: {{uniform: [2, 2.5]}}}}}}"
        )
        before, after = (at(config, f"motion.{key}") for config in (usual, given))
        for activity in given.chosen_activities:
            kept = for_activity(before, activity)
            changed = Uniform(uniform=(2, 2.5)) if activity.slug == "run" else kept
            assert for_activity(after, activity) == changed
        again = Config.model_validate(given.model_dump(mode="json"))
        assert at(again, f"motion.{key}") == after
    given = read(tmp_path, text, "samples_per_class={per_activity: {run: 7}}")
    kept = usual.samples_of(usual.chosen_activities[0])
    assert [given.samples_of(one) for one in given.chosen_activities] == [kept, kept, 7]


KINDS = ("3.0", "{uniform: [3, 4]}", "{normal: [3, 0.1], min: 2.9, max: 4}", "{choice: [3, 4]}")
KINDS += ("{vary: [3, 0.1]}",)


@pytest.mark.parametrize(
    "number", [*KINDS, *(f"{{per_activity: {{walking: {n}}}}}" for n in KINDS)]
)
def test_messages_show_numbers_as_yaml_has_them(tmp_path: Path, number: str) -> None:
    """Walking is at most 2.8 m/s; the value is shown as it may be written, and never as Python."""
    (line,) = mistakes(tmp_path, f"motion: {{walking: {{speed_mps: {number}}}}}")
    assert "with motion.model: human" in line
    shown, _ = parse_yaml(line.split("speed_mps = ")[1].split(": should")[0], "message")
    (again,) = mistakes(tmp_path, "{}", f"motion.walking.speed_mps={json.dumps(shown)}")
    assert again.partition(" = ")[2] == line.partition(" = ")[2]
    assert "per_activity=" not in line


EARLIER = """
radar: {carrier_hz: 24e9, bandwidth_hz: 250e6, prf_hz: 2000}
motion:
  speed_mps: 0.7
  lane_m: 2
people:
  - motion: {fall: backward, exercise_period: 1.5}
"""
PRESENT = """
radar: {carrier_hz: 24e9, bandwidth_hz: 250e6, prf_hz: 2000}
motion: {walking: {speed_mps: 0.7, lane_m: 2}}
people:
  - motion: {falling: {direction: backward}, exercises: {period: 1.5}}
"""


def test_keys_of_earlier_versions_are_read_as_what_they_are_now(tmp_path: Path) -> None:
    (tmp_path / "earlier.yaml").write_text(EARLIER)
    (tmp_path / "now.yaml").write_text(PRESENT)
    (tmp_path / "over.yaml").write_text("base: earlier.yaml\nmotion: {walking: {lane_m: 3}}\n")
    now = load_config(tmp_path / "now.yaml")
    assert load_config(tmp_path / "earlier.yaml") == now
    assert load_config(tmp_path / "now.yaml", ["motion.lane_m=2"]) == now
    assert load_config(tmp_path / "over.yaml").motion.walking.lane_m == 3


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("lane_m: -2", "motion.walking.lane_m = -2.0: should be from 0 to 1000"),
        ("{lane_m: 2, walking: {lane_m: 3}}", "motion.lane_m = 2: is now motion.walking.lane_m"),
        ("{lane_m: 2, walking: 3}", "motion.walking = 3: should be a mapping of keys"),
    ],
)
def test_mistakes_in_keys_of_earlier_versions_name_their_line(
    tmp_path: Path, text: str, line: str
) -> None:
    value = text if text.startswith("{") else f"{{{text}}}"
    path = tmp_path / "x.yaml"
    path.write_text(f"{PRESENT.splitlines()[1]}\nmotion: {value}\n")
    with pytest.raises(ConfigError) as refused:
        load_config(path)
    assert f"{path}:2: {line}" in str(refused.value)
