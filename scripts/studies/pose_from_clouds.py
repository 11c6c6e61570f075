"""Joints out of point clouds: trained on measured or on simulated clouds, tested on measured ones.

    python scripts/studies/pose_from_clouds.py --train PAIRS.npz [--simulated]
        --test OTHER.npz -o OUT

The network has the size and the features of the one that came with MARS (An and Ogras, 2021): up to
64 points a frame, sorted by x, y and z, as 8 x 8 pixels of x, y, z, Doppler and intensity; two
convolutions and a dense layer. With --simulated the measured clouds of --train are not opened: the
joints are seen by the simulated board, anew for each of --draws. Files are laid out as
`clouds_against_measured.py` has them. Writes OUT/pose.json and pose.png. The last line is for
programs.
"""

import argparse
import json
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import torch
from clouds_against_measured import OFFSET_M, Float, Pairs, read_pairs, simulated_clouds
from torch import nn

ROOT = Path(__file__).resolve().parents[2]
CFG = ROOT / "configs" / "boards" / "iwr1443_10Hz.cfg"
POINTS, COLUMNS = 64, 5
SHOWN = 6


def features(clouds: list[Float]) -> Float:
    """[frame, 5, 8, 8]: points sorted by x, y, z, the rest zeros; intensity in bels."""
    found = np.zeros((len(clouds), POINTS, COLUMNS), np.float32)
    for frame, cloud in zip(found, clouds, strict=True):
        some = cloud[np.lexsort((cloud[:, 2], cloud[:, 1], cloud[:, 0]))][:POINTS]
        frame[: len(some)] = some
        frame[: len(some), 4] = np.log10(np.maximum(some[:, 4], 1))
    return found.transpose(0, 2, 1).reshape(len(clouds), COLUMNS, 8, 8)


def network(outputs: int) -> nn.Sequential:
    """Two convolutions and two dense layers."""
    return nn.Sequential(
        nn.Conv2d(COLUMNS, 16, 3, padding=1),
        nn.ReLU(),
        nn.Dropout(0.3),
        nn.Conv2d(16, 32, 3, padding=1),
        nn.ReLU(),
        nn.Dropout(0.3),
        nn.Flatten(),
        nn.Linear(32 * POINTS, 512),
        nn.ReLU(),
        nn.Dropout(0.3),
        nn.Linear(512, outputs),
    )


def trained(x: Float, joints: Float, epochs: int, seed: int) -> nn.Sequential:
    """A network that finds joints [frame, 75] less their mean in features [frame, 5, 8, 8]."""
    torch.manual_seed(seed)
    model = network(joints.shape[1])
    optimizer = torch.optim.AdamW(model.parameters(), 1e-3, weight_decay=1e-2)
    steps = epochs * -(-len(x) // 128)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 3e-3, total_steps=steps)
    inputs, targets = torch.from_numpy(x), torch.from_numpy(joints.astype(np.float32))
    for _ in range(epochs):
        for rows in torch.randperm(len(x)).split(128):
            loss = nn.functional.l1_loss(model(inputs[rows]), targets[rows])
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
    return model.eval()


def draw(pairs: Pairs, found: Float, path: Path) -> None:
    """Some frames from the front: true skeletons in grey, found ones in red."""
    figure, grid = plt.subplots(1, SHOWN, figsize=(2.2 * SHOWN, 3), sharey=True)
    for axes, n in zip(grid, np.linspace(0, len(found) - 1, SHOWN).astype(int), strict=True):
        for joints, colour in ((pairs.joints[n], "0.6"), (found[n], "tab:red")):
            for bone in pairs.bones():
                axes.plot(*joints[bone][:, [0, 2]].T, color=colour, linewidth=1.5)
        axes.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal", title=f"frame {n}")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--train", type=Path, required=True, help="pairs to learn from")
    parser.add_argument("--test", type=Path, required=True, help="pairs to test on")
    parser.add_argument("--simulated", action="store_true", help="simulate the clouds of --train")
    parser.add_argument("--cfg", type=Path, default=CFG, help="the board's .cfg")
    parser.add_argument("--draws", type=int, default=4, help="simulated clouds of each frame")
    parser.add_argument("--epochs", type=int, default=60, help="of all draws together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--out", type=Path, required=True)
    given = parser.parse_args()
    matplotlib.use("Agg")
    torch.use_deterministic_algorithms(True)
    given.out.mkdir(parents=True, exist_ok=True)
    train, test = read_pairs(given.train, clouds=not given.simulated), read_pairs(given.test)
    assert test.clouds is not None
    draws = 1
    if given.simulated:
        draws = given.draws
        seeds = range(given.seed, given.seed + draws)
        clouds = [cloud for s in seeds for cloud in simulated_clouds(train, given.cfg, s, OFFSET_M)]
    else:
        assert train.clouds is not None
        clouds = train.clouds
    mean = train.joints.mean(axis=0)
    targets = np.tile((train.joints - mean).reshape(len(train.joints), -1), (draws, 1))
    model = trained(features(clouds), targets, max(given.epochs // draws, 1), given.seed)
    with torch.inference_mode():
        found = model(torch.from_numpy(features(test.clouds))).numpy().reshape(test.joints.shape)
    found = found + mean
    off = found - test.joints
    mae, baseline = 100 * np.abs(off).mean(), 100 * np.abs(mean - test.joints).mean()
    by_joint = 100 * np.linalg.norm(off, axis=2).mean(axis=0)
    report = {
        "mean absolute error, cm": float(mae),
        "of the mean pose, cm": float(baseline),
        "mpjpe, cm": float(by_joint.mean()),
        "by joint, cm": dict(zip(test.names, by_joint.tolist(), strict=True)),
        "trained on": "simulated" if given.simulated else "measured",
    }
    (given.out / "pose.json").write_text(json.dumps(report, indent=1) + "\n")
    draw(test, found, given.out / "pose.png")
    for name, value in sorted(report["by joint, cm"].items(), key=lambda pair: pair[1]):  # type: ignore[attr-defined]
        print(f"{name:14} {value:5.1f} cm")
    print(
        f"mean absolute error: {mae:.2f} cm (mean pose {baseline:.2f} cm), "
        f"mpjpe: {by_joint.mean():.2f} cm, n = {len(found)} frames"
    )


if __name__ == "__main__":
    main()
