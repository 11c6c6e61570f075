"""What a range gate costs: `python scripts/bench_gate.py [--rounds N]`.

Times, interleaved, of a walker's image of the STFT at 77 GHz: half-band sum and gate, by the direct
engine and the cube, with 13 scatterers and with 234 (eighteen bodies within a metre, of which no
two coincide). Prints the shortest times as ratios to the half-band sum of the direct engine, and
what the direct engine's gate errs by.
"""

import argparse
from dataclasses import replace
from time import perf_counter
from typing import Any

from radhar_cli.activity import activity_named
from radhar_cli.config.schema import Config
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.physics import motion_of
from radhar_cli.pipeline.run import record
from radhar_cli.scene import Scene, nominal_scene

WAYS = {
    "half-band, direct": {},
    "half-band, cube": {"engine": {"kind": "cube"}},
    "gate +-0.5 m, direct": {"processing": {"doppler": "gate", "gate_m": 0.5}},
    "gate +-1 m, direct": {"processing": {"doppler": "gate"}},
    "gate +-1 m, high-pass, direct": {"processing": {"doppler": "gate", "clutter": "highpass"}},
    "gate +-1 m, cube": {"processing": {"doppler": "gate"}, "engine": {"kind": "cube"}},
}


def scene_of(way: dict[str, Any]) -> Scene:
    """The paper's walker, from 2 m."""
    document = {"motion": {"model": "paper", "range_m": 2.0}} | way
    return nominal_scene(Config.model_validate(document), activity_named("walking"))


def bodies(scene: Scene, count: int) -> tuple[Motion, ...]:
    """Bodies side by side."""
    one: Any = motion_of(scene.people[0])
    return tuple(replace(one, start=(2.0 + 0.013 * n, 0.05 * n)) for n in range(count))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    for count in (1, 18):
        seconds: dict[str, list[float]] = {name: [] for name in WAYS}
        for turn in range(rounds + 1):
            for name, way in WAYS.items():
                scene = scene_of(way)
                start = perf_counter()
                made = record(scene, ["image:stft"], motions=bodies(scene, count))
                if turn:  # the first one fills tables
                    seconds[name].append(perf_counter() - start)
                del made
        base = seconds["half-band, direct"]
        print(f"{13 * count} scatterers; {min(base) * 1e3:.0f} ms for the half-band sum")
        for name, way in WAYS.items():
            ratio = min(seconds[name]) / min(base)
            said = ""
            if "cube" not in name:
                scene = scene_of(way)
                accuracy = record(scene, ["accuracy"], motions=bodies(scene, count))["accuracy"]
                said = f"  error {accuracy.error_db:.0f} dB"
            print(f"  {name:<32}{ratio:6.1f}{said}")


if __name__ == "__main__":
    main()
