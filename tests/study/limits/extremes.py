"""Extreme settings as data: what each is refused for, warned of, or that it is fine.

They are the classes of setting of an outside verification, which tried 154 by hand: durations,
PRF, bandwidth, carrier, ranges, heights, speeds, walls, SNR, images, windows, frames, loops,
channels, still people, crowds and hopeless draws.
"""

from typing import Any, NamedTuple

from helpers.boards import CFG

from radhar_cli.config import Config
from radhar_cli.config.reading import validated

FMCW = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 1000, "chirp_s": 4e-5}
SMALL_CFG = CFG.replace("frameCfg 0 2 32", "frameCfg 0 2 12").replace("0 100 1 0", "0 50 1 0")
ONE_CHANNEL = (
    SMALL_CFG.replace("channelCfg 15 7 0", "channelCfg 1 1 0")
    .replace("chirpCfg 1 1 0 0 0 0 0 4\nchirpCfg 2 2 0 0 0 0 0 2\n", "")
    .replace("frameCfg 0 2 12", "frameCfg 0 0 12")
)
ONE_LOOP, TWO_LOOPS = (SMALL_CFG.replace("0 2 12 0", f"0 2 {n} 0") for n in (1, 2))
SIXTEEN = [[n, 0] for n in range(16)]
SEVEN_OTHERS = [
    {"motion": {"range_m": 2 + 0.7 * n, "cross_range_m": 1.5 * (-1) ** n}} for n in range(7)
]
STILL = {
    "subject": {"sway_ahead_m": 0, "sway_aside_m": 0, "chest_m": 0, "heart_m": 0},
    "motion": {"range_m": 2.5, "idle": {"fidget_hz": 0, "shuffle_hz": 0}},
    "activities": ["stationary"],
    "snr_db": None,
}
BASES: dict[str, dict[str, Any]] = {
    "fmcw": {"radar": {**FMCW, "adc_rate_hz": 2.5e6}},
    "sfcw": {
        "radar": {
            **{"waveform": "sfcw", "carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 1000},
            **{"steps": 64, "dwell_s": 1e-5},
        }
    },
    "cw": {"radar": {"waveform": "cw", "carrier_hz": 10e9, "prf_hz": 1000}},
    "impulse": {
        "radar": {
            **{"waveform": "impulse", "carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 200},
            **{"profile_m": [0, 6], "profile_samples": 300},
        },
        "processing": {"range_sum": "gated"},
        "maps": ["rtm", "stft"],
    },
    "board": {
        "radar": {"device": "IWR1443BOOST", "cfg": SMALL_CFG},
        "duration_s": 0.1,
        "cloud": {"chain": "best"},
        "maps": ["range_doppler", "points"],
    },
    "paper": {
        "radar": {**FMCW, "adc_rate_hz": 2.5e6},
        "motion": {"model": "paper", "range_m": 2.5},
        "maps": ["rtm", "stft"],
    },
    "walker": {
        "radar": {**FMCW, "adc_rate_hz": 2.5e6},
        "activities": ["walking"],
        "motion": {"range_m": 6, "angle_deg": 180},
    },
    "wall": {
        "radar": {**FMCW, "carrier_hz": 2e9, "adc_rate_hz": 2.5e6},
        "wall": {"center_m": [1.0, 0, 1.25]},
    },
    "still": {"radar": {**FMCW, "adc_rate_hz": 2.5e6}, **STILL},
    "still board": {
        "radar": {"device": "IWR1443BOOST", "cfg": SMALL_CFG},
        **STILL,
        "duration_s": 0.1,
        "cloud": {"chain": "best"},
        "maps": ["range_doppler", "points"],
    },
}
COMMON: dict[str, Any] = {
    "activities": ["punching"],
    "samples_per_class": 1,
    "duration_s": 0.5,
    "motion": {"range_m": 2.5},
    "maps": ["stft"],
    "image": {"size_px": 32},
    "processing": {"window_s": 0.1},
}


class Extreme(NamedTuple):
    """A setting, and what becomes of it.

    Attributes:
        base: name of the config that it changes.
        changes: {dotted key: value}.
        outcome: "fine", "warned" or "refused".
        words: part of what is said; "" for nothing.
    """

    base: str
    changes: dict[str, Any]
    outcome: str = "fine"
    words: str = ""

    def __str__(self) -> str:
        changes = ",".join(f"{key}={value}" for key, value in self.changes.items())
        return f"{self.base}-{changes}"[:70].replace("\n", " ")


def config_of(extreme: Extreme) -> Config:
    """The config of a setting.

    Raises:
        ConfigError: it is refused.
    """
    return validated(Config, document_of(extreme), "extreme.yaml", {})


def document_of(extreme: Extreme) -> dict[str, Any]:
    """Plain values of the config of a setting."""
    document: dict[str, Any] = {**COMMON, **BASES[extreme.base]}
    if extreme.base in ("board", "still board", "impulse"):
        document["processing"] = {**BASES[extreme.base].get("processing", {})}
    for key, value in extreme.changes.items():
        *names, last = key.split(".")
        place = document
        for name in names:
            place[name] = dict(place.get(name) or {})
            place = place[name]
        place[last] = value
    return document


# fmt: off
# ruff: noqa: E501
EXTREMES = (
    Extreme("fmcw", {"duration_s": 1e-09}, "refused", "duration_s = … should hold at least 2 pulses"),
    Extreme("fmcw", {"duration_s": 1e-10}, "refused", "duration_s = … should be from 1e-09 to 1e+07 s"),
    Extreme("fmcw", {"duration_s": 0.001}, "refused", "duration_s = … should hold at least 2 pulses"),
    Extreme("fmcw", {"duration_s": 0.1}, "refused", "processing.window_s = … should make the window at most the 99 pulses"),
    Extreme("fmcw", {"duration_s": 0.102}),
    Extreme("fmcw", {"duration_s": 600, "radar.prf_hz": 50, "processing.window_s": 1}, "warned", "faster than the Doppler PRF/2"),
    Extreme("fmcw", {"duration_s": 601}, "refused", "duration_s = … should be from 0 to 600 with motion.model"),
    Extreme("paper", {"duration_s": 10000.0, "radar.prf_hz": 1, "processing.window_s": 100}, "refused", "which is what the direct engine reaches here"),
    Extreme("paper", {"duration_s": 10000000.0, "radar.prf_hz": 1}, "refused", "processing.window_s = … should make the window of window_s * prf_hz"),
    Extreme("paper", {"duration_s": 10000000.0, "radar.prf_hz": 100}, "refused", "duration_s = … should give at most 16777216 pulses"),
    Extreme("paper", {"duration_s": 11000000.0}, "refused", "duration_s = … should be from 1e-09 to 1e+07 s"),
    Extreme("fmcw", {"processing.window_s": 0.499}),
    Extreme("fmcw", {"processing.window_s": 0.5}, "refused", "processing.window_s = … should make the window at most the 499 pulse"),
    Extreme("fmcw", {"processing.window_s": 0.008}),
    Extreme("fmcw", {"processing.window_s": 0.007}, "refused", "processing.window_s = … should make the window of window_s * prf_hz"),
    Extreme("fmcw", {"processing.window_s": 0}, "refused", "processing.window_s = … should be greater than 0"),
    Extreme("fmcw", {"radar.prf_hz": 0.001}, "refused", "duration_s = … should hold at least 2 pulses"),
    Extreme("fmcw", {"radar.prf_hz": 0.5, "duration_s": 60, "processing.window_s": 20}, "warned", "faster than the Doppler PRF/2"),
    Extreme("fmcw", {"radar.prf_hz": 20, "duration_s": 2, "processing.window_s": 0.5}, "warned", "faster than the Doppler PRF/2"),
    Extreme("fmcw", {"radar.prf_hz": 26000}, "refused", "radar.chirp_s = … should be at most the pulse interval 1/"),
    Extreme("fmcw", {"radar.prf_hz": 10000000.0, "radar.chirp_s": 9e-08, "radar.adc_rate_hz": 1000000000.0, "duration_s": 0.01, "processing.window_s": 0.001}),
    Extreme("fmcw", {"radar.prf_hz": 11000000.0}, "refused", "radar.prf_hz = … should be from 0.001 to 1e+07 Hz"),
    Extreme("fmcw", {"radar.bandwidth_hz": 1000.0}),
    Extreme("fmcw", {"radar.bandwidth_hz": 1000000.0}),
    Extreme("fmcw", {"radar.bandwidth_hz": 5000000000.0}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"radar.bandwidth_hz": 1000000000000.0}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"radar.bandwidth_hz": 900}, "refused", "radar.bandwidth_hz = … should be from 1000 to 1e+12 Hz"),
    Extreme("fmcw", {"radar.carrier_hz": 1000000.0}),
    Extreme("fmcw", {"radar.carrier_hz": 100000000.0}),
    Extreme("fmcw", {"radar.carrier_hz": 300000000000.0}, "warned", "faster than the Doppler PRF/2"),
    Extreme("fmcw", {"radar.carrier_hz": 10000000000000.0}, "warned", "positions are frozen"),
    Extreme("fmcw", {"radar.carrier_hz": 900000.0}, "refused", "radar.carrier_hz = … should be from 1e+06 to 1e+13 Hz"),
    Extreme("fmcw", {"radar.adc_rate_hz": 50000.0}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"radar.adc_rate_hz": 30000.0}, "refused", "radar.adc_rate_hz = … should give at least 2 ADC samples per chirp"),
    Extreme("fmcw", {"radar.adc_rate_hz": 10000000000000.0}, "refused", "radar.adc_rate_hz = … should give at most 1048576 ADC samples per"),
    Extreme("fmcw", {"radar.adc_rate_hz": 1000000000.0}),
    Extreme("fmcw", {"radar.chirp_s": 1e-12}, "refused", "radar.adc_rate_hz = … should give at least 2 ADC samples per chirp"),
    Extreme("fmcw", {"radar.chirp_s": 1e-06}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"radar.chirp_s": 0.0011}, "refused", "radar.chirp_s = … should be at most the pulse interval 1/"),
    Extreme("fmcw", {"radar.chirp_s": 0.00099}),
    Extreme("fmcw", {"motion.range_m": 1.0}),
    Extreme("fmcw", {"motion.range_m": 14}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"motion.range_m": 16}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"motion.range_m": 16, "on_invalid": "keep"}, "warned", "half-band"),
    Extreme("fmcw", {"motion.range_m": 16, "on_invalid": "error"}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"motion.range_m": 1000000.0}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"motion.range_m": 1000000.0, "on_invalid": "keep"}, "warned", "half-band"),
    Extreme("fmcw", {"motion.range_m": 1100000.0}, "refused", "motion.range_m = … should be within 1e6 m of the origin"),
    Extreme("fmcw", {"motion.range_m": -5}),
    Extreme("paper", {"motion.range_m": 1000000.0}, "warned", "half-band"),
    Extreme("paper", {"motion.range_m": 0.4}, "warned", "walks through the radar"),
    Extreme("paper", {"motion.range_m": 100000.0, "radar.carrier_hz": 10000000000000.0}, "warned", "half-band"),
    Extreme("fmcw", {"motion.cross_range_m": -1000000.0}, "refused", "leaves the range half-band"),
    Extreme("walker", {"motion.range_m": 1.0}),
    Extreme("walker", {"motion.range_m": 10, "motion.angle_deg": 0, "duration_s": 10}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"subject.height_m": 1.0}),
    Extreme("fmcw", {"subject.height_m": 2.1}),
    Extreme("fmcw", {"subject.height_m": 0.99}, "refused", "subject.height_m = … should be from 1 to 2.1 with motion.model"),
    Extreme("fmcw", {"subject.height_m": 2.2}, "refused", "subject.height_m = … should be from 1 to 2.1 with motion.model"),
    Extreme("paper", {"subject.height_m": 0.1}),
    Extreme("paper", {"subject.height_m": 10}, "warned", "half-band"),
    Extreme("paper", {"subject.height_m": 11}, "refused", "subject.height_m = … should be from 0.1 to 10 m"),
    Extreme("fmcw", {"subject.weight_kg": 0.001}),
    Extreme("fmcw", {"subject.weight_kg": 1000000.0}),
    Extreme("fmcw", {"subject.weight_kg": 0}, "refused", "subject.weight_kg = … should be above 0"),
    Extreme("walker", {"motion.walking.speed_mps": 0.3}),
    Extreme("walker", {"motion.walking.speed_mps": 2.8}, "warned", "faster than the Doppler PRF/2"),
    Extreme("walker", {"motion.walking.speed_mps": 2.9}, "refused", "motion.walking.speed_mps = … should be from 0.3 to 2.8 with motion.model"),
    Extreme("walker", {"motion.walking.speed_mps": 0.0}, "refused", "motion.walking.speed_mps = … should be from 0.3 to 2.8 with motion.model"),
    Extreme("walker", {"motion.model": "paper", "motion.walking.speed_mps": 0}),
    Extreme("walker", {"motion.model": "paper", "motion.walking.speed_mps": 30}, "warned", "half-band"),
    Extreme("walker", {"motion.model": "paper", "motion.walking.speed_mps": 10000.0}, "warned", "half-band"),
    Extreme("walker", {"radar.prf_hz": 60}, "refused", "processing.window_s = … should make the window of window_s * prf_hz"),
    Extreme("fmcw", {"motion.angle_deg": 360}),
    Extreme("fmcw", {"motion.angle_deg": 361}, "refused", "motion.angle_deg = … should be from -360 to 360 degrees"),
    Extreme("fmcw", {"motion.striking.punch_hz": 1.1}),
    Extreme("fmcw", {"motion.striking.punch_hz": 1.2}, "refused", "motion.striking.punch_hz = … should be from 0.05 to 1.1 with motion.model"),
    Extreme("fmcw", {"motion.striking.punch_hz": 0.05}),
    Extreme("paper", {"motion.paper.gait_hz": 1000}, "refused", "which is what the direct engine reaches here"),
    Extreme("paper", {"motion.paper.gait_hz": 0}),
    Extreme("fmcw", {"timing.onset": 1}),
    Extreme("fmcw", {"activities": ["sitting_to_walking"], "timing.walk_begin_s": 1.0}, "warned", "timing.walk_begin_s has no effect"),
    Extreme("fmcw", {"activities": ["standing_up"], "timing.rise_duration_s": 60}, "warned", "timing.rise_duration_s has no effect"),
    Extreme("fmcw", {"activities": ["walking_to_falling"], "timing.fall_duration_s": 0.7, "timing.walk_stop_s": 0.5, "duration_s": 2, "motion.range_m": 6}),
    Extreme("wall", {"wall.eps_r": 1}),
    Extreme("wall", {"wall.eps_r": 0.9}, "refused", "wall.eps_r = … should be 1 or more"),
    Extreme("wall", {"wall.eps_r": 1000000.0}, "refused", "leaves the range half-band"),
    Extreme("wall", {"wall.loss_tangent": 0}),
    Extreme("wall", {"wall.loss_tangent": 1}, "warned", "the wall takes"),
    Extreme("wall", {"wall.loss_tangent": 10}, "warned", "the wall takes"),
    Extreme("wall", {"wall.loss_tangent": 10, "snr_reference": "received"}),
    Extreme("wall", {"wall.loss_tangent": 100, "snr_reference": "received"}, "refused", "the echo's power is"),
    Extreme("wall", {"wall.loss_tangent": 1000000000000.0}, "refused", "leaves the range half-band"),
    Extreme("wall", {"wall.loss_tangent": 1000000000000.0, "snr_db": None}, "refused", "leaves the range half-band"),
    Extreme("wall", {"wall.loss_tangent": 10, "snr_db": None}),
    Extreme("wall", {"wall.size_m": [1e-06, 5, 2.5]}),
    Extreme("wall", {"wall.size_m": [0.24, 1e-06, 2.5]}),
    Extreme("wall", {"wall.size_m": [0.24, 1000000.0, 1000000.0]}),
    Extreme("wall", {"wall.size_m": [1, 5, 2.5]}),
    Extreme("wall", {"wall.center_m": [0.4, 0, 1.25]}, "refused", "radar.tx_m = … should be outside the wall, whose faces coun"),
    Extreme("wall", {"wall.center_m": [2.5, 0, 1.25]}, "refused", "passes through the wall"),
    Extreme("wall", {"wall.center_m": [2.5, 0, 1.25], "on_invalid": "keep"}, "warned", "passes through the wall"),
    Extreme("wall", {"wall.eps_r": 1000000.0, "wall.rays": "refracted"}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"snr_db": -400}, "refused", "snr_db = … should be from -300 to 300 dB"),
    Extreme("fmcw", {"snr_db": -300}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"snr_db": -60}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"snr_db": -20}),
    Extreme("fmcw", {"snr_db": 0}),
    Extreme("fmcw", {"snr_db": 120}),
    Extreme("fmcw", {"snr_db": 300}),
    Extreme("fmcw", {"snr_db": 400}, "refused", "snr_db = … should be from -300 to 300 dB"),
    Extreme("fmcw", {"snr_db": None}),
    Extreme("fmcw", {"receiver.noise_figure_db": 0}),
    Extreme("fmcw", {"receiver.noise_figure_db": 100}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"receiver.noise_figure_db": 10, "radar.transmit_power_dbm": -300}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"receiver.noise_figure_db": 10, "radar.transmit_power_dbm": 300}),
    Extreme("fmcw", {"receiver.noise_figure_db": 10, "radar.antenna_gain_dbi": -150}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"radar.antenna_gain_dbi": 150}),
    Extreme("fmcw", {"radar.antenna_gain_dbi": -150}),
    Extreme("cw", {"snr_db": -300}, "warned", "maps show noise alone"),
    Extreme("sfcw", {"snr_db": -300}, "warned", "maps show noise alone"),
    Extreme("impulse", {"snr_db": -300}, "warned", "maps show noise alone"),
    Extreme("fmcw", {"image.size_px": 1}, "refused", "image.size_px.0 = … should be greater than or equal to 2"),
    Extreme("fmcw", {"image.size_px": 2}),
    Extreme("fmcw", {"image.size_px": [2, 300]}),
    Extreme("fmcw", {"image.size_px": 2048}),
    Extreme("fmcw", {"image.size_px": 8193}, "refused", "image.size_px.0 = … should be less than or equal to 8192"),
    Extreme("fmcw", {"image.dynamic_range_db": 1e-06}),
    Extreme("fmcw", {"image.dynamic_range_db": 300}),
    Extreme("fmcw", {"image.dynamic_range_db": 0}, "refused", "image.dynamic_range_db = … should be greater than 0"),
    Extreme("fmcw", {"image.kind": "cfar", "image.cfar": {"guard": [1, 1], "training": [2, 2], "pfa": 1e-12}}, "warned", "black"),
    Extreme("fmcw", {"image.kind": "cfar", "image.cfar": {"guard": [1, 1], "training": [2, 2], "pfa": 0.999}}),
    Extreme("fmcw", {"image.kind": "cfar", "image.cfar": {"guard": [9, 9], "training": [9, 9]}}, "refused", "image.cfar.training = … should fit into the image of 32 x 32 pixels"),
    Extreme("fmcw", {"image.kind": "cfar", "image.cfar": {"guard": [0, 0], "training": [0, 0]}}, "refused", "image.cfar.training = … should be 1 or more of a side"),
    Extreme("board", {"image.size_px": 2}, "warned", "black"),
    Extreme("fmcw", {"processing.overlap_fraction": 0}),
    Extreme("fmcw", {"processing.overlap_fraction": 0.9999}),
    Extreme("fmcw", {"processing.overlap_fraction": 1}, "refused", "processing.overlap_fraction = … should be less than 1"),
    Extreme("fmcw", {"processing.stft_fft_length": 6400}),
    Extreme("fmcw", {"processing.stft_fft_length": 6402}, "refused", "processing.stft_fft_length = … should be null or at most 64 times the windo"),
    Extreme("fmcw", {"processing.stft_fft_length": 98}, "refused", "processing.stft_fft_length = … should be null or at least the window of 100"),
    Extreme("fmcw", {"maps": ["stft_denoised"], "processing.savgol": {"order": 30, "frame": 499}}),
    Extreme("fmcw", {"maps": ["stft_denoised"], "processing.savgol": {"order": 3, "frame": 501}}, "refused", "processing.savgol.frame = … should be at most the 499 pulses there are"),
    Extreme("fmcw", {"maps": ["fsst"], "processing.fsst_threshold": 0.999}),
    Extreme("fmcw", {"maps": ["fsst"], "processing.fsst_hop_pulses": 16777216}),
    Extreme("fmcw", {"processing.range_fft_length": 6400}),
    Extreme("fmcw", {"processing.range_fft_length": 6402}, "refused", "processing.range_fft_length = … should be null or at most 64 times the 100 A"),
    Extreme("fmcw", {"processing.clutter": "highpass", "processing.highpass": {"order": 10, "cutoff_hz": 0.049}}, "refused", "processing.highpass.cutoff_hz = … should be from 0.0001 times PRF/2 to below P"),
    Extreme("fmcw", {"processing.clutter": "highpass", "processing.highpass": {"order": 10, "cutoff_hz": 499}}),
    Extreme("fmcw", {"processing.clutter": "highpass", "processing.highpass": {"order": 10, "cutoff_hz": 500}}, "refused", "processing.highpass.cutoff_hz = … should be from 0.0001 times PRF/2 to below P"),
    Extreme("fmcw", {"processing.range_sum": "gated", "processing.gate_m": 1e-06}),
    Extreme("fmcw", {"processing.range_sum": "gated", "processing.gate_m": 7.0}, "refused", "processing.gate_m = … should be less than half the range half-band"),
    Extreme("fmcw", {"processing.range_sum": "gated", "processing.gate_m": [1, 16]}, "refused", "processing.gate_m = … should end before the range half-band does,"),
    Extreme("fmcw", {"processing.range_sum": "gated", "processing.gate_m": [5, 6]}, "warned", "processing.gate_m"),
    Extreme("fmcw", {"image.doppler_limits_mps": [-8, 8]}, "refused", "image.doppler_limits_mps = … should be within the unambiguous band, -7.13"),
    Extreme("fmcw", {"image.doppler_limits_mps": [-0.01, 0.01]}, "refused", "image.doppler_limits_mps = … should hold at least 2 Doppler bins"),
    Extreme("fmcw", {"maps": ["rtm"], "image.range_limits_m": [0, 0.1]}, "refused", "image.range_limits_m = … should hold at least 2 range bins"),
    Extreme("fmcw", {"engine.tolerance_db": -400}, "refused", "which is what the direct engine reaches here"),
    Extreme("fmcw", {"engine.tolerance_db": -400, "engine.fallback": "cube"}),
    Extreme("fmcw", {"engine.tolerance_db": -200}),
    Extreme("fmcw", {"engine.tolerance_db": -6}, "warned", "looser than the default"),
    Extreme("fmcw", {"engine.tolerance_db": -5}, "refused", "engine.tolerance_db = … should be less than or equal to -6"),
    Extreme("fmcw", {"body.points_per_segment": 1000, "body.scatterers": "segments"}),
    Extreme("fmcw", {"body.points_per_segment": 1, "body.scatterers": "segments"}),
    Extreme("fmcw", {"body.points_per_segment": 1001}, "refused", "body.points_per_segment = … should be less than or equal to 1000"),
    Extreme("fmcw", {"seed": 2**63 - 1}),
    Extreme("fmcw", {"seed": 2**63}, "refused", "seed = … should be less than 9223372036854775808"),
    Extreme("fmcw", {"activities": ["nobody"]}),
    Extreme("fmcw", {"activities": ["nobody"], "snr_db": None}, "warned", "black"),
    Extreme("still", {}, "warned", "black"),
    Extreme("still", {"snr_db": 30.0}),
    Extreme("still board", {}, "warned", "black"),
    Extreme("still board", {"processing.clutter": "none"}),
    Extreme("fmcw", {"people": SEVEN_OTHERS, "duration_s": 0.2}),
    Extreme("fmcw", {"people": [{}] * 8}, "refused", "people = … should have at most 7 items, not 8"),
    Extreme("fmcw", {"people": [{}] * 9}, "refused", "people = … should have at most 7 items, not 9"),
    Extreme("board", {"radar.cfg": ONE_CHANNEL}),
    Extreme("board", {"radar.cfg": ONE_CHANNEL, "maps": ["range_azimuth"]}, "refused", "maps = … should be some of rtm, stft, stft_denoised,"),
    Extreme("board", {"radar.cfg": ONE_LOOP}),
    Extreme("board", {"radar.cfg": ONE_LOOP, "processing.clutter": "none"}),
    Extreme("board", {"radar.cfg": TWO_LOOPS}, "refused", "maps = … should be some of rtm, azimuth_time, "),
    Extreme("board", {"duration_s": 0.05}),
    Extreme("board", {"duration_s": 0.05, "maps": ["stft", "range_doppler"]}, "warned", "cloud has no effect"),
    Extreme("board", {"duration_s": 0.04}, "refused", "duration_s = … should hold a frame of 0.05 s"),
    Extreme("board", {"duration_s": 600}, "refused", "duration_s = … should be at most 583 s"),
    Extreme("board", {"radar.array": {"tx": [[0, 0], [2, 1], [4, 0]], "rx": [[0, 0], [1, 0], [2, 0], [3, 0]]}}),
    Extreme("board", {"radar.array": {"tx": [[0, 0]] * 3, "rx": [[0, 0]] * 4}}, "refused", "radar.array = … should be places apart"),
    Extreme("board", {"radar.array": {"tx": [[0, 0], [0, 1], [0, 2]], "rx": [[0, 0]] * 4}}, "refused", "radar.array = … should be places apart"),
    Extreme("board", {"radar.array": {"tx": [[0, 0]] * 5, "rx": [[0, 0]] * 4}}, "refused", "radar.array.tx = … should have at most 4 items, not 5"),
    Extreme("board", {"radar.array": {"tx": SIXTEEN, "rx": SIXTEEN}}, "refused", "radar.array.tx = … should have at most 4 items, not 16"),
    Extreme("board", {"radar.yaw_deg": 180}, "warned", "the beam takes"),
    Extreme("board", {"radar.tilt_deg": 90}, "warned", "the beam takes"),
    Extreme("board", {"wall": {"center_m": [1, 0, 1.25]}}, "warned", "the wall takes"),
    Extreme("board", {"motion.range_m": 7}, "refused", "leaves the range half-band"),
    Extreme("board", {"motion.range_m": 9}, "refused", "leaves the range half-band"),
    Extreme("board", {"motion.range_m": 9, "on_invalid": "keep"}, "warned", "half-band"),
    Extreme("board", {"receiver.noise_figure_db": 100}, "warned", "maps show noise alone"),
    Extreme("board", {"snr_db": 300}),
    Extreme("board", {"snr_db": -300}, "warned", "maps show noise alone"),
    Extreme("board", {"receiver.channel_gain_db": 20, "receiver.channel_phase_deg": 180, "duration_s": 0.5}),
    Extreme("board", {"radar.half_wavelength_m": 1.0}, "refused", "maps = … should be some of rtm, stft, stft_denoised,"),
    Extreme("board", {"maps": ["fsst"]}, "refused", "maps = … should be some of rtm, stft, stft_denoised,"),
    Extreme("board", {"cloud.pfa": 1e-300}),
    Extreme("board", {"cloud.pfa": 0.1}),
    Extreme("board", {"cloud.pfa": 0.2}, "refused", "cloud.pfa = … should be less than or equal to 0.1"),
    Extreme("board", {"maps": ["stft"], "processing.window_s": 0.1}, "warned", "cloud has no effect"),
    Extreme("fmcw", {"room.reflectors": [{}] * 32}),
    Extreme("fmcw", {"room.reflectors": [{}] * 33}, "refused", "room.reflectors = … should have at most 32 items, not 33"),
    Extreme("fmcw", {"room.reflectors": [{"rcs_dbsm": 120, "position_m": [3, 1, 1]}]}),
    Extreme("fmcw", {"room.reflectors": [{"position_m": [0.4, -0.1, 1.5]}]}, "refused", "the model holds from 5 cm on"),
    Extreme("fmcw", {"room.back_wall_m": 2.6}),
    Extreme("fmcw", {"room.back_wall_m": 1.0}, "refused", "room.back_wall_m = … should be beyond the people, who stand at up"),
    Extreme("fmcw", {"room.back_wall_m": 10000.0}),
    Extreme("fmcw", {"room.order": 3, "room.faces": {"floor": "concrete"}}, "refused", "room.order = … should be less than or equal to 2"),
    Extreme("fmcw", {"room.order": 2, "room.faces": {"floor": "metal", "back": "metal", "left": "metal"}, "room.box_m": {"x": [-1, 4], "y": [-2, 2]}}),
    Extreme("fmcw", {"room.faces": {"floor": "concrete"}}),
    Extreme("fmcw", {"room.faces": {"back": "metal"}, "room.box_m": {"x": [-1, 2]}}, "refused", "motion.range_m = … should be inside room.box_m.x, -1 to 2 m"),
    Extreme("fmcw", {"receiver.tones": [{"doppler_hz": 20}] * 16}),
    Extreme("fmcw", {"receiver.tones": [{"doppler_hz": 20}] * 17}, "refused", "receiver.tones = … should have at most 16 items, not 17"),
    Extreme("fmcw", {"receiver.tones": [{"doppler_hz": 501}]}, "warned", "the tone aliases"),
    Extreme("fmcw", {"receiver.tones": [{"doppler_hz": 20, "level_db": 300}]}),
    Extreme("fmcw", {"receiver.noise_corner_hz": 10000000.0}),
    Extreme("fmcw", {"radar.beam": {"azimuth_deg": 1, "elevation_deg": 1, "pan_deg": 180, "most_db": 120}}, "warned", "the beam takes"),
    Extreme("fmcw", {"radar.beam": {"azimuth_deg": 1000, "elevation_deg": 1000}}),
    Extreme("fmcw", {"radar.tx_m": [-1000000.0, 0, 1.5]}, "refused", "leaves the range half-band"),
    Extreme("fmcw", {"radar.tx_m": [0.4, 0, 1000.0]}, "refused", "leaves the range half-band"),
    Extreme("sfcw", {"radar.steps": 2}, "refused", "leaves the range half-band"),
    Extreme("sfcw", {"radar.steps": 1}, "refused", "radar.steps = … should be greater than or equal to 2"),
    Extreme("sfcw", {"radar.steps": 99}),
    Extreme("sfcw", {"radar.steps": 1048576}, "refused", "radar.steps = … should be at most the pulse interval 1/"),
    Extreme("sfcw", {"radar.dwell_s": 1e-09}),
    Extreme("sfcw", {"radar.prf_hz": 15, "radar.dwell_s": 0.001, "duration_s": 3, "processing.window_s": 1, "activities": ["walking"], "motion.range_m": 3}, "warned", "positions are frozen"),
    Extreme("cw", {"radar.prf_hz": 10000000.0, "duration_s": 0.01, "processing.window_s": 0.001}),
    Extreme("cw", {"maps": ["rtm"]}, "refused", "maps = … should be some of stft, stft_denoised, stft_"),
    Extreme("cw", {"radar.output": "real", "maps": ["stft_compensated"]}, "refused", "maps = … should be some of stft, stft_denoised, fsst,"),
    Extreme("impulse", {"radar.profile_m": [0, 1000000.0]}, "refused", "radar.profile_samples = … should be 46698974 or more"),
    Extreme("impulse", {"radar.profile_m": [0, 2]}, "refused", "processing.gate_m = … should be less than half the range half-band"),
    Extreme("impulse", {"radar.profile_m": [3, 2]}, "refused", "radar.profile_m = … should be [from, to], 0 <= from < to, with r"),
    Extreme("impulse", {"radar.profile_samples": 2}, "refused", "radar.profile_samples = … should be 281 or more"),
    Extreme("impulse", {"radar.bandwidth_hz": 1000000000000.0}, "refused", "radar.profile_samples = … should be 120244 or more"),
    Extreme("impulse", {"radar.carrier_hz": 10000000000000.0}, "refused", "radar.profile_samples = … should be 800674 or more"),
    Extreme("impulse", {"maps": ["fsst"]}, "refused", "maps = … should be some of rtm, stft"),
    Extreme("impulse", {"engine.kind": "cube"}, "refused", "engine.kind = … should be direct with radar.waveform"),
)
# Those that take a second and more: drawn a thousand times before they are refused, or long.
SLOW_EXTREMES = (
    Extreme("fmcw", {"radar.prf_hz": 24000}),
    Extreme("fmcw", {"motion.range_m": 0.4}, "refused", "walks through the radar"),
    Extreme("walker", {"motion.range_m": 3, "duration_s": 6}, "refused", "walks through the radar"),
    Extreme("fmcw", {"processing.clutter": "highpass", "processing.highpass": {"order": 10, "cutoff_hz": 0.051}}),
    Extreme("fmcw", {"people": [{"motion": {"range_m": 2.5, "cross_range_m": 0.0}}]}, "refused", "within 0.5 m of another person"),
    Extreme("fmcw", {"radar.tx_m": [2.5, 0, 1.2]}, "refused", "walks through the radar"),
)
# fmt: on
