"""What holds for all tests: the same examples on any machine, order on request, memory measured."""

import resource
import signal
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from helpers import slow
from helpers.forks import ForkServer
from hypothesis import HealthCheck, settings

# Neither chance nor the speed of the machine decides.
settings.register_profile(
    "repeatable",
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("repeatable")

PEAKS: dict[str, float] = {}


# A run in the background ignores Ctrl-C, and so would the programs that its tests start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def restore_signal_handlers() -> Iterator[None]:
    """Restore handlers after a test that ran the program in this process, which ignores signals."""
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture(scope="session", autouse=True)
def checks_of_hdf5_in_forks() -> Iterator[None]:
    """Try HDF5 files in forks; where a test starts the program, it does so as for a user."""
    from radhar_cli.readers import untrusted_hdf5

    forks = ForkServer()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(untrusted_hdf5, "subprocess", forks)
        yield
    forks.close()


@pytest.fixture
def blank_figures(request: pytest.FixtureRequest) -> Iterator[None]:
    """Write blank figures, which are drawn for a test that is marked so."""
    from helpers import blank_figures

    drawn = request.node.get_closest_marker("drawn") is not None
    with nullcontext() if drawn else blank_figures.blank_figures():
        yield


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--reverse", action="store_true", help="run the tests in reverse order")


def pytest_configure(config: pytest.Config) -> None:
    slow.whole_suite = "not slow" not in config.getoption("markexpr")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    cases: Counter[str] = Counter()
    for item in items:
        if (marker := item.get_closest_marker("every")) is not None:
            function = item.nodeid.partition("[")[0]
            if cases[function] % marker.args[0]:
                item.add_marker(pytest.mark.slow)
            cases[function] += 1
    if config.getoption("--reverse"):
        items.reverse()


def peak_mib() -> float:
    """Largest resident memory of this process so far; Linux counts in KiB, macOS in bytes."""
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def pytest_sessionfinish(session: pytest.Session) -> None:
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["peak_mib"] = peak_mib()
    elif not PEAKS:
        PEAKS["this process"] = peak_mib()


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: object, error: object) -> None:
    gateway, found = getattr(node, "gateway", None), getattr(node, "workeroutput", {})
    if gateway is not None and "peak_mib" in found:
        PEAKS[gateway.id] = found["peak_mib"]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    peaks: Iterable[str] = (f"{name} {peak:.0f} MiB" for name, peak in sorted(PEAKS.items()))
    terminalreporter.write_line(f"peak memory: {', '.join(peaks)}")


@pytest.fixture(scope="session")
def small_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The data set of small.SMALL, its config beside it; who changes it takes a copy."""
    from helpers.listener import Listener
    from helpers.small import small_config

    from radhar_cli.config import load_config
    from radhar_cli.dataset.build import build

    place = tmp_path_factory.mktemp("small")
    build(load_config(small_config(place)), place / "set", 1, Listener())
    return place / "set"
