"""Configs and images damaged at random: a right result or a clear refusal, nothing else."""

import io
import json
import random
from pathlib import Path

import numpy as np
import pytest
from learning.patterns import stripes
from PIL import Image
from security.bounded import limited
from security.mutations import mutate_image, mutate_yaml

from radhar_cli.config import Config, load_config, resolved
from radhar_cli.config.reading import load_section
from radhar_cli.dataset.image_file import MAX_SIDE, image_size, read_rgb
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.learning.settings import TrainConfig

ROOT = Path(__file__).resolve().parents[2]
CONFIGS = sorted((ROOT / "configs").rglob("*.yaml"))
ALIASES = "motion:\n  paper:\n    thigh_deg: &a {normal: [30, 5], min: 20}\n    calf_deg: *a\n"
# (first case, cases): a fiftieth of them in every run.
RUNS = [(0, 40), pytest.param(40, 960, marks=pytest.mark.slow)]


def clear(error: RadharError, path: Path) -> None:
    """A message that starts with the file in every line, and is no longer than a screen."""
    lines = str(error).split("\n")
    assert all(line.startswith(str(path)) for line in lines), lines
    assert max(map(len, lines)) < 1000
    assert len(lines) <= 30


def pictures() -> dict[str, bytes]:
    """Small images of every format that is read, in several modes."""
    picture = Image.fromarray(stripes(1, np.random.default_rng(0)))
    found = {}
    for mode in ("RGB", "L", "P", "1", "LA", "RGBA", "I;16", "CMYK"):
        wide = np.arange(32 * 32, dtype=np.uint16).reshape(32, 32) * 60
        image = Image.fromarray(wide) if mode == "I;16" else picture.convert(mode)
        for kind, more in {
            "PNG": {},
            "JPEG": {"progressive": True},
            "BMP": {},
            "TIFF": {"compression": "tiff_deflate"},
            "TIFF ": {"compression": "tiff_lzw"},
            "WEBP": {"lossless": True},
        }.items():
            buffer = io.BytesIO()
            try:
                image.save(buffer, kind.strip(), **more)
            except OSError:  # a mode that the format does not have
                continue
            found[f"{kind} {mode}"] = buffer.getvalue()
    return found


@pytest.mark.parametrize(("first", "count"), RUNS)
def test_a_damaged_config_is_read_or_refused(tmp_path: Path, first: int, count: int) -> None:
    path, refused = tmp_path / "x.yaml", 0
    for case in range(first, first + count):
        rng = random.Random(case)
        source = rng.choice(CONFIGS)
        text = source.read_text() + rng.choice(("", ALIASES))
        path.write_text(mutate_yaml(rng, text), encoding="utf-8")
        training = source.parent.name == "train"
        try:
            with limited():
                config = load_section(TrainConfig, path) if training else load_config(path)
        except ConfigError as error:
            refused += 1
            clear(error, path)
            continue
        if training:
            assert TrainConfig.model_validate(resolved(config)) == config
        else:
            assert Config.model_validate(json.loads(json.dumps(resolved(config)))) == config
    assert 0.3 * count < refused < count


@pytest.mark.parametrize(("first", "count"), RUNS)
def test_a_damaged_image_is_read_or_refused(tmp_path: Path, first: int, count: int) -> None:
    whole, refused = pictures(), 0
    assert len(whole) > 20
    for case in range(first, first + count):
        rng = random.Random(case)
        name = rng.choice(sorted(whole))
        path = tmp_path / f"x.{name[:3].lower()}"
        path.write_bytes(mutate_image(rng, whole[name]))
        try:
            with limited():
                size = image_size(path)
                rgb = read_rgb(path)
        except FolderError as error:
            refused += 1
            clear(error, path)
            continue
        assert rgb.dtype == np.uint8
        assert rgb.shape == (*size, 3)
        assert max(size) <= MAX_SIDE
    assert 0.2 * count < refused < count
