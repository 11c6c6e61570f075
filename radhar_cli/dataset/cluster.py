"""Run tasks on the workers of a dask cluster, on other machines or on this one."""

import logging
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from radhar_cli.errors import MachineError, UnfinishedError

T = TypeVar("T")
LOCAL = "local"
TASKS_A_CORE = 2
# For workers of our own: dask measures itself 100 times a second, a fifth of a worker's time.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}


class Cluster:
    """A connected dask cluster."""

    def __init__(self, client: Any) -> None:
        self._client = client

    @property
    def cores(self) -> int:
        """Threads of all workers that are there now."""
        return max(1, int(sum(self._client.ncores().values())))

    def run(self, function: Callable[..., T], tasks: Iterable[tuple[Any, ...]]) -> Iterator[T]:
        """Yield function(*task) for every task, in any order; tasks of a lost worker are run again.

        Raises:
            UnfinishedError: the scheduler is gone, or one task lost several workers.
        """
        from distributed import as_completed
        from distributed.client import FutureCancelledError
        from distributed.comm import CommClosedError
        from distributed.scheduler import KilledWorker

        left, running = iter(tasks), as_completed()

        def fill() -> None:
            for task in islice(left, max(0, TASKS_A_CORE * self.cores - running.count())):
                running.add(self._client.submit(function, *task, pure=False))

        try:
            fill()
            for done in running:
                yield done.result()
                fill()
        except KilledWorker:
            fault = "several workers were lost with the same task, perhaps out of memory"
        except (FutureCancelledError, CommClosedError):
            fault = "the scheduler is gone"
        except OSError:
            if self._client.status == "running":
                raise  # the task's own
            fault = "the scheduler is gone"
        else:
            return
        raise UnfinishedError(
            f"dask: {fault}; what was finished is kept, and the same command resumes"
        )


@contextmanager
def connected(address: str, jobs: int) -> Iterator[Cluster]:
    """Connect to a dask scheduler, or start workers on this machine.

    Args:
        address: of the scheduler, such as tcp://host:8786, or `local`.
        jobs: processes of `local`.

    Raises:
        MachineError: no scheduler answers, or dask is not installed.
    """
    try:
        import dask
        from distributed import Client
    except ImportError:
        raise MachineError("--cluster: needs dask; `pip install 'radhar[cluster]'`") from None
    # They log tracebacks of lost connections.
    for name in ("distributed", "distributed.client", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    own = {"n_workers": jobs, "threads_per_worker": 1, "dashboard_address": None}
    own["silence_logs"] = logging.CRITICAL
    # Dask's thread, and so its workers, inherit that Ctrl-C is blocked: it is ours to end them.
    resource_tracker.ensure_running()  # or its start, in that thread, would unblock it
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        with dask.config.set(QUIET):
            client = Client(**own) if address == LOCAL else Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise MachineError(f"--cluster {address}: no dask scheduler answers ({error})") from None
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    with client:
        yield Cluster(client)
