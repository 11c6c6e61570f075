"""From a config to a confusion matrix: generate, verify, train, evaluate.

    python examples/config_to_confusion_matrix.py [FOLDER]

Three classes, a small network, about a minute; the same command resumes where it stopped.
Needs the extra `train` (docs/guide/install.md).
"""

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

CONFIG = """\
seed: 3
samples_per_class: {samples}
activities: [walking, punching, sitting_down]
radar: {{carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}}
snr_db: {{choice: [20, 10]}}
maps: [stft]
image: {{size_px: 64}}
split: {{train: 0.5, validation: 0.25, test: 0.25}}
"""


def radhar(*words: object) -> Any:
    """What the program reports."""
    command = [sys.executable, "-m", "radhar_cli", *map(str, words), "--json"]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def main(folder: Path, samples: int = 40, epochs: int = 10) -> None:
    """Do it in a folder and print the matrix."""
    folder.mkdir(parents=True, exist_ok=True)
    config = folder / "data.yaml"
    config.write_text(CONFIG.format(samples=samples))
    data, run = folder / "data", folder / "run"

    print(f"{radhar('generate', config, '-o', data)['samples']} samples in {data}")
    radhar("verify", data, "--samples", 3)
    best = radhar("train", data, "-o", run, "--set", f"epochs={epochs}")["best"]
    print(f"best epoch {best['epoch']}: validation accuracy {100 * best['val_accuracy']:.1f} %")
    report = radhar("eval", run, data, "--split", "test")
    print(f"test accuracy {100 * report['accuracy']['run']['data']:.1f} %; {report['page']}")
    with (run / "eval/confusion.csv").open(newline="") as file:
        for row in csv.reader(file):
            print("".join(f"{cell:>14}" for cell in row))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/confusion"))
