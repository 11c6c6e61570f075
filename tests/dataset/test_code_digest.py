"""Code that differs has another digest, wherever the change lies; the same code has the same."""

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

WORK = "def work(x):\n    return x + 1\n"
CALLS = "from inner import work\n\n\ndef make(x):\n    return work(x)\n"
CASES: dict[str, tuple[Mapping[str, str], Mapping[str, str]]] = {
    "the function": (
        {"mine": "def make(x):\n    return x\n"},
        {"mine": "def make(x):\n    return -x\n"},
    ),
    "a partial function": (
        {"mine": f"from functools import partial\n{WORK}make = partial(work, 1)\n"},
        {"mine": f"from functools import partial\n{WORK}make = partial(work, 2)\n"},
    ),
    "a function that it calls": (
        {"mine": CALLS, "inner": WORK},
        {"mine": CALLS, "inner": WORK.replace("1", "2")},
    ),
    "a module two imports away": (
        {"mine": CALLS, "inner": "import deep\nwork = deep.work\n", "deep": WORK},
        {"mine": CALLS, "inner": "import deep\nwork = deep.work\n", "deep": WORK + "more = 1\n"},
    ),
    "a class that can be called": (
        {"mine": "class M:\n    def __call__(self, x): return x\n\n\nmake = M()\n"},
        {"mine": "class M:\n    def __call__(self, x): return -x\n\n\nmake = M()\n"},
    ),
}
# Versions that differ in what they hold alone, which the environment decides.
HELD = """
import os
from dataclasses import dataclass
from functools import partial
import numpy as np
n = int(os.environ.get("N", "0"))

@dataclass(frozen=True)
class Window:
    length: int
    def __call__(self, x): return x
    def apply(self, x): return x

def work(x, taps): return x
def outer(n): return lambda x: x + n
makes = {
    "object": Window(n),
    "method": Window(n).apply,
    "closure": outer(n),
    "array": partial(work, taps=np.arange(3.0) + n),
    "nested": partial(partial(work, taps={"a": [1, (n,)]})),
    "set": partial(work, taps={"a", "b", str(n)}),
}
make = makes[os.environ["KIND"]]
"""


def digest(folder: Path, modules: Mapping[str, str], **environment: str) -> str:
    """Digest in a process of its own of `mine.make`, of modules in a folder of that name."""
    folder.mkdir(exist_ok=True)
    for name, text in modules.items():
        (folder / f"{name}.py").write_text(text)
    line = "from radhar_cli.dataset.code_digest import code_digest; import mine; "
    done = subprocess.run(
        [sys.executable, "-c", f"{line}print(code_digest([mine.make]))"],
        capture_output=True,
        text=True,
        cwd=folder,
        env={"OPENBLAS_NUM_THREADS": "1", **environment},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("case", CASES)
def test_two_versions_have_two_digests_and_one_has_one_wherever_it_lies(
    case: str, tmp_path: Path
) -> None:
    one, other = CASES[case]
    first = digest(tmp_path / "one", one)
    assert digest(tmp_path / "copy", one) == first
    assert digest(tmp_path / "other", other) != first


@pytest.mark.parametrize("kind", ["object", "method", "closure", "array", "nested", "set"])
def test_what_code_holds_is_part_of_it(kind: str, tmp_path: Path) -> None:
    first, again, other = (
        digest(tmp_path / "mine", {"mine": HELD}, KIND=kind, N=n, PYTHONHASHSEED=seed)
        for n, seed in (("1", "1"), ("1", "2"), ("2", "1"))
    )
    assert first == again
    assert first != other


def test_files_that_the_code_does_not_import_are_not_part_of_it(tmp_path: Path) -> None:
    alone = digest(tmp_path / "alone", {"mine": WORK + "make = work\n"})
    assert digest(tmp_path / "beside", {"mine": WORK + "make = work\n", "other": "1\n"}) == alone
