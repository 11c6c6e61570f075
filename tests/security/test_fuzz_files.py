"""Files of ours with random damage: a clear refusal or a right result, nothing else.

A target is a folder of ours, what of it is damaged, and what is then done with it. A case is known
by its number: the same number, the same damage.
"""

import contextlib
import io
import random
import shutil
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import torch
from helpers.small import fingerprint, full_disk_after
from learning.patterns import trained
from security.bounded import limited
from security.mutations import mutate_file

from radhar_cli.commands.inspect import print_summary
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.summary import summarise
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import RadharError
from radhar_cli.learning.evaluation import open_for_model
from radhar_cli.learning.evaluation import predict_classes as ask
from radhar_cli.learning.run_folder import load_best, read_history, read_metadata, read_trained_on
from radhar_cli.scene.single.scene_file import write_all
from radhar_cli.scene.single.simulate import simulate

CPU = torch.device("cpu")


@dataclass(frozen=True)
class Target:
    """What is damaged and used.

    Attributes:
        name: of the kind.
        folder: whole; copied before it is damaged.
        files: patterns of the files in it that may be damaged.
        use: does what the program does with the copy; raises AssertionError where that is wrong.
    """

    name: str
    folder: Path
    files: tuple[str, ...]
    use: Callable[[Path], None]
    paths: list[Path] = field(default_factory=list)

    def __post_init__(self) -> None:
        found = {p for pattern in self.files for p in self.folder.glob(pattern) if p.is_file()}
        self.paths.extend(sorted(found))
        assert self.paths


def outcome(target: Target, number: int, place: Path) -> str:
    """`refused`, `right`, or what went wrong, of one case."""
    rng = random.Random(f"{target.name} {number}")
    copy = Path(shutil.copytree(target.folder, place / "copy"))
    path = copy / rng.choice(target.paths).relative_to(target.folder)
    path.write_bytes(mutate_file(rng, path.read_bytes()))
    try:
        with limited(), contextlib.redirect_stdout(io.StringIO()):
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
) -> dict[str, Target]:
    """Everything that is damaged, by name."""
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
        images = open_for_model(about, good_set, None)
        found = ask(model, about, images, np.arange(len(images)), CPU, 4).probabilities
        np.testing.assert_allclose(found.sum(1), 1, atol=1e-5)
        read_history(folder)
        read_trained_on(folder)
        read_metadata(folder)

    def go_on_training(folder: Path) -> None:
        outcome = trained(good_set, folder, epochs=2, model="smallnet")
        assert len(outcome.history) == 2

    def go_on_building(folder: Path) -> None:
        print_summary(summarise(folder))
        build(config, folder, 1, BarProgress())
        assert fingerprint(folder) == fingerprint(good_set)

    with full_disk_after(4):
        build(config, place / "half", 1, BarProgress(), batch_size=2)
    found = [
        Target("data set", good_set, ("dataset.h5",), use_data_set),
        Target("weights", good_run, ("best.safetensors", "*.csv", "run.json"), use_run),
        Target("checkpoint", good_run, ("last.ckpt", "run.json"), go_on_training),
        Target("scene", place / "scene", ("scene.h5",), lambda p: print_summary(summarise(p))),
        Target("half a build", place / "half", (".radhar/**/*",), go_on_building),
    ]
    return {target.name: target for target in found}


# Cases of each target; a thirtieth of them in every run.
CASES = {"data set": 900, "weights": 600, "checkpoint": 240, "scene": 180, "half a build": 80}
RUNS = [
    *((name, 0, -(-count // 30)) for name, count in CASES.items()),
    *(
        pytest.param(name, -(-count // 30), count, marks=pytest.mark.slow)
        for name, count in CASES.items()
    ),
]


@pytest.mark.parametrize(("name", "first", "stop"), RUNS)
def test_damage_is_refused_or_does_no_harm(
    targets: dict[str, Target], name: str, first: int, stop: int, tmp_path: Path
) -> None:
    found = {number: outcome(targets[name], number, tmp_path) for number in range(first, stop)}
    print(name, Counter(found.values()).most_common())
    wrong = [f"{n}: {what}" for n, what in found.items() if what not in ("refused", "right")]
    assert wrong == [], "\n".join(wrong)
