"""`radar:` waveform and antennas (paper, table "Experimental Parameter Settings")."""

from typing import Annotated

from radhar_cli.config.number import Decibel, Positive, Vector, within
from radhar_cli.config.section import Flag, Section


class RadarConfig(Section):
    """Waveform, antenna positions and gains; every number may be drawn."""

    carrier_hz: Annotated[Positive, within(1e6, 1e13, "Hz")] = 77e9
    bandwidth_hz: Annotated[Positive, within(1e3, 1e12, "Hz")] = 4e9
    prf_hz: Annotated[Positive, within(1e-3, 1e7, "Hz")] = 5000.0
    adc_rate_hz: Annotated[Positive, within(1e-3, 1e13, "Hz")] = 10e6
    chirp_s: Annotated[Positive, within(1e-12, 1e4, "s")] = 40e-6
    tx_m: Vector = (0.4, -0.1, 1.5)
    rx_m: Vector = (0.4, 0.1, 1.5)
    antenna_gain_dbi: Annotated[Decibel, within(-150, 150, "dBi")] = 6.0
    antenna_isolation_db: Decibel = 10.0
    residual_video_phase: Flag = False
