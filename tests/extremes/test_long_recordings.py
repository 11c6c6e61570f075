"""Ten million pulses: memory does not grow with the recording beyond a few arrays of its length.

A process of its own each, so that its peak is its own; scene/products/test_long_recordings.py has
two million.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from helpers.peak_memory import PEAK

ROOT = Path(__file__).resolve().parents[2]
PULSES = int(os.environ.get("RADHAR_LONG_PULSES", 10_000_000))
LIMIT_BYTES = 2**30
PRF = 5000

PROGRAM = (
    PEAK
    + """
import json, sys
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.config import Config
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.products.run import run
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.processes.worker_process import prepare_process

prepare_process()
config = Config.model_validate(json.loads(sys.argv[1]))
scene, _ = draw_valid_scene(config, activity_named("body_rotating"), 0)
(name,) = config.maps
image = run(plan_images(config), {"scene": scene})[f"image:{name}"]
print(json.dumps({
    "peak": peak(),
    "shape": image.levels.shape,
    "levels": [int(image.levels.min()), int(image.levels.max())],
    "entropy": image.entropy,
}))
"""
)


def measured(engine: str, name: str) -> dict[str, Any]:
    """Peak memory and outcome of one sample of a person who turns on the spot."""
    document = {
        "duration_s": PULSES / PRF,
        "radar": {"prf_hz": PRF, "adc_rate_hz": 2e5},  # 8 samples a chirp
        "motion": {"model": "paper"},  # `human` ends at 600 s
        "engine": {"kind": engine},
        "image": {"size_px": 64},
        "maps": [name],
    }
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(document)],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize(
    ("engine", "name"), [("direct", "stft"), ("direct", "fsst"), ("cube", "stft")]
)
def test_peak_memory(engine: str, name: str) -> None:
    found = measured(engine, name)
    print(f"{PULSES} pulses, {engine}, {name}: {found['peak'] / 2**20:.0f} MiB at most")
    assert found["shape"] == [64, 64]
    assert 102 < found["levels"][1] <= 255  # relative to the noise
    assert found["levels"][0] < 255
    assert 0 < found["entropy"] < 60
    assert found["peak"] < LIMIT_BYTES
