"""The benchmark of boards in rooms: its configs are read, and a short scene of each is timed."""

from pathlib import Path

import bench_rooms as bench
import pytest

from radhar_cli.config import load_config
from radhar_cli.scene.room import names_of_ways
from radhar_cli.scene.scene import nominal_scene


@pytest.mark.parametrize("name", bench.DOCUMENTS)
def test_a_room_of_six_faces_before_an_isk(name: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(bench.DOCUMENTS[name])
    config = load_config(path)
    assert len(names_of_ways(nominal_scene(config, config.chosen_activities[0]))) == 13
    assert len(config.people) == (name in ("people", "dry"))


def test_the_echo_of_a_scene_is_timed(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    text = bench.DOCUMENTS["walker"].replace("duration_s: 12", "duration_s: 0.1")
    path.write_text(text.replace("scatterers: surfaces", "scatterers: points"))
    found = bench.measure_scene(bench.ROOT, path, "echo")
    assert found["s"] > 0
    assert found["ms a frame, this step"] > 0
