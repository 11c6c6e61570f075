"""Whether the scene numbers of shipped configs tell the class: the audit, without echoes.

    python scripts/studies/audit_configs.py [--count 40] [CONFIG ...]

draws scenes of every config of `configs` that has two classes or more, and prints how often a
forest tells the class of those held out, from all numbers together that are not the movement, and
from each number that tells more than chance (95 %).
"""

import argparse
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
from shared import ROOT

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import RadharError
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.study.audit.held_out import ClassShare, Effort, class_share
from radhar_cli.study.audit.scene_numbers import scene_evidence


def configs_with_classes(paths: list[Path]) -> list[tuple[str, Config]]:
    """Configs of scenes, not of streams or recordings, with two classes or more."""
    chosen = []
    for path in paths:
        try:
            config = load_config(path)
        except RadharError:  # of training, or of recordings that are not here
            continue
        is_of_scenes = isinstance(config, Config) and config.stream is None
        if is_of_scenes and len(config.chosen_activities) > 1:
            chosen.append((str(path.relative_to(ROOT)), config))
    return chosen


def shares_of_config(config: Config, count: int) -> dict[str, ClassShare]:
    """Share of the classes that each piece of evidence tells, by its name."""
    columns = scene_fields.fields(config)
    rows, labels = [], []
    for label, activity in enumerate(config.chosen_activities):
        for index in range(count):
            scene, _ = draw_valid_scene(config, activity, index)
            rows.append(scene_fields.values(scene, columns))
            labels.append(label)
    table = np.array(rows)
    numbers = {field.name: table[:, column] for column, field in enumerate(columns)}
    if config.split.subjects is not None:
        numbers["subject"] = np.tile(np.arange(count) % config.split.subjects, len(labels) // count)
    data = cast(Dataset, SimpleNamespace(config=config, fields=columns, scene=numbers))
    label, group, effort = np.array(labels), np.arange(len(labels)), Effort(permutations=100)
    shares = {}
    for evidence in scene_evidence(data):
        share = class_share(evidence.values, label, group, effort, evidence.name)
        if share is not None:
            shares[evidence.name] = share
    return shares


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("config", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=40, help="scenes of a class")
    options = parser.parse_args()
    paths = [path.resolve() for path in options.config] or sorted(ROOT.glob("configs/**/*.yaml"))
    print("| config | classes | chance | all numbers together | above chance |")
    print("| --- | --- | --- | --- | --- |")
    for name, config in configs_with_classes(paths):
        shares = shares_of_config(config, options.count)
        together = [_words(share) for key, share in shares.items() if key.startswith("all ")]
        above = [
            f"{key} {_words(share)}" for key, share in shares.items() if share.low > share.chance
        ]
        classes = len(config.chosen_activities)
        cells = name, str(classes), f"{1 / classes:.1%}", "".join(together), "; ".join(above)
        print(f"| {' | '.join(cells)} |", flush=True)


def _words(share: ClassShare) -> str:
    """A share with its interval, in percent."""
    return f"{100 * share.share:.1f} ({100 * share.low:.1f} to {100 * share.high:.1f})"


if __name__ == "__main__":
    main()
