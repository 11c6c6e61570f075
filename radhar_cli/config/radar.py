"""`radar:` waveform and antennas (paper, table "Experimental Parameter Settings")."""

from radhar_cli.config.number import Decibel, Positive, Vector
from radhar_cli.config.section import Flag, Section


class RadarConfig(Section):
    """Waveform, antenna positions and gains; every number may be drawn."""

    carrier_hz: Positive = 77e9
    bandwidth_hz: Positive = 4e9
    prf_hz: Positive = 5000.0
    adc_rate_hz: Positive = 10e6
    chirp_s: Positive = 40e-6
    tx_m: Vector = (0.4, -0.1, 1.5)
    rx_m: Vector = (0.4, 0.1, 1.5)
    antenna_gain_dbi: Decibel = 6.0
    antenna_isolation_db: Decibel = 10.0
    residual_video_phase: Flag = False
