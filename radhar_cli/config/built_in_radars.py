"""The radars that radhar comes with: profiles of TI boards for people indoors."""

from collections.abc import Iterator
from dataclasses import dataclass

from radhar_cli.config.documents import RADARS
from radhar_cli.files.untrusted import read_text
from radhar_cli.radar.detection import Chain
from radhar_cli.readers.ti.ti_cfg import MAX_CFG, BoardHeader, parse_ti_cfg


@dataclass(frozen=True)
class BuiltInRadar:
    """A profile that radhar comes with.

    Attributes:
        name: Name by which configs have it.
        device: Board that it is for.
        header: Content of its .cfg.
    """

    name: str
    device: str
    header: BoardHeader

    @property
    def chain(self) -> Chain:
        """Chain that finds its points: the firmware's, or `best` where that is not simulated."""
        return self.header.firmware or "best"

    @property
    def frames_per_s(self) -> float:
        """Frames per second."""
        return 1 / self.header.timing.period_s

    @property
    def description(self) -> str:
        """Line of its chain, frame rate, ranges and speeds."""
        timing = self.header.timing
        return (
            f"{self.chain}; {self.frames_per_s:.3g} frames a second, "
            f"ranges to {timing.farthest_m:.3g} m in steps of "
            f"{100 * timing.range_step_m:.2g} cm, +-{timing.fastest_mps:.2g} m/s in steps of "
            f"{timing.doppler_step_mps():.2g} m/s"
        )


def device_of(name: str) -> str:
    """Board that a built-in radar is for."""
    return name.partition("_")[0].upper()


def read_radars() -> Iterator[BuiltInRadar]:
    """Read all built-in radars, in the order of their names."""
    for name, path in RADARS.items():
        device = device_of(name)
        header = parse_ti_cfg(read_text(path, MAX_CFG), path.name, device)
        yield BuiltInRadar(name, device, header)
