"""Samples a second of a stream in a DataLoader, beside the same samples made by plain processes.

    python scripts/bench_stream.py [CONFIG...] [--rounds 7] [--batches 24] [--workers 1 2]

Both make the samples of a data set, every map. Plain processes draw, check and synthesise them as
`radhar generate` does, entropies included, and keep nothing; a stream makes levels alone, and sends
them. A round times both, one after the other, and swaps their order; ratios are of a round. Speed
is from the first batch to the last; processor time is that of all processes, their start included,
and the one to look at where other programs are busy.
"""

import argparse
import multiprocessing
import os
import platform
import resource
import statistics
import time
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from torch.utils.data import DataLoader, get_worker_info

import radhar_cli as radhar
from radhar_cli.config.schema import Config
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.stream_order import StreamOrder
from radhar_cli.pipeline.plan import Plan
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.worker_process import prepare_process

BATCH = 8
_PLANS: dict[int, Plan] = {}


def plain_batch(config: Config, order: StreamOrder, first: int) -> int:
    """Make a batch of samples and throw them away."""
    plan = _PLANS.setdefault(os.getpid(), plan_images(config))
    for number in range(first, first + BATCH):
        synthesise(draw_valid_scene(config, *order[number])[0], plan)
    return BATCH


_WORK: tuple[Config, StreamOrder]


def _one(first: int) -> int:
    return plain_batch(*_WORK, first)


def plain(config: Config, workers: int, batches: int) -> Iterator[object]:
    """Batches by processes that do nothing else."""
    global _WORK
    _WORK = config, StreamOrder(config)
    with multiprocessing.get_context("fork").Pool(workers, prepare_process) as pool:
        yield from pool.imap(_one, range(0, batches * BATCH, BATCH))
        pool.close()
        pool.join()


class Ending(radhar.Stream):  # type: ignore[name-defined, misc]
    """A stream that ends, so that no worker makes what nobody takes."""

    batches = 0

    def __iter__(self) -> Iterator[dict[str, Any]]:
        worker = get_worker_info()
        assert worker is not None
        mine = len(range(worker.id, self.batches, worker.num_workers))
        return islice(super().__iter__(), mine * BATCH)


def streamed(config: Config, workers: int, batches: int) -> Iterator[object]:
    """The same batches by a DataLoader."""
    stream = Ending(config, batch_size=BATCH)
    stream.batches = batches
    yield from DataLoader(stream, BATCH, num_workers=workers)


def timed(made: Iterable[object], batches: int) -> tuple[float, float]:
    """Samples a second after the first batch, and ms of processor time a sample."""
    before = processor_time()
    results = iter(made)
    next(results)
    began, last = time.perf_counter(), 0.0
    for number, _ in enumerate(results, start=2):
        if number == batches:
            last = time.perf_counter()
    return (
        (batches - 1) * BATCH / (last - began),
        1e3 * (processor_time() - before) / (batches * BATCH),
    )


def processor_time() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def middle(values: list[float], digits: int) -> str:
    low, mid, high = min(values), statistics.median(values), max(values)
    return f"{mid:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("configs", nargs="*", type=Path, default=[Path("configs/quickstart.yaml")])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--batches", type=int, default=24)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    given = parser.parse_args()
    print(
        f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, "
        f"load {os.getloadavg()[0]:.1f}; medians of {given.rounds} rounds (range)"
    )
    print("| config | workers | | plain | stream | ratio |")
    print("| --- | ---: | --- | ---: | ---: | ---: |")
    ways: list[Callable[[Config, int, int], Iterator[object]]] = [plain, streamed]
    for path in given.configs:
        config = radhar.load_config(path)
        for workers in given.workers:
            results: dict[str, list[tuple[float, float]]] = {"plain": [], "streamed": []}
            for turn in range(given.rounds):
                for way in ways if turn % 2 == 0 else ways[::-1]:
                    made = way(config, workers, given.batches)
                    results[way.__name__].append(timed(made, given.batches))
            for column, what in enumerate(("samples/s", "processor ms a sample")):
                a, b = ([pair[column] for pair in results[name]] for name in ("plain", "streamed"))
                better = [y / x if column == 0 else x / y for x, y in zip(a, b, strict=True)]
                print(
                    f"| `{path}` | {workers} | {what} | {middle(a, 1)} | {middle(b, 1)} | "
                    f"{middle(better, 2)} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
