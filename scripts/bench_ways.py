"""One data set made in four ways: equal bytes, and the processor time of each.

    python scripts/bench_ways.py [CONFIG] [--per-class 20] [--parts 2] [--rounds 3]

One process; two of joblib's; `--shard K/N` and `merge`; `--cluster local` with one worker. In turn,
user and system time with that of all child processes, of each its median. Then a part of two
samples and a merge of six such parts: mostly what either costs whatever it holds.
"""

import argparse
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[1]
FOLDED = (".radhar", "parts")  # what is not the data set


def radhar(*arguments: object) -> float:
    """Run a command; return its processor time, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "radhar_cli", *map(str, arguments)]
    done = subprocess.run(
        command, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"}
    )
    if done.returncode:
        raise SystemExit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def fingerprint(folder: Path) -> str:
    """SHA-256 of names and contents of all files of a data set."""
    digest = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        inside = path.relative_to(folder)
        if inside.parts[0] not in FOLDED:
            digest.update(f"{inside}\0".encode() + path.read_bytes())
    return digest.hexdigest()


def made(way: str, out: Path, config: Path, change: str, parts: int) -> dict[str, float]:
    """Make the data set; return the processor time of each command, s."""
    common = ("generate", config, "-o", out, "--set", change)
    if way == "shards":
        seconds = {
            f"{k}/{parts}": radhar(*common, "--jobs", 1, "--shard", f"{k}/{parts}")
            for k in range(1, parts + 1)
        }
        return seconds | {"merge": radhar("merge", out, "--jobs", 1)}
    options = {
        "one process": ("--jobs", 1),
        "loky": ("--jobs", 2),
        "dask": ("--jobs", 1, "--cluster", "local"),
    }
    return {way: radhar(*common, *options[way])}


def main() -> None:
    """Print the median of each way and its ratio to one process."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("config", nargs="?", type=Path, default=ROOT / "configs/quickstart.yaml")
    parser.add_argument("--per-class", type=int, default=20)
    parser.add_argument("--parts", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path, default=Path("build/bench_ways.json"))
    given = parser.parse_args()
    ways = ("one process", "loky", "shards", "dask")
    change = f"samples_per_class={given.per_class}"
    times: dict[str, list[float]] = {way: [] for way in ways}
    fixed: dict[str, list[float]] = {"a part": [], "a merge": []}
    with tempfile.TemporaryDirectory() as place:
        for turn in range(given.rounds):
            prints = {}
            for way in ways:
                out = Path(place) / way
                took = made(way, out, given.config, change, given.parts)
                times[way].append(sum(took.values()))
                prints[way] = fingerprint(out)
                shutil.rmtree(out)
            if len(set(prints.values())) > 1:
                raise SystemExit(f"bytes differ: {prints}")
            out = Path(place) / "fixed"
            small = made("shards", out, given.config, "samples_per_class=1", 6)
            shutil.rmtree(out)
            fixed["a merge"].append(small.pop("merge"))
            fixed["a part"].append(median(small.values()))
            said = ", ".join(f"{way} {seconds[-1]:.1f}" for way, seconds in (times | fixed).items())
            print(f"round {turn + 1}: {said}", flush=True)
    alone = median(times["one process"])
    for way, seconds in times.items():
        print(f"{way:<12}{median(seconds):8.1f} s   {median(seconds) / alone:.3f}")
    for name, seconds in fixed.items():
        print(f"{name:<12}{median(seconds):8.1f} s")
    given.json.parent.mkdir(parents=True, exist_ok=True)
    given.json.write_text(json.dumps(times | fixed, indent=2))


if __name__ == "__main__":
    main()
