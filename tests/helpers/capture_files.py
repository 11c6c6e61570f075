"""Files of the page of captures: a tone in every format, range profiles, frames, and a script."""

import lzma
from pathlib import Path

import h5py
import numpy as np
from helpers.foreign_targets import LUA, RATE, frame, profiles, tone
from helpers.recorders import write_acconeer, write_infineon, write_x4_baseband
from scipy.io import savemat, wavfile


def write_all(folder: Path) -> None:
    """Write every file that the page names."""
    x = tone()
    wavfile.write(
        folder / "walk.wav",
        int(RATE),
        np.round(20000 * np.column_stack([x.real, x.imag])).astype("i2"),
    )
    rows = [f"{n / RATE:.6f},{v.real:.6f},{v.imag:.6f}" for n, v in enumerate(x)]
    (folder / "walk.csv").write_text("\n".join(["time,I,Q", *rows]))
    (folder / "walk.txt").write_text("\n".join(f"{v.real:.6f}{v.imag:+.6f}i" for v in x))
    savemat(folder / "pair.mat", {"I": x.real, "Q": x.imag})
    savemat(folder / "struct.mat", {"rec": {"data": x[None], "fs": RATE}})
    np.savez(folder / "pair.npz", ch_I=x.real, ch_Q=x.imag, temperature=np.float64(20))
    integers = np.zeros(x.size, [("r", "<i2"), ("i", "<i2")])
    integers["r"], integers["i"] = np.round(20000 * x.real), np.round(20000 * x.imag)
    with h5py.File(folder / "walk_int.h5", "w") as file:
        file["x"] = integers
    np.save(folder / "walk.npy", x)
    (folder / "walk.npy.xz").write_bytes(lzma.compress((folder / "walk.npy").read_bytes()))
    turns = np.round(20000 * np.stack([x.real, x.imag], axis=-1)).astype("i2")
    turns.tofile(folder / "turns.bin")
    np.save(folder / "x4.npy", profiles())
    write_x4_baseband(folder / "xethru_baseband_iq_20250501.dat")
    write_acconeer(folder / "a121.h5")
    write_infineon(folder)
    for index in range(6):
        np.save(folder / f"frame{index}.npy", frame(index, 4.0))
    (folder / "capture.lua").write_text(LUA)
    n, pulse = np.arange(256)[None], np.arange(512)[:, None]
    beat = 800 * np.exp(2j * np.pi * 0.05 * n) + 200 * np.exp(2j * np.pi * (0.11 * n + 0.2 * pulse))
    lanes = np.stack([beat.real, beat.imag], axis=-1).reshape(512, -1, 2, 2).transpose(0, 1, 3, 2)
    both = np.concatenate([lanes.reshape(512, -1)] * 2, axis=1)  # two receivers
    np.round(both).astype("<i2").tofile(folder / "adc_data_Raw_0.bin")
