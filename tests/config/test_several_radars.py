"""`radars`: a config of each radar, which lies over `radar`; and what is refused."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from radhar_cli.config import Config, load_config, load_radars, resolved
from radhar_cli.config.identity import as_yaml
from radhar_cli.errors import ConfigError
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import nominal_scene

BOARD = "{cfg: iwr1843boost, device: IWR1843BOOST}"


def file_of(folder: Path, text: str) -> Path:
    path = folder / "several.yaml"
    path.write_text(text)
    return path


def test_what_radar_says_lies_under_each_entry(tmp_path):
    path = file_of(
        tmp_path,
        "radar: {cfg: iwr1843boost, device: IWR1843BOOST, position_m: [0, 0, 1.2]}\n"
        "maps: [range_azimuth]\n"
        "processing: {clutter: none}\n"
        "radars:\n  azimuth:\n  elevation: {roll_deg: 90, maps: [range_elevation], snr_db: 20}\n",
    )
    configs = load_radars(path)
    azimuth, elevation = configs["azimuth"], configs["elevation"]
    assert [*configs] == ["azimuth", "elevation"]
    assert (azimuth.radar.roll_deg, elevation.radar.roll_deg) == (0, 90)
    assert azimuth.radar.position_m == elevation.radar.position_m == (0, 0, 1.2)
    assert (azimuth.maps, elevation.maps) == (("range_azimuth",), ("range_elevation",))
    assert (azimuth.snr_db, elevation.snr_db) == (None, 20)
    assert elevation.processing.clutter == "none"
    assert azimuth.other_radars == {"elevation": elevation.radar}


def test_order_of_entries_does_not_matter(tmp_path):
    entries = ["a: {prf_hz: 1000}", "b: {prf_hz: 2000}", "c: {waveform: cw}"]
    dumps = []
    for order in (entries, entries[::-1], entries[1:] + entries[:1]):
        configs = load_radars(file_of(tmp_path, f"radars: {{{', '.join(order)}}}\n"))
        assert [*configs] == ["a", "b", "c"]
        dumps.append([as_yaml(one) for one in configs.values()])
    assert dumps[0] == dumps[1] == dumps[2]


def test_one_radar_is_chosen_or_asked_for(tmp_path):
    path = file_of(tmp_path, "seed: 2\nradars:\n  front: {}\n  side: {prf_hz: 500}\n")
    with pytest.raises(ConfigError) as error:
        load_config(path)
    assert str(error.value) == (
        f"{path}:2: radars: has several radars, front and side; should be one here: "
        "--set radar_name=front"
    )
    chosen = load_config(path, ["radar_name=side", "radars.side.prf_hz=600"])
    assert (chosen.radar_name, chosen.radar.prf_hz) == ("side", 600)
    assert [*chosen.other_radars] == ["front"]
    alone = load_config(file_of(tmp_path, "radars: {front: {}}\n"))
    assert (alone.radar_name, alone.other_radars) == ("front", {})


def test_config_of_a_radar_reads_back(tmp_path):
    text = f"radars: {{a: {BOARD}, b: {{waveform: cw}}}}\nmaps: [stft]\n"
    for config in load_radars(file_of(tmp_path, text)).values():
        again = load_config(file_of(tmp_path, as_yaml(config)))
        assert again.without_other_words() == config.without_other_words()


def test_radar_alone_has_no_new_keys():
    assert not {"radars", "radar_name", "other_radars"} & resolved(Config()).keys()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("radars: [{}, {}]", ":1: radars = [{}, {}]: should be a mapping of names"),
        ("radars: {}", ":1: radars = {}: should be a mapping of names"),
        ("radars: {a/b: {}}", ':1: radars = "a/b": should have a name of letters'),
        ("radars: {a: {}, A: {}}", "should differ from a by more than capitals"),
        ("radars: {a: 3}", ":1: radars.a = 3: should be a mapping of keys of radar"),
        ("radars: {a: {}}\nradar_name: b", ':2: radar_name = "b": should be one of radars: a'),
        (
            "radars:\n  a: {}\n  b: {prf_hz: -1}",
            ":3: radars.b.prf_hz = -1: should be above 0",
        ),
        (
            "radar: {prf_hz: -1}\nradars: {a: {}, b: {}}",
            ":1: radar.prf_hz = -1: should be above 0",
        ),
        (
            "radars:\n  a: {}\n  b:\n    people: []",
            ":4: radars.b.people = []: is one for all radars; should stand beside radars",
        ),
        ("radars: {a: {seed: 3}}", "radars.a.seed = 3: is one for all radars"),
        ("radars: {a: {radar: {}}}", "radars.a.radar = {}: should be left out: keys of a radar"),
        ("radars: {a: {map: [stft]}}", 'radars.a.map = ["stft"]: is an unknown key; did you mean'),
        (
            "radars: {a: {foo: 1}}",
            "chirp_s, aspect, maps, processing, image, cloud, receiver, snr_db, snr_reference, ",
        ),
        ("radar: {foo: 1}\nradars: {a: {}}", ":1: radar.foo = 1: is an unknown key; known here: "),
        ("radar: {maps: [stft]}\nradars: {a: {}}", "is not a key of radar: maps stands at the top"),
        (
            "radar: {aspect: {angle_deg: x, distance_m: 3, about_m: [3, 0]}}\nradars: {a: , b: }",
            ':1: radar.aspect.angle_deg = "x": should be a number, one for all scenes',
        ),
        (
            "radars: {a: {aspect: {angel_deg: 90, distance_m: 3, about_m: [3, 0]}}}",
            "radars.a.aspect.angel_deg = 90: is an unknown key; did you mean 'angle_deg'?",
        ),
        (
            "radars: {a: {aspect: {angle_deg: 1e7, distance_m: 1e300, about_m: [3, 0]}}}",
            "radars.a.aspect.distance_m = 1e+300: should be at most 1e+06 in size",
        ),
        (
            "radars: {a: {aspect: {angle_deg: 1, distance_m: 1, about_m: [3, 1e300]}}}",
            "radars.a.aspect.about_m = [3, 1e+300]: should be [range, cross-range] of a place, m",
        ),
        (
            "radars: {a: {aspect: {angle_deg: 361, distance_m: 1, about_m: [3, 0]}}}",
            "radars.a.aspect.angle_deg = 361: should be from -360 to 360 degrees",
        ),
        ("radars: {a: {aspect: {}}}", "radars.a.aspect = {}: should have angle_deg, distance_m"),
        ("radar: {aspect: {}}", ":1: radar.aspect = {}: goes with radars: {front: {aspect:"),
        (
            f"radar: {{prf_hz: 500}}\nradars: {{a: {{}}, b: {BOARD}}}",
            "radar.prf_hz = 500: is unknown with radar.cfg, which gives it; it is a key of",
        ),
        (
            "radars:\n  a: {}\n  b: {maps: [range_azimuth]}",
            ':3: radars.b.maps = ["range_azimuth"]: should be some of',
        ),
        ("radars: {a: {waveform: impulse}}", "radars.a.profile_m: is required"),
        (
            "radars: {a: {aspect: {angle_deg: 90}}}",
            'radars.a.aspect = {"angle_deg": 90}: should have distance_m, about_m, too',
        ),
        (
            "radars: {a: {aspect: {angle_deg: x, distance_m: 0, about_m: 3}}}",
            "radars.a.aspect.distance_m = 0: should be a number above 0, one for all scenes",
        ),
        (
            f"radars: {{a: {BOARD[:-1]}, yaw_deg: 3, "
            "aspect: {angle_deg: 0, distance_m: 3, about_m: [3, 0]}}}",
            "radars.a.yaw_deg = 3: should be left out with aspect",
        ),
        ("radars: {" + ", ".join(f"r{n}: {{}}" for n in range(9)) + "}", "8 radars at most"),
        ("radars: {a: {cfg: none.cfg}}", ':1: radar.cfg = "none.cfg": should be the path'),
        ("other_radars: {b: {}}", "other_radars"),
    ],
)
def test_mistake_is_told_once_with_the_key_of_the_file(tmp_path, text, message):
    with pytest.raises(ConfigError) as error:
        load_radars(file_of(tmp_path, text))
    lines = str(error.value).splitlines()
    assert [line for line in lines if message in line], lines
    if "angel_deg" in text or "angle_deg: x, distance_m: 3" in text:
        assert len(lines) == 1
    assert len(lines) == len({*lines})


def test_a_shared_key_names_the_radar_that_has_it_not(tmp_path):
    text = f"radar: {{prf_hz: 500}}\nradars: {{a: {{}}, b: {BOARD}}}"
    with pytest.raises(ConfigError, match=r"radar\.prf_hz = 500: is .* \(radars\.b\)$"):
        load_radars(file_of(tmp_path, text))


def test_null_takes_an_aspect_off_an_entry(tmp_path):
    aspect = "{angle_deg: 90, distance_m: 3, about_m: [3, 0]}"
    entries = "radars: {a: {}, b: {aspect: null, yaw_deg: 30}}"
    text = f"radar: {{{BOARD[1:-1]}, aspect: {aspect}}}\n{entries}\nmaps: [stft]"
    configs = load_radars(file_of(tmp_path, text))
    assert [config.radar.yaw_deg for config in configs.values()] == [90, 30]


OTHER_KINDS = {
    "fmcw": {},
    "sfcw": {"waveform": "sfcw", "steps": 64, "dwell_s": 1e-6},
    "cw": {"waveform": "cw"},
    "impulse": {"waveform": "impulse", "profile_m": [0, 6], "output": "iq"},
    "frames": {"frame": {"chirps": 32}, "chirp_s": 1e-4, "adc_rate_hz": 1e6},
}


@pytest.mark.parametrize("kind", OTHER_KINDS)
def test_null_takes_keys_of_other_kinds_off_an_entry(tmp_path, kind):
    """An entry of another kind than `radar` leaves out what only a board has."""
    board = {"cfg": "iwr1843boost", "device": "IWR1843BOOST", "subframe": 0}
    document = {"radar": board, "radars": {"board": {"maps": ["range_doppler"]}}}
    nulls = dict.fromkeys(board)
    maps = ["rtm"] if kind == "impulse" else ["stft"]
    document["radars"]["other"] = {**nulls, **OTHER_KINDS[kind], "maps": maps}
    configs = load_radars(file_of(tmp_path, yaml.safe_dump(document)))
    assert (
        configs["other"].radar
        == Config.model_validate({"radar": OTHER_KINDS[kind], "maps": maps}).radar
    )
    del document["radars"]["other"]["device"]
    path = file_of(tmp_path, yaml.safe_dump(document))
    with pytest.raises(ConfigError, match=r"radar\.device = .* device: null leaves out that of"):
        load_radars(path)


def test_mistake_of_an_override_names_it(tmp_path):
    path = file_of(tmp_path, "radars: {a: {}, b: {}}")
    with pytest.raises(ConfigError, match=r"^--set radars.b.prf_hz = \"x\": should"):
        load_radars(path, ["radars.b.prf_hz=x"])


def test_an_override_makes_no_radar_of_a_mistyped_name(tmp_path):
    path = file_of(tmp_path, "radars: {front: {}, side: {}}")
    with pytest.raises(ConfigError, match=r"^--set radars\.sid\.prf_hz: sid is none of .* 'side'"):
        load_radars(path, ["radars.sid.prf_hz=500"])
    with pytest.raises(ConfigError, match=r"it has front, side$"):
        load_radars(path, ["radars.x4.prf_hz=500"])


@pytest.mark.parametrize("angle_deg", [0, 45, 90, -120])
@pytest.mark.parametrize(
    "radar", ["{beam: {pan_deg: 0}}", "{waveform: cw}", BOARD, "{frame: {chirps: 64}}"]
)
def test_aspect_looks_at_the_place_from_its_distance(tmp_path, radar, angle_deg):
    aspect = f"{{angle_deg: {angle_deg}, distance_m: 4, about_m: [3, 1]}}"
    text = f"radar: {radar}\nradars: {{a: {{aspect: {aspect}}}}}\nmaps: [stft]\n"
    config = load_config(file_of(tmp_path, text))
    antennas = antennas_of(nominal_scene(config, config.chosen_activities[0]))
    ahead = np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    middle = np.mean(antennas.places, axis=0)[:2]
    tolerance = 0.05 if "cfg" in radar else 1e-9  # of the first channel of a board
    assert middle + 4 * ahead == pytest.approx([3, 1], abs=tolerance)
    if antennas.aim is not None:
        assert antennas.aim.axes[0][:2] == pytest.approx(ahead)
    across = np.subtract(antennas.rx, antennas.tx)[:2]
    assert across @ ahead == pytest.approx(0, abs=1e-9)


def test_an_entry_may_be_a_board_by_a_path(tmp_path):
    from radhar_cli.config.documents import RADARS

    (tmp_path / "own.cfg").write_text(RADARS["iwr1843boost"].read_text())
    text = {"radars": {"a": {"cfg": "own.cfg", "device": "IWR1843BOOST"}, "b": {}}}
    configs = load_radars(file_of(tmp_path, yaml.safe_dump(text)))
    assert configs["a"].radar.kind == "board"
    bad = RADARS["iwr1843boost"].read_text().replace("frameCfg", "frameCfgs")
    (tmp_path / "own.cfg").write_text(bad)
    with pytest.raises(ConfigError, match=r"^own\.cfg"):
        load_radars(file_of(tmp_path, yaml.safe_dump(text)))
