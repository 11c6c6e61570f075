"""scripts/studies/make_networks.py at a tiny size."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import pytest
from helpers import command_line

SCRIPT = command_line.ROOT / "scripts/studies/make_networks.py"


@pytest.mark.slow
def test_weights_are_small_described_and_can_be_used(tmp_path: Path) -> None:
    tiny = ("--only", "quickstart", "--per-class", "7", "--epochs", "1")
    command = [sys.executable, str(SCRIPT), "-o", str(tmp_path), *tiny]
    subprocess.run(command, check=True, capture_output=True, timeout=500)
    weights, unseen = tmp_path / "quickstart.safetensors", tmp_path / "work/quickstart/unseen"
    assert weights.stat().st_size < 2e6
    card = (tmp_path / "quickstart.md").read_text()
    assert hashlib.sha256(weights.read_bytes()).hexdigest() in card
    assert "make_networks.py -o OUT --only quickstart --per-class 7 --epochs 1`, commit" in card
    assert "## What it is not good for" in card
    done = command_line.ok("predict", weights, unseen, "--json")
    found = [json.loads(line) for line in done.stdout.splitlines()]
    correct = sum(f": {one['class']}/" in one["image"] for one in found)
    assert len(found) == 84
    assert f"| simulated, another seed | {correct / 84:.1%} |" in card
