"""The page of `radhar view` and `simulate --html`: its content, and a browser."""

import base64
import gzip
import html
import json
import re
import shutil
import subprocess
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ROOT, ok, radhar
from helpers.small import edited, small_config

from radhar_cli.config import load_config
from radhar_cli.figures.scene_page import of_simulation, write_page
from radhar_cli.scene.single.simulate import simulate

pytest.importorskip("plotly", reason="needs radhar[view]")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))), None)
BOARD = ROOT / "configs/boards/iwr1443.yaml"
FOREIGN = "</script><script>document.title = 'run'</script><img src=x onerror=see(1)><b>&lt;"


def packed(page: str, name: str) -> str:
    """What a script element of the page holds."""
    found = re.search(rf'<script type="text/plain" id="{name}">([^<]*)<', page)
    assert found
    return gzip.decompress(base64.b64decode(found[1])).decode()


def scenes(path: Path) -> list[dict]:
    return json.loads(packed(path.read_text(), "scenes"))


def headings(maps: list[dict]) -> list[str]:
    return [one["layout"]["title"]["text"] for one in maps]


@pytest.fixture(scope="module")
def board():
    """What the page shows of half a second of a board: two maps over time, three of frames."""
    frames = ("range_doppler", "range_azimuth", "range_elevation")
    maps = ("rtm", "stft", *frames, "points")
    return of_simulation(simulate(load_config(BOARD, ["duration_s=0.5"]), "punching", maps=maps))


def test_simulate_writes_a_page_that_needs_nothing_else(tmp_path):
    config, out = small_config(tmp_path), tmp_path / "out"
    what = ("simulate", config, "-a", "walking", "--html", "--no-figures", "--maps", "stft,rtm")
    done = ok(*what, "-o", out, "--json")
    page = out / "view.html"
    assert str(page) in json.loads(done.stdout)["files"]
    text = page.read_text()
    assert "default-src 'none'" in text
    assert not re.search(r"(src|href)\s*=|https?:|@import|url\(", text)
    assert "Licensed under the MIT license" in packed(text, "plotly")
    assert len(text) < 4e6
    ok(*what, "-o", tmp_path / "again")
    assert (tmp_path / "again/view.html").read_text() == text
    ok(*what[:4], "--no-figures", "--maps", "rtm", "-o", out, "--overwrite")
    assert not page.exists(), "that of an earlier scene"


def test_a_page_shows_the_truth_of_everybody():
    made = simulate(ROOT / "configs/human/people.yaml", "walking", maps=("rtm", "stft_compensated"))
    shown = of_simulation(made)
    people = [f"{one.activity.label} {one.activity.slug}" for one in made.scene.people]
    space, rtm, stft = shown["plots"]
    assert [one["name"] for one in space["data"]] == [*people, "radar"]
    frame = 30
    pulse = round(shown["time"][frame] * made.waveform.prf)
    own = space["moves"][0]["frames"]
    places = np.stack([own[axis][frame][1::3] for axis in "xyz"], axis=1)
    assert np.abs(places - made.truth.positions[pulse]).max() < 2e-3
    speed = own["marker.color"][frame][1::3]
    assert np.abs(speed + made.truth.radial_velocity[pulse]).max() < 0.05
    assert np.median(np.diff(shown["time"])) == pytest.approx(0.04, abs=2e-3)
    assert rtm["layout"]["yaxis"]["title"]["text"] == "range (m)"
    key, torso, *_ = stft["data"][1:]
    assert key["name"] == "true Doppler: click"
    assert np.abs(torso["y"]).max() < 1e-9, "the torso's Doppler is compensated"
    z = stft["data"][0]["z"]
    height, width = map(int, z["shape"].split(","))
    power = np.frombuffer(base64.b64decode(z["bdata"]), np.float32).reshape(height, width)
    own_power = power[height // 2 - 3 : height // 2 + 3].max(axis=0).mean()
    assert own_power > power.mean() + 10, "dB: the compensated torso is in the middle"


def test_points_lie_on_the_body_of_a_tilted_board():
    tilted = ["duration_s=0.5", "radar.tilt_deg=15", "radar.yaw_deg=10"]
    shown = of_simulation(simulate(load_config(BOARD, tilted), "punching", maps=("points",)))
    body, points = (
        np.stack([one["frames"][axis][one["at"][12]] for axis in "xyz"], axis=1)
        for one in shown["plots"][0]["moves"]
    )
    apart = np.linalg.norm(points[:, None] - body[1::3], axis=2).min(axis=1)
    assert len(points) > 3
    assert np.median(apart) < 0.3


def test_view_shows_the_first_sample_of_each_class(small_set, tmp_path):
    page = tmp_path / "page.html"
    done = json.loads(ok("view", small_set, "-o", page, "--json").stdout)
    assert done == {"file": str(page), "samples": 3}
    found = scenes(page)
    titles = [one["title"].partition(",")[0] for one in found]
    assert titles == ["S2 punching/0", "S8 walking/0", "S12 walking_to_falling/0"]
    space, *maps = found[1]["plots"]
    assert headings(maps) == ["range-time map", "STFT", "FSST, compensated"]
    assert float(found[1]["numbers"]["motion.walking.speed_mps"]) > 0
    assert [one["name"] for one in space["data"]] == ["S8 walking", "radar"]
    refused = radhar("view", small_set, "-o", page)
    assert refused.returncode == 2
    assert f"{page}: already exists; --overwrite replaces it" in refused.stderr
    ok("view", small_set, "-o", page, "--overwrite", "--sample", "S8/2", "--sample", "punching/1")
    assert [one["title"][:9] for one in scenes(page)] == ["S8 walkin", "S2 punchi"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--sample", "walking/3"), "--sample walking/3: should be walking/0 to walking/2"),
        (("--sample", "dancing/0"), "--sample dancing/0: no such class; there are "),
        (("--sample", "walkin/3"), "walkin/3: no such class; did you mean 'walking'?"),
        (("--sample", "walking/0") * 51, "--sample: 51 samples; a page holds 50 at most"),
    ],
)
def test_view_says_what_it_cannot_show(small_set, options, said, tmp_path):
    refused = radhar("view", small_set, "-o", tmp_path / "page.html", *options)
    assert refused.returncode == 2
    assert said in refused.stderr
    assert refused.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("boxing", "--sample: boxing is taken for punching, which the data set has\n"),
        (
            "shadow boxing",
            "--sample: shadow boxing is taken for punching, which the data set has\n",
        ),
        ("punching", ""),
        ("Punching", ""),
        ("S2", ""),
    ],
)
def test_view_says_which_class_is_taken_for_another_word(small_set, word, said, tmp_path):
    done = ok("view", small_set, "--sample", f"{word}/1", "-o", tmp_path / "view.html")
    assert done.stderr == said
    (scene,) = scenes(tmp_path / "view.html")
    assert "punching/1" in json.dumps(scene)


def test_a_skeleton_is_of_the_stored_scene_or_not_there(small_set, tmp_path):
    with edited(small_set / "dataset.h5", tmp_path / "dataset.h5") as file:
        file["scene/snr"][0] = 29.5
    ok("view", tmp_path / "dataset.h5", "--sample", "punching/0")
    (shown,) = scenes(tmp_path / "view.html")
    assert "draws another scene than the one stored" in shown["notes"][0]
    assert headings(shown["plots"]) == ["range-time map", "STFT", "FSST, compensated"]
    assert shown["time"][-1] == pytest.approx(4, abs=0.1)


def test_motion_files_that_a_data_set_names_are_not_opened(tmp_path):
    config = small_config(tmp_path)
    ok("motion", config, "-a", "punching", "-o", tmp_path / "wave.bvh")
    board = f"base: {BOARD}\nactivities: [wave]\nsamples_per_class: 1\nduration_s: 0.5\n"
    config.write_text(board + "classes: {wave: {files: [wave.bvh]}}\nimage: {size_px: 32}\n")
    ok("generate", config, "-o", tmp_path / "set", "--jobs", 1)
    (tmp_path / "wave.bvh").unlink()
    ok("view", tmp_path / "set")
    (shown,) = scenes(tmp_path / "set/view.html")
    assert shown["notes"] == ["Motion files are not opened: joints are those that are stored."]
    space, *maps = shown["plots"]
    joints = np.array(space["moves"][0]["frames"]["x"], float)
    assert joints.shape == (len(shown["time"]), 13 * 3)
    assert space["layout"]["scene"]["xaxis"]["title"]["text"] == "ahead (m)"
    assert headings(maps) == ["STFT", "range-Doppler", "range-azimuth"]
    with edited(tmp_path / "set/dataset.h5", tmp_path / "dataset.h5") as file:
        points = file["products/points"][:, :3]
        del file["products/points"]
        file["products/points"] = points
    refused = radhar("view", tmp_path / "dataset.h5")
    assert refused.returncode == 2
    assert "dataset.h5: /products/points: should be numbers [n, 8]" in refused.stderr


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium: apt-get install chromium")
def test_a_browser_moves_all_views_and_takes_texts_as_texts(board, tmp_path):
    foreign = deepcopy({**board, "title": FOREIGN, "notes": [FOREIGN]})
    foreign["numbers"] = {FOREIGN: FOREIGN}
    space, *maps = foreign["plots"]
    for one in maps:
        one["layout"]["title"]["text"] = FOREIGN
    person = space["data"][0]
    joints = len(person["text"]) // 3
    person |= {"name": FOREIGN, "text": [FOREIGN] * 3 * joints}
    page = tmp_path / "page.html"
    write_page([board, foreign], page)
    drive = Path(__file__).with_name("drive_page.js").read_text()
    page.write_text(page.read_text().replace("<title>", f"<script>{drive}</script><title>", 1))
    flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-sync"
    flags += " --disable-background-networking --disable-component-update --dump-dom"
    flags += " --enable-unsafe-swiftshader --virtual-time-budget=60000 --window-size=1400,900"
    command = [CHROMIUM, *flags.split(), f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    dumped = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.S)
    assert dumped, done.stderr[-2000:]
    found = json.loads(html.unescape(dumped[1]))
    assert found["wrong"] == []
    moved = found["moved"]
    assert moved.pop("traces") == [True, True, False], "bones and points; not the radar"
    counts = {name: len(values) for name, values in moved.items()}
    assert counts == {"cursor": 2, "frames": 3, "clock": 1, "picture": 1}
    assert all(map(all, moved.values()))
    assert found["curves"] == joints
    assert found["title"] == " ".join(FOREIGN.split())
    assert found["headings"] == [FOREIGN] * len(maps)
    assert found["images"] == 0
