"""Body, antennas and wall -> paths, one a scatterer."""

from dataclasses import dataclass

from radhar_cli.arrays import Float
from radhar_cli.body.pose import Body
from radhar_cli.echo.paths import Paths
from radhar_cli.radar.propagation import Antennas, amplitude, bistatic_delay, leg
from radhar_cli.radar.transmission import transmission, wall_delay
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT


@dataclass(frozen=True)
class BodyPaths:
    """A source of paths: `PathSource` for a person seen through air or a wall.

    Attributes:
        body: scatterer positions over time.
        antennas: where the legs start and end.
        fc: carrier, Hz.
        wall: the slab between, or None.
        joints: numbers of the scatterers that are kept; all of them for None.
    """

    body: Body
    antennas: Antennas
    fc: float
    wall: Wall | None
    joints: tuple[int, ...] | None = None

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which positions are not smooth."""
        return self.body.kinks

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        return self.body.highest_frequency

    @property
    def smooth(self) -> bool:
        """Paths kink where a leg passes an edge of the wall."""
        return self.wall is None

    def __call__(self, t: Float) -> Paths:
        """Paths of the scatterers at times t [M] (s)."""
        p, sigma = self.body.positions(t), self.body.cross_sections
        if self.joints is not None:
            p, sigma = p[:, list(self.joints)], sigma[list(self.joints)]
        return self._paths(p, sigma)

    def torso_delay(self, t: Float) -> Float:
        """Delay (s) [M] of the torso, the wall's included."""
        p = self.body.torso(t)
        tau = bistatic_delay(leg(p, self.antennas.tx), leg(p, self.antennas.rx))
        if self.wall is not None:
            for antenna in (self.antennas.tx, self.antennas.rx):
                tau += wall_delay(p, antenna, self.wall)
        track: Float = tau[0]
        return track

    def _paths(self, p: Float, sigma: Float) -> Paths:
        r_tx, r_rx = leg(p, self.antennas.tx), leg(p, self.antennas.rx)
        tau = bistatic_delay(r_tx, r_rx)
        a = amplitude(r_tx, r_rx, sigma, self.antennas.gain, SPEED_OF_LIGHT / self.fc)
        if self.wall is not None:
            for antenna in (self.antennas.tx, self.antennas.rx):
                through = transmission(p, antenna, self.wall, self.fc)
                tau += through.delay
                a *= through.factor
        return Paths(tau, a)
