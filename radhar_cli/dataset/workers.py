"""Run tasks in joblib worker processes or on a dask cluster, quietly and within bounds."""

import logging
import os
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import islice
from multiprocessing import resource_tracker
from time import monotonic
from typing import Any, TypeVar

from radhar_cli.errors import MachineError, UnfinishedError, how_to_install
from radhar_cli.extensions import know_products, own_products
from radhar_cli.motion.activities.activity import Activity, know_activities, own_activities
from radhar_cli.processes import interrupts
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.processes.worker_process import end_with, prepare_process

T = TypeVar("T")
NO_PARENT = 0  # parent of workers on other machines, which end with their scheduler
LOCAL = "local"
TASKS_A_CORE = 2
WAIT_S = 0.25  # for a result, before Ctrl-C is looked for
# For workers of our own: dask measures itself 100 times a second, a fifth of a worker's time.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
_CLIENT: ContextVar[Any] = ContextVar("client", default=None)  # of dask


def run_tasks(
    function: Callable[..., T], tasks: Iterable[tuple[Any, ...]], jobs: int
) -> Iterator[T]:
    """Yield function(*task) for every task, in any order, with `jobs` processes.

    Tasks are taken from the iterable only as fast as they are finished. With one job everything
    runs here; within `on_cluster` all runs there.

    Args:
        function: function of a module, which other processes can import.
        tasks: arguments of each call; they can be pickled.
        jobs: number of processes on this machine.

    Raises:
        UnfinishedError: a worker was killed, or the cluster is gone.
    """
    extensions, client = (own_activities(), own_products()), _CLIENT.get()
    if client is not None:
        yield from _run_on_cluster(client, ((extensions, function, *task) for task in tasks))
        return
    if jobs == 1:
        prepare_process()
        for task in tasks:
            yield function(*task)
        return
    from joblib import Parallel, delayed
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    pool = Parallel(
        n_jobs=jobs, return_as="generator_unordered", pre_dispatch=2 * jobs, batch_size=1
    )
    try:
        with _interrupts_blocked():
            own_pid = os.getpid()
            results = pool(
                delayed(_run_below_parent)(own_pid, extensions, function, *task) for task in tasks
            )
        try:
            for result in results:  # noqa: UP028 - `yield from` would close it before, and warn
                yield result
        finally:
            with warnings.catch_warnings():  # of joblib: that tasks under way are cancelled
                warnings.simplefilter("ignore", UserWarning)
                results.close()
    except UnboundLocalError as error:  # of loky, on its way out where it finds no more files
        raise error.__context__ or error from None
    except TerminatedWorkerError:
        raise UnfinishedError(
            "a worker process was killed (by hand, or out of memory); what was finished is "
            "kept, and the same command resumes"
        ) from None


def run_within(
    function: Callable[..., T],
    tasks: Iterable[tuple[Any, ...]],
    jobs: int,
    seconds: float,
    receive: Callable[[T], None],
) -> None:
    """Run function(*task) for tasks with `jobs` processes on this machine, until the time is over.

    What is under way then is given up. A task is taken from the iterable when a process is free.

    Args:
        function: function of a module, which other processes can import. With one job it does not
            call HDF5, as of `time_limit`.
        tasks: arguments of each call; they can be pickled.
        jobs: number of processes; one runs the tasks here.
        seconds: longest time, s.
        receive: is given every result, in any order.

    Raises:
        UnfinishedError: a worker was killed.
    """
    if jobs == 1:
        prepare_process()
        with time_limit(seconds):
            for task in tasks:
                receive(function(*task))
        return
    from joblib.externals.loky import ProcessPoolExecutor
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    end, waiting, running = monotonic() + seconds, iter(tasks), set[Future[T]]()
    below_parent = (os.getpid(), (own_activities(), own_products()), function)
    pool = ProcessPoolExecutor(jobs)
    try:
        while True:
            with _interrupts_blocked():
                for task in islice(waiting, jobs - len(running)):
                    running.add(pool.submit(_run_below_parent, *below_parent, *task))
            remaining = end - monotonic()
            if not running or remaining <= 0:
                return
            finished, running = wait(running, min(remaining, WAIT_S), FIRST_COMPLETED)
            interrupts.check()
            for future in finished:
                receive(future.result())
    except TerminatedWorkerError:
        raise UnfinishedError(
            "a worker process was killed (by hand, or out of memory); the same command tries again"
        ) from None
    finally:
        pool.shutdown(kill_workers=True)


def _run_with_extensions(
    extensions: tuple[tuple[Activity, ...], tuple[Any, ...]], function: Callable[..., T], *task: Any
) -> T:
    """Run a task in a worker that knows the classes and products that its parent knows."""
    know_activities(extensions[0])
    know_products(extensions[1])
    return function(*task)


def _run_below_parent(parent_pid: int, *task: Any) -> Any:
    """Run a task in a worker of this machine, which ends with its parent process."""
    end_with(parent_pid)
    return _run_with_extensions(*task)


def _run_on_cluster(client: Any, tasks: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
    """Yield the results of tasks, in any order; tasks of a lost worker are run again."""
    from distributed import as_completed
    from distributed.client import FutureCancelledError
    from distributed.comm import CommClosedError
    from distributed.scheduler import KilledWorker

    waiting, running = iter(tasks), as_completed()

    def fill() -> None:
        for task in islice(waiting, max(0, TASKS_A_CORE * _cores(client) - running.count())):
            running.add(client.submit(_run_with_extensions, *task, pure=False))

    try:
        fill()
        for future in running:
            yield future.result()
            fill()
    except KilledWorker:
        fault = "several workers were lost with the same task, perhaps out of memory"
    except (FutureCancelledError, CommClosedError):
        fault = "the scheduler is gone"
    except OSError:
        if client.status == "running":
            raise  # the task's own
        fault = "the scheduler is gone"
    else:
        return
    raise UnfinishedError(f"dask: {fault}; what was finished is kept, and the same command resumes")


def _cores(client: Any) -> int:
    """Number of threads of all present workers of a dask cluster."""
    return max(1, int(sum(client.ncores().values())))


@contextmanager
def on_cluster(address: str, jobs: int) -> Iterator[int]:
    """Run the tasks of `run_tasks` on a dask cluster within this context; yield its cores.

    Args:
        address: address of the scheduler, such as tcp://host:8786; `local` starts workers here.
        jobs: number of processes of `local`.

    Raises:
        MachineError: dask is not installed, or no scheduler answers.
    """
    try:
        import dask
        from distributed import Client
    except ImportError:
        raise MachineError(f"--cluster: needs dask; {how_to_install('distributed')}") from None
    # They log tracebacks of lost connections.
    for name in ("distributed", "distributed.client", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    cluster_options = {"n_workers": jobs, "threads_per_worker": 1, "dashboard_address": None}
    cluster_options["silence_logs"] = logging.CRITICAL
    # Dask's thread, and so its workers, inherit that Ctrl-C is blocked: it is ours to end them.
    resource_tracker.ensure_running()  # or its start, in that thread, would unblock it
    old_mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        with dask.config.set(QUIET):
            client = Client(**cluster_options) if address == LOCAL else Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise MachineError(f"--cluster {address}: no dask scheduler answers ({error})") from None
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old_mask)
    with client:
        token = _CLIENT.set(client)
        try:
            yield _cores(client)
        finally:
            _CLIENT.reset(token)


def parent_pid() -> int:
    """Id of the process without which workers should stop; NO_PARENT on a cluster."""
    return os.getpid() if _CLIENT.get() is None else NO_PARENT


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block signals, as workers that start meanwhile inherit it: only the parent handles Ctrl-C."""
    _start_trackers()
    old = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old)


def _start_trackers() -> None:
    """Start the processes that clean up after a killed pool: first, and quiet about doing so.

    Started later, they would unblock the signals again before the workers are there.
    """
    from joblib.externals.loky.backend import resource_tracker as loky_tracker

    old = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore::UserWarning"
    try:
        resource_tracker.ensure_running()
        loky_tracker.ensure_running()
    finally:
        del os.environ["PYTHONWARNINGS"]
        if old is not None:
            os.environ["PYTHONWARNINGS"] = old


def cores() -> int:
    """Number of cores that this process may use."""
    from joblib import cpu_count

    return int(cpu_count())
