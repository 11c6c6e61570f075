"""A capture as TI's card would write it, of a scene that is simulated."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from radhar_cli.config import Config
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.bodies.motion_paths import MotionPaths
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import nominal_scene

SPACING = 0.002  # between antennas, m


@dataclass(frozen=True)
class Radar:
    """A TI radar; the numbers are mmWave Studio's."""

    start_ghz: float = 60.0
    slope: float = 60.0
    samples: int = 64
    rate_ksps: float = 2500
    idle_us: float = 216.0
    adc_us: float = 6.0
    ramp_us: float = 34.0
    loops: int = 64
    period_ms: float = 40.0
    transmitters: tuple[int, ...] = (1, 4)
    receivers: int = 0b0011

    @property
    def interval(self) -> float:
        return (self.idle_us + self.ramp_us) * 1e-6

    @property
    def waveform(self) -> Waveform:
        rate, slope = self.rate_ksps * 1e3, self.slope * 1e12
        return Waveform(
            fc=self.start_ghz * 1e9 + slope * self.adc_us * 1e-6,
            bandwidth=slope * self.samples / rate,
            chirp=self.samples / rate,
            adc_rate=rate,
            prf=1 / (len(self.transmitters) * self.interval),
            duration=1.0,
        )

    def studio(self, **changed: object) -> dict[str, object]:
        """The header as mmWave Studio writes it."""
        profile = {
            "profileId": 0,
            "startFreqConst_GHz": self.start_ghz,
            "idleTimeConst_usec": self.idle_us,
            "adcStartTimeConst_usec": self.adc_us,
            "rampEndTime_usec": self.ramp_us,
            "freqSlopeConst_MHz_usec": self.slope,
            "numAdcSamples": self.samples,
            "digOutSampleRate": self.rate_ksps,
        } | {k: v for k, v in changed.items() if k.endswith(("usec", "GHz", "Samples", "Rate"))}
        chirps = [
            {"rlChirpCfg_t": {"chirpStartIdx": n, "chirpEndIdx": n, "profileId": 0,
                              "txEnable": hex(mask)}}
            for n, mask in enumerate(self.transmitters)
        ]  # fmt: skip
        frame = {
            "chirpStartIdx": 0,
            "chirpEndIdx": len(chirps) - 1,
            "numLoops": self.loops,
            "numFrames": 0,
            "framePeriodicity_msec": self.period_ms,
        } | {k: v for k, v in changed.items() if k.startswith(("num", "frame", "chirpEnd"))}
        frame.pop("numAdcSamples", None)
        lanes, order = changed.get("laneEn", "0x3"), changed.get("chInterleave", 1)
        return {
            "mmWaveDevices": [
                {
                    "rfConfig": {
                        "rlChanCfg_t": {"rxChannelEn": hex(self.receivers)},
                        "rlAdcOutCfg_t": {
                            "fmt": {"b2AdcBits": 2, "b2AdcOutFmt": changed.get("b2AdcOutFmt", 1)}
                        },
                        "rlProfiles": [{"rlProfileCfg_t": profile}],
                        "rlChirps": chirps,
                        "rlFrameCfg_t": frame,
                    },
                    "rawDataCaptureConfig": {
                        "rlDevDataFmtCfg_t": {
                            "iqSwapSel": changed.get("iqSwapSel", 0), "chInterleave": order
                        },
                        "rlDevDataPathCfg_t": {"transferFmtPkt0": "0x1"},
                        "rlDevLaneEnable_t": {"laneEn": lanes},
                    },
                }
            ]
        }  # fmt: skip

    def demo(self) -> str:
        """The header as the SDK's demos take it."""
        chirps = "\n".join(
            f"chirpCfg {n} {n} 0 0 0 0 0 {mask}" for n, mask in enumerate(self.transmitters)
        )
        return f"""% a comment
sensorStop
channelCfg {self.receivers} 5 0
adcCfg 2 1
adcbufCfg -1 0 0 1 1
profileCfg 0 {self.start_ghz} {self.idle_us} {self.adc_us} {self.ramp_us} 0 0 {self.slope} 1 """ + (
            f"{self.samples} {self.rate_ksps} 0 0 30\n{chirps}\n"
            f"frameCfg 0 {len(self.transmitters) - 1} {self.loops} 0 {self.period_ms} 1 0\n"
            "lvdsStreamCfg -1 0 1 0\n"
        )

    def times(self, frames: int, transmitter: int = 0) -> Float:
        """Times of the pulses of one transmitter, s."""
        turn = len(self.transmitters) * self.interval
        inside = np.arange(self.loops) * turn + transmitter * self.interval
        return (np.arange(frames)[:, None] * self.period_ms * 1e-3 + inside).ravel()


def body(config: Config, activity: str = "walking") -> Motion:
    """The motion of the middle scene of a config."""
    return motion_of(nominal_scene(config, config.chosen_activities[0]).people[0])


def echo(radar: Radar, motion: Motion, frames: int, seed: int = 0) -> Complex:
    """Beat [transmitter and receiver, sample, pulse] in radhar's sign, leakage and noise in it.

    The largest sample has size 1.
    """
    waveform, out = radar.waveform, []
    for k in range(len(radar.transmitters)):
        t = radar.times(frames, k)
        for r in range(radar.receivers.bit_count()):
            antennas = Antennas(
                (0.0, 2 * k * SPACING, 1.2), (0.0, 0.1 + r * SPACING, 1.2), 4.0, 10.0
            )
            paths = MotionPaths(motion, antennas, waveform.fc, None)(t)
            beat = beat_matrix(paths.delay, paths.amplitude, waveform)
            largest = float(np.abs(beat).max())
            still = np.full((1, t.size), 0.7 / 3e8)
            beat = beat + beat_matrix(still, np.full((1, t.size), 3 * largest), waveform)
            out.append(beat)
    stacked = np.stack(out)
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((2, *stacked.shape))
    stacked = stacked + 1e-3 * np.abs(stacked).max() * (noise[0] + 1j * noise[1])
    return stacked / np.abs(stacked).max()


def words(
    beat: Complex,
    transmitters: int,
    lanes: int = 2,
    interleaved: bool = False,
    real: bool = False,
    scale: float = 8000.0,
) -> np.ndarray[tuple[int], np.dtype[np.int16]]:
    """The stream of words of a capture; TI's beat is the complex conjugate of radhar's.

    Written here sample by sample, apart from the reader.
    """
    virtual, samples, pulses = beat.shape
    receivers = virtual // transmitters
    values = np.rint(np.conj(beat) * scale)
    cube = values.reshape(transmitters, receivers, samples, pulses)
    stream: list[np.ndarray] = []
    for pulse in range(pulses):
        for k in range(transmitters):
            chirp = cube[k, :, :, pulse]
            if interleaved:
                wide = np.zeros((4 if lanes == 4 else receivers, samples), complex)
                wide[:receivers] = chirp
                flat = wide.T.ravel()
            else:
                flat = chirp.ravel()
            if real:
                stream.append(flat.real)
                continue
            groups = flat.reshape(-1, lanes)
            stream.append(np.concatenate([groups.real, groups.imag], axis=1).ravel())
    return np.concatenate(stream).astype("<i2")


def write_studio(path: Path, radar: Radar, **changed: object) -> Path:
    path.write_text(json.dumps(radar.studio(**changed)))
    return path
