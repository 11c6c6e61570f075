"""What a build of very many rows costs beside the synthesis, each stage in a process of its own.

    python scripts/bench_large.py [--rows 1e6] [--parts 4] [--batch 32] [--keep]

Every shard is a copy of one but for its rows: an image of 8 x 8 px, the numbers of a scene, the
checksums. What is left is bookkeeping: a build in one piece; the same in parts, their merge;
samples read at random. Of each stage: seconds (of these of the assembly), user and system time,
peak resident memory of the process, files and bytes it left.
"""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np

from radhar_cli.config import load_config
from radhar_cli.dataset import scene_fields, shards
from radhar_cli.dataset.batch import Batch
from radhar_cli.dataset.sample import Sample
from radhar_cli.pipeline.validity import Flags
from radhar_cli.processing.power_map import MapImage

ROOT = Path(__file__).resolve().parents[1]
SIZE, READS, CLASSES = 8, 1000, 12
STAGES = ("build", "parts", "merge", "read")


def stub_shard(batch: Batch, size: int, made: dict[int, bytes]) -> int:
    """Write the shard of a batch as `run_batch` would; return its number of samples.

    Args:
        batch: of a config whose only map is `stft`.
        size: of the image, px.
        made: shards by their number of samples, to copy; is filled.
    """
    count = batch.stop - batch.start
    if count not in made:
        image = MapImage(np.zeros((size, size), np.uint8), 0.0, (0.0, 1.0, -1.0, 1.0))
        samples = [Sample({"stft": image}, -100.0, False, {})] * count
        values = np.zeros((count, len(scene_fields.fields(batch.config))))
        flags = np.full(count, Flags.ALIASING, np.uint8)
        made[count] = shards.encode_shard(batch.config, "0" * 64, 0, samples, values, flags)
    content = made[count][shards.USER_BLOCK :]
    whose, start, stop = batch.identity_hash, batch.start, batch.stop
    checksum = shards._checksum(whose, start, stop, memoryview(content))
    header = f"radhar shard of {whose}\nrows {start} {stop}\nsha256 {checksum}\n".encode()
    data = header.ljust(shards.USER_BLOCK, b"\0") + content
    shards.write_shard(batch.folder, start, stop, data)
    return count


class _Stages:
    """Progress that notes when each stage began."""

    def __init__(self) -> None:
        self.began: dict[str, float] = {}

    def stage(self, name: str, total: int, done: int) -> None:
        self.began[name] = time.perf_counter()

    def advance(self, count: int) -> None:
        pass

    def say(self, message: str) -> None:
        pass


def stage(name: str, place: Path, rows: int, parts: int, batch: int | None) -> dict[str, float]:
    """Run a stage here and now: name and seconds of what of it is worth knowing."""
    from radhar_cli.dataset import build as build_module
    from radhar_cli.dataset.merge import merge
    from radhar_cli.dataset.parts import Part

    changes = ["maps=[stft]", f"image.size_px={SIZE}", "output.png=false"]
    config = load_config(
        ROOT / "configs/quickstart.yaml", [*changes, f"samples_per_class={-(-rows // CLASSES)}"]
    )
    notes, whole, cut = _Stages(), place / "whole", place / "cut"
    start = time.perf_counter()
    with (
        patch.object(build_module, "run_batch", partial(stub_shard, size=SIZE, made={})),
        patch.object(build_module, "MAX_CHECKED_FIRST", 0),
    ):
        if name == "build":
            build_module.build(config, whole, 1, notes, batch_size=batch)
        elif name == "parts":
            for number in range(1, parts + 1):
                build_module.build_part(config, cut, Part(parts, number), 1, notes, False, batch)
        elif name == "merge":
            merge(cut, [], 1, notes)
        else:
            return _read(cut)
    end = time.perf_counter()
    begun = notes.began.get("assembling", notes.began.get("merging", end))
    return {"seconds": end - start, "of these assembly": end - begun}


def _read(folder: Path) -> dict[str, float]:
    """Seconds to open a data set with radhar and with h5py, and to read a sample at random."""
    import h5py

    from radhar_cli.dataset.reading import open_dataset

    numbers = {}
    start = time.perf_counter()
    with open_dataset(folder) as data:
        numbers["open, radhar"] = time.perf_counter() - start
        order = np.random.default_rng(1).integers(len(data), size=READS)
        start = time.perf_counter()
        for row in order:
            data.maps["stft"][row]
        numbers["a sample, radhar"] = (time.perf_counter() - start) / READS
    with h5py.File(folder / "dataset.h5") as file:
        start = time.perf_counter()
        maps = file["maps/stft"]
        numbers["open, h5py"] = time.perf_counter() - start
        start, read = time.perf_counter(), 0
        while read < READS and time.perf_counter() - start < 60:
            maps[order[read]]
            read += 1
        numbers["a sample, h5py"] = (time.perf_counter() - start) / read
    return numbers


def held(place: Path) -> tuple[int, int]:
    """Files below a folder and their bytes; a link counts once."""
    numbers = [Path(at, f).stat() for at, _, files in os.walk(place) for f in files]
    return len(numbers), sum(f.st_size for f in numbers)


def main() -> None:
    """Print a line a stage."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rows", type=float, default=1e6)
    parser.add_argument("--parts", type=int, default=4)
    parser.add_argument("--batch", type=int, help="samples a shard; radhar's choice if not given")
    parser.add_argument("--stages", default=",".join(STAGES))
    parser.add_argument("--place", type=Path, help="a folder to work in, which stays")
    parser.add_argument("--json", type=Path, default=Path("build/bench_large.json"))
    parser.add_argument("--one", help=argparse.SUPPRESS)
    given = parser.parse_args()
    place = given.place or Path(tempfile.mkdtemp())
    rows = int(given.rows)
    if given.one:
        numbers = stage(given.one, place, rows, given.parts, given.batch)
        used = resource.getrusage(resource.RUSAGE_SELF)
        cpu = {"user": used.ru_utime, "system": used.ru_stime}
        print(json.dumps(numbers | cpu | {"peak_mib": used.ru_maxrss / 1024}))
        return
    results = {}
    try:
        for name in given.stages.split(","):
            command = [sys.executable, __file__, "--one", name, "--place", str(place)]
            command += ["--rows", str(rows), "--parts", str(given.parts)]
            command += ["--batch", str(given.batch)] if given.batch else []
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            numbers = json.loads(done.stdout)
            if not name.startswith("read"):
                numbers["files"], numbers["bytes"] = held(place)
            results[name] = numbers
            told = ", ".join(f"{key} {value:,.4g}" for key, value in numbers.items())
            print(f"{rows} rows, {name}: {told}", flush=True)
            if name == "build":
                shutil.rmtree(place / "whole")
    finally:
        if given.place is None:
            shutil.rmtree(place)
    given.json.parent.mkdir(parents=True, exist_ok=True)
    given.json.write_text(json.dumps(results, indent=2))


if __name__ == "__main__":
    main()
