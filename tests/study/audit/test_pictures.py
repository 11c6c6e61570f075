"""Margins and noise of images: bodies are no noise, and noise is measured as it is."""

import numpy as np
import pytest
from study.audit.trees import body

from radhar_cli.config import Config
from radhar_cli.config.image import ImageConfig
from radhar_cli.study.audit.pictures import (
    FAR,
    SIDE,
    band_contrast,
    bands_far_from_bodies,
    picture_evidence,
    picture_features,
    select_noise,
)

ALL = list(range(SIDE))


def levels_of(values):
    return np.clip(values, 0, 255).astype(np.uint8)


def test_bands_far_from_bodies_are_not_those_in_the_middle():
    rng = np.random.default_rng(0)
    contrast = np.stack([band_contrast(levels_of(body(rng, 64))) for _ in range(40)])
    bands = bands_far_from_bodies(contrast)
    assert len(bands) == FAR
    assert not set(bands) & set(range(13, 19))


def test_a_steady_line_is_a_body_too():
    levels = levels_of(np.random.default_rng(0).normal(40, 5, (64, 64)))
    levels[30:32] = 255
    assert band_contrast(levels)[15] > 3 * np.median(band_contrast(levels))


def test_cells_of_a_body_are_no_noise():
    rng = np.random.default_rng(1)
    noise = rng.normal(60, 10, (64, 64))
    noise[40:46, 20:30] = 240
    is_noise = select_noise(levels_of(noise), ALL)
    assert not is_noise[39:47, 19:31].any()
    assert is_noise.mean() > 0.8


@pytest.mark.parametrize("size", [(5, 7), (16, 16), (64, 48), (300, 20)])
def test_images_of_any_size(size):
    levels = levels_of(np.random.default_rng(2).normal(90, 20, size))
    found = picture_features(levels, ALL[:FAR], None)
    vectors = {**vars(found), **found.marks._asdict()}
    del vectors["marks"]
    for vector in vectors.values():
        assert vector.ndim == 1


def test_dark_images_have_no_texture():
    found = picture_features(np.zeros((40, 40), np.uint8), ALL, None)
    assert np.isnan(found.noise_texture).all()
    assert found.noise_level[0] == 0


def test_neighbours_alike_are_seen_in_the_texture():
    white = np.random.default_rng(3).normal(100, 15, (64, 65))
    alone = picture_features(levels_of(white[:, 1:]), ALL, None).noise_texture
    smooth = 100 + np.sqrt(0.5) * (white[:, 1:] + white[:, :-1] - 200)
    alike = picture_features(levels_of(smooth), ALL, None).noise_texture
    assert abs(alone[9]) < 0.1
    assert alike[9] == pytest.approx(0.5, abs=0.12)


ONE_LAW = "it may be the movement: noise has one law for all classes"
PEAK = "image.reference: noise, as levels are relative to each image's peak"


@pytest.mark.parametrize(
    ("image", "advice"),
    [
        (ImageConfig(), f"{ONE_LAW}, and the level is how much moves beside the noise"),
        (ImageConfig(reference="peak"), PEAK),
        (ImageConfig(reference={"dbm": -60.0}), ONE_LAW),
        (ImageConfig(kind="cfar"), ONE_LAW),
        (None, "snr_db: {uniform: [0, 30]}, one law for all classes"),
    ],
)
def test_advice_on_levels_is_what_the_config_does_not_do_yet(image, advice):
    rng = np.random.default_rng(0)
    features = [picture_features(levels_of(body(rng)), ALL, None) for _ in range(4)]
    evidence = picture_evidence(features, np.arange(4) % 2, (48, 48), True, image)
    by_level = {"levels: mean, spread", "noise: its level", "rows far from bodies"}
    cures = {one.name: one.cure for one in evidence}
    assert {cures[name] for name in by_level} == {advice}


@pytest.mark.parametrize("key", ["snr_db", "receiver.noise_figure_db"])
def test_noise_has_one_law_for_all_classes(key):
    """By which advice on levels names no key of noise where the config is known."""
    section, _, name = key.rpartition(".")
    by_class = {name: {"per_activity": {"default": 30.0, "walking": 10.0}}}
    with pytest.raises(ValueError, match=f"(?s){key}.*should be a number"):
        Config(activities=["walking"], **({section: by_class} if section else by_class))
