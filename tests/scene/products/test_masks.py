"""`image.kind: cfar` and `image.doppler_limits_mps`, from the config to maps and images."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import reference as ref
from helpers.signals import signal
from helpers.small import SMALL, small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import Config, load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.products.run import process, record
from radhar_cli.scene.scene import draw_scene, scene_numbers

RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500}
F0 = 10.5e9
FASTEST = ref.C * 500 / (4 * F0)  # 3.57 m/s
WINDOW = {"guard": [2, 2], "training": [6, 4]}
MASKS = {"size_px": 48, "kind": "cfar", "cfar": WINDOW}
ALL = ("rtm", "stft", "fsst")


def config(image: dict[str, Any], **more: Any) -> Config:
    # Through JSON, as from a file: strict numbers.
    return Config.model_validate({"radar": RADAR, "image": image} | more)


def made(image: dict[str, Any], *names: str, index: int = 0, **more: Any) -> Any:
    scene = draw_scene(config(image, **more), activity_named("walking"), index)
    return record(scene, names)


def image_of(image: dict[str, Any], name: str = "stft", **more: Any) -> Any:
    return made(image, f"image:{name}", **more)[f"image:{name}"]


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("domain", ["power", "decibel"])
def test_masks_are_binary_at_any_size_and_show_the_walker(name, domain):
    for size in ([48, 40], [33, 200]):
        mask = image_of(MASKS | {"size_px": size, "cfar": WINDOW | {"domain": domain}}, name)
        assert mask.levels.shape == tuple(size)
        assert set(np.unique(mask.levels)) == {0, 255}


def test_the_entropy_and_the_extent_are_those_of_the_map():
    mask, grey = image_of(MASKS), image_of({"size_px": 48})
    assert mask.entropy == pytest.approx(grey.entropy, abs=1e-4)
    assert mask.extent == grey.extent


def test_a_higher_threshold_sets_fewer_cells():
    def share(**threshold: Any) -> float:
        mask = image_of(MASKS | {"cfar": WINDOW | {"domain": "power"} | threshold})
        return float(np.mean(mask.levels == 255))

    shares = [share(pfa=pfa) for pfa in (0.3, 0.03, 1e-3)]
    assert shares[0] > shares[1] > shares[2] > 0


def test_the_threshold_is_a_number_of_the_scene():
    """It is drawn for each sample, whatever the others do, and fixed in the scene's config."""
    cfar = WINDOW | {"pfa": {"uniform": [0.1, 0.4]}}
    drawn = config(MASKS | {"cfar": cfar})
    scenes = [draw_scene(drawn, activity_named("walking"), index) for index in range(3)]
    rates = [scene_numbers(scene)["image.cfar.pfa"] for scene in scenes]
    assert len(set(rates)) == 3
    assert all(0.1 <= rate <= 0.4 for rate in rates)
    assert [scene.config.image.cfar.pfa for scene in scenes] == rates
    plain = draw_scene(config({"cfar": cfar}), activity_named("walking"), 0)
    assert not any(key.startswith("image.") for key in scene_numbers(plain))
    assert plain.config.motion == scenes[0].config.motion


def test_a_floor_is_a_number_only_where_it_decides():
    for cfar, there in (({}, True), ({"domain": "power"}, False)):
        scene = draw_scene(config(MASKS | {"cfar": WINDOW | cfar}), activity_named("walking"), 0)
        assert ("image.cfar.floor_db" in scene_numbers(scene)) == there


def test_recorded_signals_become_masks_too():
    rng = np.random.default_rng(0)
    noise = rng.standard_normal((2000, 2)) @ [1, 1j]
    recorded = signal(noise, 500.0, F0)
    mask = process(recorded, config(MASKS | {"cfar": WINDOW | {"floor_db": 20}}), ["image:stft"])
    assert set(np.unique(mask["image:stft"].levels)) == {0, 255}


@pytest.mark.parametrize("limits", [(-1.0, 3.0), (-FASTEST, FASTEST), (-FASTEST, 0.0)], ids=str)
def test_doppler_limits_keep_the_bins_within_and_their_axis(limits):
    names = ["rtm", "stft", "fsst", "image:stft", "image:fsst"]
    whole = made({"size_px": 32}, *names)
    found = made({"size_px": 32, "doppler_limits_mps": limits}, *names)
    low, high = limits
    for name in ("stft", "fsst"):
        speed = whole[name].rows.values * ref.C / (2 * F0)
        kept = (speed >= low - 1e-9) & (speed <= high + 1e-9)
        assert np.array_equal(found[name].rows.values, whole[name].rows.values[kept])
        assert np.array_equal(found[name].power, whole[name].power[kept])
        assert found[f"image:{name}"].extent == found[name].extent
        assert found[f"image:{name}"].entropy == pytest.approx(found[name].entropy, abs=1e-4)
    assert np.array_equal(found["rtm"].power, whole["rtm"].power)


def mistake(image: dict[str, Any], tmp_path: Path, **more: Any) -> str:
    import yaml

    path = tmp_path / "wrong.yaml"
    path.write_text(yaml.safe_dump({"radar": RADAR, "image": image} | more))
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    (line,) = str(caught.value).splitlines()
    return line


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (
            {"doppler_limits_mps": [-3.6, 3.6]},
            "image.doppler_limits_mps .* unambiguous band, -3.56",
        ),
        ({"doppler_limits_mps": [-3.6, 1.0]}, "unambiguous band"),
        ({"doppler_limits_mps": [1.0, 1.05]}, "at least 2 Doppler bins"),
        ({"doppler_limits_mps": [1.0, -1.0]}, "low < high"),
        ({"doppler_limits_mps": 1.0}, "should be a list"),
        ({"kind": "binary"}, "image.kind"),
        ({"kind": "cfar", "size_px": 64}, "image.cfar.training .* fit into the image of 64 x 64"),
        ({"kind": "cfar", "cfar": {"training": [0, 0]}}, "1 or more"),
        ({"kind": "cfar", "cfar": {"pfa": 1.5}}, "image.cfar.pfa"),
        ({"kind": "cfar", "cfar": {"pfa": {"uniform": [0, 0.5]}}}, "image.cfar.pfa"),
        ({"kind": "cfar", "cfar": {"guard": [-1, 2]}}, "image.cfar.guard"),
        ({"kind": "cfar", "cfar": {"guard": 3}}, "image.cfar.guard"),
    ],
    ids=str,
)
def test_mistakes(image, words, tmp_path):
    line = mistake(image, tmp_path)
    assert "wrong.yaml" in line
    import re

    assert re.search(words, line), line


def test_limits_hold_for_every_radar_that_is_drawn(tmp_path):
    radar = {"radar": RADAR | {"prf_hz": {"uniform": [400, 500]}}}
    assert "may be 400" in mistake({"doppler_limits_mps": [-3, 3]}, tmp_path, **radar)
    Config.model_validate(radar | {"image": {"doppler_limits_mps": [-2.8, 2.8]}})
    Config.model_validate(
        {"radar": RADAR, "image": {"doppler_limits_mps": [-9, 9]}, "maps": ["rtm"]}
    )


BINARY = SMALL.replace(
    "image: {size_px: 48}",
    "image: {size_px: 48, kind: cfar, cfar: {guard: [2, 2], training: [6, 4], "
    "pfa: {uniform: [0.2, 0.3]}}, doppler_limits_mps: [-3, 3]}",
)


def test_a_data_set_of_masks(tmp_path):
    """Levels, PNGs, columns and edges; verified."""
    chosen = load_config(small_config(tmp_path, BINARY))
    build(chosen, tmp_path / "set", 1, BarProgress())
    report = verify(tmp_path / "set", 100)
    assert report.problems == []
    assert report.pngs == 27
    with open_dataset(tmp_path / "set") as data:
        for images in data.maps.values():
            assert set(np.unique(images[:])) == {0, 255}
        rates = data.scene["cfar_pfa"][:]
        assert len(set(rates.tolist())) == 9
        assert rates.min() >= 0.2
        low, high = data.extent("stft")[2:]
        step = 500 / 200
        assert -low == pytest.approx(high)
        assert (high - step / 2) * ref.C / (2 * F0) <= 3 < (high + step / 2) * ref.C / (2 * F0)
