"""What the high-pass of TI's receivers would take off a walker, which is not simulated.

Behind the mixer stand two high-passes of the first order, whose corners profileCfg chooses
(hpfCornerFreq1: 175, 235, 350, 700 kHz; hpfCornerFreq2: 350, 700, 1400, 2800 kHz, as scripts of
mmWave Studio list them; that each is of the first order is from memory of the data sheets). An
echo from a range R has the beat 2 K R/c, so near ones lose most:

    python scripts/studies/if_high_pass.py
"""

from math import log10

from radhar_cli.config.built_in_radars import RADARS, device_of
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.readers.ti.ti_cfg import parse_frames

CORNERS_HZ = {
    "hpfCornerFreq1": (175e3, 235e3, 350e3, 700e3),
    "hpfCornerFreq2": (350e3, 700e3, 1400e3, 2800e3),
}
RANGES_M = (1.0, 2.0, 4.0)


def attenuate(frequency_hz: float, corners_hz: list[float]) -> float:
    """Gain of high-passes of the first order, one behind the other.

    Args:
        frequency_hz: Frequency f, Hz.
        corners_hz: Frequency f_c of each, at which it takes 3 dB, Hz.

    Returns:
        The sum of -10 log10(1 + (f_c/f)^2), dB.
    """
    return -sum(10 * log10(1 + (corner / frequency_hz) ** 2) for corner in corners_hz)


def main() -> None:
    """Print a table of the built-in radars whose .cfg has profileCfg."""
    print("| radar | slope MHz/us | " + " | ".join(f"{r:g} m" for r in RANGES_M) + " |")
    print("|---" * (2 + len(RANGES_M)) + "|")
    for name, path in RADARS.items():
        headers, lines = parse_frames(path.read_text(), path.name)
        profiles = [line.numbers for line in lines if line.name == "profileCfg"]
        if not profiles or device_of(name).startswith("IWRL"):
            continue
        corners = [hz[int(profiles[-1][key])] for key, hz in CORNERS_HZ.items()]
        slope = headers[0].slope_hz
        losses = [attenuate(2 * slope * r / SPEED_OF_LIGHT, corners) for r in RANGES_M]
        cells = " | ".join(f"{loss:.1f}" for loss in losses)
        print(f"| {name} | {slope / 1e12:g} | {cells} |")


if __name__ == "__main__":
    main()
