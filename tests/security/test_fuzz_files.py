"""Files of ours with random damage: a clear refusal or a right result, nothing else.

A target is a folder of ours, what of it is damaged, and what is then done with it. A case is known
by its number: the same number, the same damage.
"""

import contextlib
import io
import random
import shutil
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import torch
from learning.patterns import trained
from security.bounded import SECONDS
from small import fingerprint

from radhar_cli.commands.summary_view import print_summary
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import Config, load_config
from radhar_cli.dataset import batch
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.summary import summarise
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import RadharError, UnfinishedError
from radhar_cli.learning.evaluation import open_for
from radhar_cli.learning.evaluation import predict as ask
from radhar_cli.learning.run_folder import load_best, read_about, read_history, read_trained_on
from radhar_cli.simulation.scene_file import write_all
from radhar_cli.simulation.simulate import simulate

CPU = torch.device("cpu")


@dataclass(frozen=True)
class Target:
    """What is damaged and used.

    Attributes:
        name: of the kind.
        folder: whole; copied before it is damaged.
        files: patterns of the files in it that may be damaged.
        use: does what the program does with the copy; raises AssertionError where that is wrong.
        weight: cases of it among all.
    """

    name: str
    folder: Path
    files: tuple[str, ...]
    use: Callable[[Path], None]
    weight: int
    paths: list[Path] = field(default_factory=list)

    def __post_init__(self) -> None:
        found = {p for pattern in self.files for p in self.folder.glob(pattern) if p.is_file()}
        self.paths.extend(sorted(found))
        assert self.paths


def damaged(data: bytes, rng: random.Random) -> bytes:
    """The bytes with one to four faults: flips, odd numbers, cuts, repetitions, odd words."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        place = rng.randrange(len(changed) + 1)
        width = rng.choice((1, 2, 4, 8))
        kind = rng.randrange(7)
        if kind == 0 and place < len(changed):
            changed[place] ^= 1 << rng.randrange(8)
        elif kind == 1:
            number = rng.choice((0, 1, 255, 2**31 - 1, 2**63 - 1, 2**64 - 1, rng.getrandbits(64)))
            changed[place : place + width] = number.to_bytes(8, "little")[:width]
        elif kind == 2:
            del changed[place:]
        elif kind == 3:
            del changed[place : place + rng.randrange(1, 64)]
        elif kind == 4:
            changed[place:place] = changed[place : place + rng.randrange(1, 256)]
        elif kind == 5:
            odd = (b"null", b"-1", b"1e999", b"NaN", b"[", b'"', b"{}", b"\xff\xfe", b"9" * 400)
            changed[place : place + width] = rng.choice(odd)
        else:
            start = rng.randrange(len(changed) + 1)
            changed[place : place + width] = changed[start : start + width]
    return bytes(changed)


@contextlib.contextmanager
def _in_time() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TimeoutError

    old = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old)


def outcome(target: Target, number: int, place: Path) -> str:
    """`refused`, `right`, or what went wrong, of one case."""
    rng = random.Random(f"{target.name} {number}")
    copy = Path(shutil.copytree(target.folder, place / "copy"))
    path = copy / rng.choice(target.paths).relative_to(target.folder)
    path.write_bytes(damaged(path.read_bytes(), rng))
    try:
        with _in_time(), contextlib.redirect_stdout(io.StringIO()):
            target.use(copy)
    except RadharError as error:
        return "refused" if str(error) and len(str(error)) < 20_000 else f"says {error!r}"
    except BaseException as error:  # a panic of another language is one too
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"{type(error).__name__}: {error} in {path.name}"
    finally:
        shutil.rmtree(copy)
    return "right"


@pytest.fixture(scope="module")
def targets(
    good_set: Path, good_run: Path, tmp_path_factory: pytest.TempPathFactory
) -> list[Target]:
    """Everything that is damaged."""
    place = tmp_path_factory.mktemp("targets")
    config = load_config(good_set.parent / "set.yaml")
    write_all(simulate(config, "S8"), place / "scene")
    with open_dataset(good_set) as data:
        pixels, labels = data.maps["stft"][:], data.label

    def use_data_set(folder: Path) -> None:
        print_summary(summarise(folder))
        problems = verify(folder, 0).problems
        with open_dataset(folder) as data:
            assert (len(data), data.maps["stft"][:].shape) == (6, pixels.shape)
            data.extent("stft")
            if not problems:
                assert np.array_equal(data.maps["stft"][:], pixels)
                assert np.array_equal(data.label, labels)

    def use_run(folder: Path) -> None:
        about, model = load_best(folder)
        images = open_for(about, good_set, None)
        found = ask(model, about, images, np.arange(len(images)), CPU, 4).probabilities
        np.testing.assert_allclose(found.sum(1), 1, atol=1e-5)
        read_history(folder)
        read_trained_on(folder)
        read_about(folder)

    def go_on_training(folder: Path) -> None:
        outcome = trained(good_set, folder, epochs=2, model="smallnet")
        assert len(outcome.history) == 2

    def go_on_building(folder: Path) -> None:
        print_summary(summarise(folder))
        build(config, folder, 1, BarProgress())
        assert fingerprint(folder) == fingerprint(good_set)

    return [
        Target("data set", good_set, ("dataset.h5",), use_data_set, 10),
        Target("weights", good_run, ("best.safetensors", "*.csv", "run.json"), use_run, 5),
        Target("checkpoint", good_run, ("last.ckpt", "run.json"), go_on_training, 2),
        Target("scene", place / "scene", ("scene.h5",), lambda p: print_summary(summarise(p)), 2),
        Target("half a build", _half(config, place), (".radhar/**/*",), go_on_building, 1),
    ]


def _half(config: Config, place: Path) -> Path:
    """A build that was stopped after four of six samples."""
    made, original = [], batch.synthesise

    def fails(*arguments: object) -> object:
        made.append(1)
        if len(made) > 4:
            raise OSError("disk")
        return original(*arguments)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "synthesise", fails)
        with pytest.raises(UnfinishedError):
            build(config, place / "half", 1, BarProgress(), batch_size=2)
    return place / "half"


@pytest.mark.parametrize(
    "count", [60, pytest.param(2000, marks=pytest.mark.slow)], ids=["some", "all"]
)
def test_damage_is_refused_or_does_no_harm(
    targets: list[Target], count: int, tmp_path: Path
) -> None:
    weights = sum(target.weight for target in targets)
    tally: dict[str, dict[str, int]] = {}
    wrong = []
    for target in targets:
        tally[target.name] = {"refused": 0, "right": 0}
        for number in range(-(-count * target.weight // weights)):
            found = outcome(target, number, tmp_path)
            if found in tally[target.name]:
                tally[target.name][found] += 1
            else:
                wrong.append(f"{target.name} {number}: {found}")
                print(wrong[-1], flush=True)
        print(target.name, tally[target.name], flush=True)
    assert wrong == [], "\n".join(wrong)
    assert all(found["refused"] for found in tally.values())
