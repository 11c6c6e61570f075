"""Five activities in the point clouds of RadHAR, learned from simulated clouds alone.

    python scripts/radhar_classes.py FOLDER -o OUT [--per-class 60] [--seeds 3]

FOLDER: recordings `<class>*.npz` of boxing, jack, jump, squats and walk (github.com/nesl/RadHAR,
Singh et al. 2019): `points` [N, 9] = frame, x (ahead), y, z (up) m, velocity (receding) m/s, ...;
30 frames a second. Simulated ones come from configs/measured/radhar_1443.yaml. Both are cut to
where people stand: what stands in the room is left out, static points of the body are not. Windows
last 4 s, one begins every second. The network is that of `radhar train --model cloudnet`; it has
learned before the recordings are opened. The last line is for programs; windows of a recording
overlap, so n is not the number of independent ones.
"""

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from radhar_cli.dataset.reading import open_dataset
from radhar_cli.learning.models.cloudnet import CloudNet

Float = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "configs" / "measured" / "radhar_1443.yaml"
CLASSES = ("boxing", "jack", "jump", "squats", "walk")
FRAMES, EVERY = 120, 30  # of a window, and from one to the next
POINTS = 24
NEAR_M, FAR_M, ASIDE_M = 0.7, 2.6, 1.0
EPOCHS, BATCH = 40, 32


def window(frame: NDArray[np.intp], points: Float, first: int) -> NDArray[np.float32]:
    """FRAMES frames from `first` on as [6, FRAMES, POINTS]: x, y, z about their median, Doppler.

    Args:
        frame: of each point [N].
        points: x ahead, y left, z up (m), Doppler approaching (m/s) [N, 4].
        first: frame.
    """
    found = np.zeros((FRAMES, POINTS, 6), np.float32)
    here = (frame >= first) & (frame < first + FRAMES) & (np.abs(points[:, 1]) < ASIDE_M)
    reach = np.hypot(points[:, 0], points[:, 1])
    here &= (reach > NEAR_M) & (reach < FAR_M)
    some, at = points[here].copy(), frame[here] - first
    if len(some):
        some[:, :3] -= np.median(some[:, :3], axis=0)
    for number in range(FRAMES):
        mine = some[at == number][:POINTS]
        found[number, : len(mine), :4] = mine
        found[number, : len(mine), 5] = 1
    return found.transpose(2, 0, 1)


def simulated(out: Path, per_class: int, jobs: int) -> tuple[Tensor, Tensor]:
    """Windows [N, 6, T, K] and classes [N] of a data set that is built in `out`."""
    command = ["generate", str(CONFIG), "-o", str(out), "--jobs", str(jobs)]
    command += [
        "--set",
        f"samples_per_class={per_class}",
        "--set",
        f"duration_s={FRAMES / 30 + 0.05}",
    ]
    done = subprocess.run([sys.executable, "-m", "radhar_cli", *command], stdout=sys.stderr)
    if done.returncode:
        sys.exit(done.returncode)
    windows, labels = [], []
    with open_dataset(out) as data:
        names = [data.class_slugs[label] for label in data.label[:]]
        for row, name in enumerate(names):
            points = np.asarray(data.products["points"][row], float)[:, :4]
            start = data.products["points_start"][row]
            frame = np.repeat(np.arange(len(start) - 1), np.diff(start))
            windows.append(window(frame, points, 0))
            labels.append(CLASSES.index(name))
    return torch.from_numpy(np.stack(windows)), torch.tensor(labels)


def measured(folder: Path) -> tuple[Tensor, Tensor]:
    """Windows and classes of all recordings of a folder."""
    windows, labels = [], []
    for path in sorted(folder.glob("*.npz")):
        name = next((one for one in CLASSES if path.name.startswith(one)), None)
        if name is None:
            continue
        with np.load(path, allow_pickle=False) as file:
            rows = file["points"].astype(float)
        frame, points = rows[:, 0].astype(np.intp), rows[:, 1:5] * [1, 1, 1, -1]
        for first in range(0, int(frame.max()) - FRAMES + 2, EVERY):
            windows.append(window(frame, points, first))
            labels.append(CLASSES.index(name))
    if not windows:
        sys.exit(f"radhar_classes: {folder}: has no recording <class>*.npz of {', '.join(CLASSES)}")
    return torch.from_numpy(np.stack(windows)), torch.tensor(labels)


def changed(x: Tensor) -> Tensor:
    """Windows with a share of points left out, larger or smaller, moved, mirrored, later."""
    count = len(x)
    kept = torch.rand(count, 1, 1, 1).mul(0.6) < torch.rand(count, 1, FRAMES, POINTS)
    size = 1 + 0.15 * torch.randn(count, 3, 1, 1)
    side = torch.where(torch.rand(count, 1, 1) < 0.5, -1.0, 1.0)
    y = x.clone()
    y[:, :3] = x[:, :3] * size + 0.05 * torch.randn(count, 3, 1, 1)
    y[:, 1] *= side
    y = y.roll(int(torch.randint(FRAMES, (1,))), dims=2)
    return y * (kept & (y[:, 5:] > 0))


def trained(x: Tensor, labels: Tensor, seed: int) -> nn.Module:
    """A network that has learned all windows."""
    torch.manual_seed(seed)
    model = CloudNet(len(CLASSES))
    optimiser = torch.optim.AdamW(model.parameters(), 2e-3, weight_decay=1e-2)
    steps = EPOCHS * -(-len(x) // BATCH)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 3e-3, total_steps=steps)
    for _ in range(EPOCHS):
        for rows in torch.split(torch.randperm(len(x)), BATCH):
            logits = model(changed(x[rows]))
            loss = nn.functional.cross_entropy(logits, labels[rows], label_smoothing=0.1)
            optimiser.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimiser.step()
            schedule.step()
    return model.eval()


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="recordings, <class>*.npz")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--per-class", type=int, default=60, help="simulated samples of each class")
    parser.add_argument("--seeds", type=int, default=3, help="networks")
    parser.add_argument("--jobs", type=int, default=2, help="processes that generate")
    given = parser.parse_args()
    if not given.folder.is_dir():
        sys.exit(f"radhar_classes: {given.folder}: no such folder")
    x, labels = simulated(given.out / "simulated", given.per_class, given.jobs)
    models = [trained(x, labels, seed) for seed in range(1, given.seeds + 1)]
    seen, truth = measured(given.folder)
    confusion, shares = np.zeros((5, 5), int), []
    for model in models:
        with torch.inference_mode():
            found = torch.cat([model(part).argmax(1) for part in torch.split(seen, 64)])
        np.add.at(confusion, (truth.numpy(), found.numpy()), 1)
        shares.append(float((found == truth).float().mean()))
    print("rows are true classes, all seeds\n" + " " * 8 + "".join(f"{n:>8}" for n in CLASSES))
    for name, row in zip(CLASSES, confusion, strict=True):
        print(f"{name:8}" + "".join(f"{count:8d}" for count in row))
    print(
        f"accuracy on measured: mean {np.mean(shares):.3f}, lowest {min(shares):.3f}, "
        f"highest {max(shares):.3f}, n = {len(truth)} windows, {len(shares)} seeds"
    )


if __name__ == "__main__":
    main()
