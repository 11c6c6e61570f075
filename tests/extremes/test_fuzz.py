"""Random configs through the whole chain: finite maps, or a refusal that names its key."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from helpers import reference as ref
from helpers.extreme_scenes import ENGINES
from helpers.random_configs import KEYS, Document, Drawer
from helpers.slow import slow

from radhar_cli.config import MAP_NAMES, Config, load_config
from radhar_cli.config.reading import validated
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.scene.checks import drawing
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.warnings import scene_warnings
from radhar_cli.scene.products.run import Results, run
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import draw_scene

SEED = 20261121
BLOCKS, CONFIGS = 10, 220
AGREEING_BLOCKS, AGREEING = 4, 60
DIRECT_DB = -60.0
MAX_CYCLES = 1e10  # beyond, the phases of either engine are off by 1e-6 of a cycle and more
BROKEN = 0.2  # share of the documents in which one key is replaced by junk
ALL_MAPS = 0.3  # share of the recordings that make all nine maps
LEAST_MAPPED = 0.5  # nothing is gained where everything is refused
LEAST_NAMED = 0.8
FAULT = re.compile(r"^\S*: (?P<key>[\w.]+) = .+: .+")
NAMES_A_KEY = re.compile("|".join(re.escape(key) for key in KEYS))


def read(document: Document, drawer: Drawer, folder: Path) -> Config:
    """The config of a document, through a YAML file or straight from the values."""
    if drawer.chance(0.5):
        path = folder / "fuzz.yaml"
        path.write_text(yaml.safe_dump(document))
        return load_config(path)
    return validated(Config, document, "fuzz", {})


def record(config: Config, drawer: Drawer) -> Results:
    """One sample: drawn, checked and run as a data set does."""
    if drawer.chance(ALL_MAPS):
        document = config.model_dump(mode="json") | {"maps": list(MAP_NAMES)}
        config = validated(Config, document, "fuzz", {})
    activity = drawer.pick(config.chosen_activities)
    index = int(drawer.rng.integers(config.samples_per_class))
    scene, _ = draw_valid_scene(config, activity, index)
    scene_warnings(scene)
    if drawer.chance(0.5):
        return run(plan_images(config), {"scene": scene})
    both = [kind + name for name in config.maps for kind in ("", "image:")]
    return record_scene(scene, [*both, "paths"])


def assert_finite(recording: Results, size: tuple[int, int], masks: bool) -> None:
    products: dict[str, Any] = recording.products
    images = [name for name in products if name.startswith("image:")]
    assert images
    for image in images:
        levels, entropy = products[image].levels, products[image].entropy
        assert levels.dtype == np.uint8
        assert levels.shape == size
        assert np.isfinite(entropy)
        assert entropy >= 0
        name = image.removeprefix("image:")
        if name not in products:  # an image's plan may hold no whole map
            continue
        power = products[name].power
        assert power.size
        assert np.isfinite(power).all()
        assert power.min() >= 0
        assert entropy <= math.log2(power.size) + 1e-5  # images of the STFT are made in float32
        # In physical units the square of an echo below 1e-162 vanishes; its image does not.
        if masks:
            assert np.isin(levels, (0, 255)).all()
        elif power.any():
            assert levels.max() >= 102  # that of the noise floor
        elif levels.any():
            assert products["paths"](np.zeros(1)).amplitude.max() < 1e-150


def assert_clear(error: RadharError) -> list[str]:
    """One line a mistake; each names a key, its value and what would be right. Returns the keys."""
    lines = str(error).splitlines()
    if isinstance(error, ConfigError):
        matches = [FAULT.match(line) for line in lines]
        assert all(matches), lines
        return [match["key"] for match in matches if match]
    assert re.search(r"\d", lines[0]), lines
    keys = NAMES_A_KEY.findall(lines[0])
    assert keys, lines
    return keys


def names(keys: list[str], broken: str) -> bool:
    """Whether the broken key, one inside of it or the section around it is among `keys`."""
    pairs = [(key, broken) for key in keys] + [(broken, key) for key in keys]
    return any(f"{inner}.".startswith(f"{outer}.") for inner, outer in pairs)


@pytest.mark.parametrize("block", [0, *slow(range(1, BLOCKS))])
def test_maps_or_a_clear_refusal(
    block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing, "MAX_ATTEMPTS", 10)  # `on_invalid: redraw` draws 1000 times
    drawer = Drawer(SEED, block)
    mapped = refused = broken_refused = named = 0
    for _ in range(CONFIGS):
        broken: str | None = None
        if drawer.chance(BROKEN):
            document, broken = drawer.broken()
        else:
            document = drawer.document()
        try:
            config = read(document, drawer, tmp_path)
            recording = record(config, drawer)
        except RadharError as error:
            keys = assert_clear(error)
            refused += 1
            if broken:
                broken_refused += 1
                named += names(keys, broken)
        else:
            assert_finite(recording, config.image.size_px, config.image.kind == "cfar")
            mapped += 1
    print(
        f"block {block}: {mapped} of {CONFIGS} configs reached finite maps, {refused} were "
        f"refused; of {broken_refused} with a spoilt key {named} name it, the others a key that "
        "no longer fits it"
    )
    assert mapped >= LEAST_MAPPED * CONFIGS
    assert broken_refused >= 0.1 * CONFIGS
    assert named >= LEAST_NAMED * broken_refused


def cycles(recording: Results) -> float:
    """Largest phase of a path: what is left of it to a double is 1e-16 of this."""
    w = recording["waveform"]
    delay = recording["paths"](w.times(np.arange(w.n_pulses) + 0.0)).delay.max()
    return float(w.f0 * delay + 0.5 * w.slope * delay**2 * w.residual_video_phase)


@pytest.mark.parametrize("block", [0, *slow(range(1, AGREEING_BLOCKS))])
def test_direct_keeps_its_promise_or_refuses(block: int) -> None:
    """Random scenes over all ranges, noiseless, after MTI: within -60 dB of the cube."""
    drawer = Drawer(SEED, BLOCKS + block)
    compared = refused = rounded = 0
    worst = -math.inf
    for _ in range(AGREEING):
        document = drawer.document() | {"snr_db": None}
        document["processing"]["clutter"] = "difference"
        found = []
        try:
            for kind in ("cube", "direct"):
                config = validated(Config, document | {"engine": ENGINES[kind]}, "fuzz", {})
                scene = draw_scene(config, config.chosen_activities[-1], 0)
                scene_warnings(scene)
                found.append(record_scene(scene, ["paths", "waveform", "signal"]))
        except RadharError as error:
            assert_clear(error)
            refused += 1
            continue
        right, direct = (recording["signal"].x[0, 0] for recording in found)
        if cycles(found[0]) > MAX_CYCLES:
            rounded += 1
            continue
        compared += 1
        if not right.any():
            assert not direct.any()
            continue
        largest = np.abs(right).max()  # the square of 1e-200 is no double
        error_db = ref.error_db(direct / largest, right / largest)
        assert error_db < DIRECT_DB, document
        worst = max(worst, error_db)
    print(
        f"block {block}: {compared} scenes, direct {worst:.0f} dB at worst; {refused} refused, "
        f"{rounded} beyond {MAX_CYCLES:g} cycles"
    )
    assert compared >= LEAST_MAPPED * AGREEING
