"""Small downloads, written by the layouts of published sets."""

import struct
from pathlib import Path

import numpy as np

HEAD = "Frame #,# Obj,X,Y,Z,Doppler,Intensity"
SWEEPS, SAMPLES = 2000, 64


def glasgow_text(sweeps: int = SWEEPS) -> str:
    """Somebody who comes nearer at 1 m/s in range bin 12, in noise."""
    rng, t = np.random.default_rng(0), np.arange(sweeps)[:, None] / 1e3
    n = np.arange(SAMPLES)
    beat = np.exp(-2j * np.pi * (12 * n / SAMPLES - 2 * 5.8e9 / 3e8 * t))
    x = 100 * beat + rng.normal(size=beat.shape) + 1j * rng.normal(size=beat.shape)
    lines = (f"{v.real:.4g}{v.imag:+.4g}i" for v in x.ravel())
    return "\n".join(["5.8e9", "1", str(SAMPLES), "4e8", *lines, ""])


def write_glasgow(folder: Path) -> None:
    """Two campaigns with the same names, other case and padding, a cut file, another's file."""
    text = glasgow_text()
    for campaign in ("1 December 2017 Dataset", "2 March 2017 Dataset"):
        (folder / campaign).mkdir(parents=True)
        (folder / campaign / "1P36A01R01.dat").write_text(text)
    first = folder / "1 December 2017 Dataset"
    (first / "2p7a2r1.DAT").write_text(text)
    (first / "6P08A06R02.dat").write_text(text[: len(text) - 5000] + "12.5-")
    (first / "3P08A03R02.dat").write_text(text[:300] + "\nnothing\n" + text[300:])
    (first / "4P08A05R02.dat").write_text(text)
    (first / "readme.txt").write_text("no recording")


def mars_rows(frames: list[int], start: float = 0.0) -> list[str]:
    return [
        f"{frame},2,{0.25 * point},{2 + start},{0.5},{-0.356},{10 + point},1.6e+09"
        for frame in frames
        for point in range(2)
    ]


def write_mars(folder: Path) -> None:
    """Two movements, the first of which lost a frame; the Kinect missed the last frame."""
    place = folder / "synced_data/wooutlier/Subject1/timesplit"
    place.mkdir(parents=True)
    frames = [*range(10, 30), *range(31, 40), *range(900, 925)]
    for part in ("train", "validate", "test"):
        rows = [HEAD + ",Abs Time", *mars_rows(frames), "925,2,0.1"]
        (place / f"radar_data_{part}.csv").write_text("\n".join(rows))
        joints = [",".join(f"{a}{j}" for a in "xyz" for j in range(25))]
        for frame in frames[:-1]:
            x, y, z = np.arange(25) / 100, np.full(25, 2 + frame / 1e4), np.arange(25) / 10
            joints.append(",".join(map(str, np.concatenate([x, y, z]))))
        (place / f"kinect_data_{part}.csv").write_text("\n".join([*joints, ""]))


def radhar_message(point: int, time: float, velocity: float) -> str:
    secs, nsecs = int(time), round(time % 1 * 1e9)
    return (
        f"header: \n  seq: 1\n  stamp: \n    secs: {secs}\n    nsecs: {nsecs:>9}\n"
        f'  frame_id: "ti_mmwave"\npoint_id: {point}\nx: 2.0\ny: 0.5\nz: -0.25\nrange: 2.1\n'
        f"velocity: {velocity}\ndoppler_bin: 8\nbearing: -3.0\nintensity: 30.5\n"
    )


def write_radhar(folder: Path) -> None:
    """Pairs of frames, 30 a second, of which 30 are lost after two seconds; a cut file."""
    for part in ("Train", "Test"):
        for name in ("boxing", "walk"):
            messages = []
            for frame in range(150):
                time = 100 + frame // 2 / 15 + frame % 2 * 1e-3 + (frame >= 60)
                messages += [radhar_message(point, time, 0.6) for point in range(3)]
            text = "---\n".join(messages)
            (folder / part / name).mkdir(parents=True)
            for take in range(6 if part == "Train" else 1):
                (folder / part / name / f"_{take}_{name}.txt").write_text(text)
    (folder / "Test/walk/_9_walk.txt").write_text(text[:-20])
    (folder / "Test/walk/_8_walk.txt").write_text("header:\n")


def write_mhomeges(folder: Path) -> None:
    """Two repetitions of two gestures, one frame of zeros; an empty file."""
    for person in ("804", "805"):
        place = folder / f"longGes_1.2m/{person}"
        place.mkdir(parents=True)
        for gesture in ("circle", "Knock"):
            rows = [HEAD]
            for frame in [*range(148, 160), 170, *range(200, 212)]:
                count = 0 if frame == 170 else 2
                rows += [f"{frame},{count},0.5,1.5,0,0.356,{7 * (count > 0)}"] * max(count, 1)
            (place / f"point_{person}_1.2m_{gesture}.csv").write_text("\n".join([*rows, ""]))
    (folder / "longGes_1.2m/805/point_805_1.2m_push.csv").write_text(HEAD + "\n")


def write_mmfi(folder: Path) -> None:
    """Frame 3 has no file, frame 4 no point, and a file of another sequence is cut."""
    for person, action in ((1, 3), (2, 3), (2, 19)):
        place = folder / f"E01/S{person:02d}/A{action:02d}/mmwave"
        place.mkdir(parents=True)
        for frame in (*range(1, 3), *range(4, 31)):
            rows = [[1.0, 2.0, 3.0, 0.5, 9.0]] * (2 * (frame != 4))
            np.array(rows, "<f8").tofile(place / f"frame{frame:03d}.bin")
    (folder / "E01/S02/A19/mmwave/frame030.bin").write_bytes(struct.pack("<3d", 1, 2, 3))


def write_unimmhar(folder: Path, origin: int = 2) -> None:
    """Clips of 20 frames, filled up with zeros and with points that stand there twice."""
    for part in ("train", "test"):
        (folder / part).mkdir(parents=True)
        for number in range(6):
            clip = np.zeros((32, 64, 5), np.float32)
            clip[:20, :, :] = [2.0, 0.5, 0.25, 0.75, 30]
            clip[:20, 32:, 0] = 3.0
            name = f"D{origin:03d}A{number % 2:03d}P{number // 2:03d}S{number:04d}.npz"
            np.savez(folder / part / name, pointcloud=clip)


WRITERS = {
    "glasgow": write_glasgow,
    "mars": write_mars,
    "radhar": write_radhar,
    "mhomeges": write_mhomeges,
    "mmfi": write_mmfi,
    "unimmhar": write_unimmhar,
}
ASKED = ("axes=[right,ahead,up]", "doppler=receding")
SETTINGS = {"mmfi": ASKED, "glasgow": ("recordings.window_s=1", "recordings.hop_s=1")}
