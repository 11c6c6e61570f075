"""Peak resident memory and time of one long recording, each in a process of its own.

    python scripts/bench_memory.py [--pulses 1e7] [--only 'stft; fsst']

A sample of configs/paper/free_space.yaml, as long as `--pulses` at 5 kHz, from scene to levels.
The cube engine has 8 samples a chirp; `hop 1` is the paper's 4 s with the FSST at every sample.
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from radhar_cli.activity import activity_named
from radhar_cli.config import MAP_NAMES, load_config
from radhar_cli.dataset.sample import synthesise
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.worker_process import prepare_process

ROOT = Path(__file__).resolve().parents[1]
PAPER = ROOT / "configs/paper/free_space.yaml"
PRF = 5000
CUBE = ["engine.kind=cube", "radar.adc_rate_hz=8e4", "radar.chirp_s=1e-4"]
DOPPLER = ",".join(name for name in MAP_NAMES if name != "rtm")
# label: (maps, further settings, whether it is of --pulses)
ROWS: dict[str, tuple[str, list[str], bool]] = {
    "stft": ("stft", [], True),
    "fsst": ("fsst", [], True),
    "stft, fsst": ("stft,fsst", [], True),
    "all eight": (DOPPLER, [], True),
    "cube, all nine": (",".join(MAP_NAMES), CUBE, True),
    "hop 1": ("fsst", ["processing.fsst_hop_pulses=1"], False),
}


def measure(label: str, pulses: int) -> dict[str, float]:
    """One sample, here and now."""
    maps, more, long = ROWS[label]
    duration = [f"duration_s={pulses / PRF}"] if long else []
    config = load_config(PAPER, [f"maps=[{maps}]", *duration, *more])
    prepare_process()
    start = time.perf_counter()
    punching = activity_named("punching")  # who walks for half an hour leaves the range
    scene, _ = draw_valid_scene(config, punching, 0)
    synthesise(scene, plan_images(config))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"peak_mib": peak, "seconds": time.perf_counter() - start}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--pulses", type=float, default=1e7)
    parser.add_argument("--only", help="rows, semicolon separated: " + "; ".join(ROWS))
    parser.add_argument("--json", type=Path, default=Path("build/bench_memory.json"))
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one, int(arguments.pulses))))
        return
    rows: dict[str, Any] = {}
    labels = [name.strip() for name in arguments.only.split(";")] if arguments.only else list(ROWS)
    for label in labels:
        command = [sys.executable, __file__, "--one", label, "--pulses", str(arguments.pulses)]
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
        rows[label] = json.loads(done.stdout)
        row = rows[label]
        print(f"{label:<20}{row['peak_mib']:8.0f} MiB{row['seconds']:8.1f} s", flush=True)
    arguments.json.parent.mkdir(parents=True, exist_ok=True)
    arguments.json.write_text(json.dumps(rows, indent=2))


if __name__ == "__main__":
    main()
