"""Run tasks in joblib worker processes, quietly and within bounds."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, TypeVar

from radhar_cli.activity import Activity, know_activities, own_activities
from radhar_cli.dataset.cluster import Cluster, connected
from radhar_cli.errors import UnfinishedError
from radhar_cli.registry import know_products, own_products
from radhar_cli.worker_process import prepare_process

T = TypeVar("T")
NO_PARENT = 0  # parent of workers on other machines, which end with their scheduler
_CLUSTER: ContextVar[Cluster | None] = ContextVar("cluster", default=None)


def run_tasks(
    function: Callable[..., T], tasks: Iterable[tuple[Any, ...]], jobs: int
) -> Iterator[T]:
    """Yield function(*task) for every task, in any order, with `jobs` processes.

    Tasks are taken from the iterable only as fast as they are finished. With one job everything
    runs here; within `on_cluster` all runs there.
    """
    cluster = _CLUSTER.get()
    if cluster is not None:
        own = own_activities(), own_products()
        yield from cluster.run(_with_own, ((own, function, *task) for task in tasks))
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
            own = own_activities(), own_products()
            results = pool(delayed(_with_own)(own, function, *task) for task in tasks)
        yield from results
    except UnboundLocalError as error:  # of loky, on its way out where it finds no more files
        raise error.__context__ or error from None
    except TerminatedWorkerError:
        raise UnfinishedError(
            "a worker process was killed (by hand, or out of memory); what was finished is "
            "kept, and the same command resumes"
        ) from None


def _with_own(
    own: tuple[tuple[Activity, ...], tuple[Any, ...]], function: Callable[..., T], *task: Any
) -> T:
    """Run a task in a worker that knows the classes and products its parent knows."""
    know_activities(own[0])
    know_products(own[1])
    return function(*task)


@contextmanager
def on_cluster(address: str, jobs: int) -> Iterator[int]:
    """Context in which a dask cluster runs the tasks; yields its number of cores.

    Args:
        address: of the scheduler, or `local`.
        jobs: processes of `local`.
    """
    with connected(address, jobs) as cluster:
        token = _CLUSTER.set(cluster)
        try:
            yield cluster.cores
        finally:
            _CLUSTER.reset(token)


def parent_pid() -> int:
    """The process without which workers should stop; NO_PARENT on a cluster."""
    return os.getpid() if _CLUSTER.get() is None else NO_PARENT


def warm_up(jobs: int) -> None:
    """Start the workers and have them import what they need."""
    for _ in run_tasks(_import_physics, [()] * jobs, jobs):
        pass


def _import_physics() -> int:
    import radhar_cli.dataset.batch  # noqa: F401 - the import is the work

    prepare_process()
    return os.getpid()


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Workers started meanwhile inherit the blocked signals: only the parent handles Ctrl-C."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
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
    from multiprocessing import resource_tracker

    from joblib.externals.loky.backend import resource_tracker as loky_tracker

    old = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore::UserWarning"
    try:
        resource_tracker.ensure_running()
        loky_tracker.ensure_running()
    finally:
        if old is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = old


def cores() -> int:
    """Cores that this process may use."""
    from joblib import cpu_count

    return int(cpu_count())
