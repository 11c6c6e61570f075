"""Whether maps show people above the noise: the SNR of a map's cell, from that of a raw sample.

A map gathers the echo of a scatterer in few cells, and spreads white noise over all of them. If all
of the echo is in one cell, its SNR there is that of a raw sample times

    sum over range bins    |G|^2/sum |D|^2, 2 of half of the bins (`half_band_sum.py`)
    range-time map         N_ADC, less what the window over the chirp costs: (sum w)^2/sum w^2
    gate of K bins         1/sqrt(K) of it: powers are summed, whose noise fluctuates sqrt(K) less
    window g of L pulses   (sum g)^2/sum g^2, 2 L/3 of Hann's; besides, of Doppler-time maps
    frames of a board      2/3 N_ADC, and 2/3 of the loops where Doppler bins stay apart
    V channels             V at most, whatever is made of them
"""

from math import inf, log10, sqrt

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import ANGLE_TIME_MAPS, FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.echo.receiver.noise_law import Silent, Snr
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.look import noise_gain, weights
from radhar_cli.processing.map_kind import RTM, kind_of
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.propagation import amplitude, leg
from radhar_cli.radar.wall_rays import transmission
from radhar_cli.scene.checks.validity import MIN_DISTANCE_M
from radhar_cli.scene.products.noise import noise_law_of
from radhar_cli.scene.radar import antennas_of, board_of, waveform_of
from radhar_cli.scene.room import wall_of
from radhar_cli.scene.scene import Person, Scene, nominal_scene

# SNR of a cell with all of the echo, below which images are those of noise: people fill many cells,
# so that each has less, although scatterers that meet in one may add in amplitude. In images of
# walkers, the cells that are theirs without noise are there brighter than others by less than 0.1
# of the standard deviation of the noise, and of people who do not walk by less.
LEAST_CELL_SNR_DB = -6.0
HANN = 2 / 3  # (sum g)^2/sum g^2 of Hann's window, per sample
TINY = 1e-300  # below which a factor counts as 0
HIDES_DB = 3.0  # what a wall or beam takes at least to be named
AWAY_DB = 20.0  # loss of the beam, both ways, from which it looks away from people
CHEST_M = 1.0  # height of the chest of somebody of usual stature, roughly, m


def noise_alone(config: Config) -> list[str]:
    """Warn that nothing but noise is left of people in every map of a config.

    Judged by the middle of all draws, of the first activity: by `snr_db`, or by one scatterer of
    1 m^2 in thermal noise where people begin, less what wall and beam take.
    """
    law = noise_law_of(config)
    if isinstance(law, Silent):
        return []
    scene = nominal_scene(config, config.chosen_activities[0])
    losses = _losses_db(scene)
    if isinstance(law, Snr):
        snr, noise = law.decibels, f"snr_db = {round(law.decibels, 1):g}"
        if config.snr_reference != "free_space":
            losses = {}
    else:
        snr = _thermal_snr_db(scene)
        noise = f"thermal noise, in which 1 m^2 has {snr:.0f} dB in a raw sample,"
    gains = {name: cell_gain_db(scene, name) for name in config.maps}
    best = max(gains, key=lambda name: gains[name], default="")
    gain = gains.get(best, inf)
    if snr - sum(losses.values()) + gain > LEAST_CELL_SNR_DB:
        return []
    large = {obstacle: loss for obstacle, loss in losses.items() if loss > HIDES_DB}
    last_keys = ["motion.range_m", "radar.transmit_power_dbm", "receiver.noise_figure_db"]
    if isinstance(law, Snr) and snr + gain <= LEAST_CELL_SNR_DB:  # whatever wall and beam take
        large, last_keys = {}, ["snr_db"]
    elif isinstance(law, Snr):
        last_keys = ["snr_db", "snr_reference: received"]
        noise += " in free space"
    causes = [f"{obstacle} takes {loss:.0f} dB of the echo" for obstacle, loss in large.items()]
    both_ways = f"{' and '.join(causes)}, both ways: " if causes else ""
    by_obstacle = _BOARD_KEYS if isinstance(config.radar, ArrayRadar) else _KEYS
    keys = [*(key for obstacle in large for key in by_obstacle[obstacle]), *last_keys]
    return [
        f"{both_ways}at {noise} maps show noise alone: {best} gains at most {gain:.0f} dB over it "
        f"({', '.join(keys[:-1])}{' or ' if keys[1:] else ''}{keys[-1]})"
    ]


def looks_away(config: Config) -> list[str]:
    """Warn that the beam looks away from where people begin, by the middle of all draws."""
    lost_db = [
        _losses_db(nominal_scene(config, activity))["the beam"]
        for activity in config.chosen_activities
        if not activity.is_nobody
    ]
    if not lost_db or min(lost_db) < AWAY_DB:
        return []
    keys = (_BOARD_KEYS if isinstance(config.radar, ArrayRadar) else _KEYS)["the beam"]
    return [
        f"the beam looks away from people: it takes {min(lost_db):.0f} dB of their echo, both ways "
        f"({' or '.join(keys)})"
    ]


_KEYS = {"the wall": ["wall.loss_tangent", "wall.size_m"], "the beam": ["radar.beam"]}
_BOARD_KEYS = _KEYS | {"the beam": ["radar.yaw_deg", "radar.tilt_deg"]}


def cell_gain_db(scene: Scene, name: str) -> float:
    """Compute the SNR of a cell that holds all of the echo over that of a raw sample, dB.

    Args:
        scene: gives radar and processing.
        name: name of the map. Of a user's own, whose processing is not known, it is the gain of a
            filter matched to the recording.
    """
    config, channels = scene.config, 1
    if isinstance(scene.radar, ArrayRadar):
        board = board_of(scene.radar)
        channels = board.channels
        if name in (*ANGLE_TIME_MAPS, *FRAME_MAPS):
            frame_map = FRAME_MAP_KINDS.get(name)
            sums_speeds = frame_map is not None and not frame_map.shows_doppler
            is_of_angles = sums_speeds or name in ANGLE_TIME_MAPS
            loops = 1.0 if is_of_angles else HANN * board.loops
            return 10 * log10(HANN * board.samples * loops * channels)
    w = waveform_of(scene)
    kind = kind_of(name)
    if kind == RTM:
        over_range = w.peak_to_power if isinstance(w, Impulse) else w.window.gain(w.n_adc)
        window = 1.0
    elif kind is not None:
        over_range = _gate_gain(config, w) if _gated(config) else _sum_gain(w)
        window = HANN * _window_pulses(scene, w)
    else:
        over_range, window = 2.0 * w.n_bins, float(w.n_pulses)
    return 10 * log10(max(over_range, TINY) * window * channels)


def _gated(config: Config) -> bool:
    return config.processing.range_sum == "gated"


def _sum_gain(w: Waveform) -> float:
    """Gain of the coherent sum over the kept bins, of a beat, or pulse, in their middle."""
    if isinstance(w, Impulse):
        return float((_pulse(w).sum(axis=0) ** 2).max()) / w.samples
    d, beat = weights(w), (w.n_bins // 2) / w.n_fft
    g = (d * np.exp(-2j * np.pi * beat * (np.arange(w.n_adc) - w.n0))).sum()
    return float(abs(g) ** 2 / noise_gain(w))


def _gate_gain(config: Config, w: Waveform) -> float:
    """Gain of the sum of the powers of a gate's bins."""
    within = config.processing.gate_m
    wide = within[1] - within[0] if isinstance(within, tuple) else 2 * within
    bins = max(float(wide) / w.range_step, 1.0)
    if isinstance(w, Impulse):
        return w.peak_to_power * float((_pulse(w) ** 2).sum(axis=0).max()) / sqrt(bins)
    # padding makes no more of them
    return w.window.gain(w.n_adc) / sqrt(max(bins * w.n_adc / w.n_fft, 1.0))


def _pulse(w: Impulse) -> Float:
    """Samples [K, offsets] of a pulse of amplitude 1 in the middle of a profile, less its phase."""
    step = 2 * w.range_step / SPEED_OF_LIGHT
    offsets = np.arange(8) / 8
    shape = w.envelope if w.is_iq else w.pulse
    return shape((np.arange(w.samples)[:, None] - w.samples // 2 - offsets) * step)


def _window_pulses(scene: Scene, w: Waveform) -> int:
    """Pulses of a window of the Doppler maps; those of a board end with the frame."""
    if not isinstance(scene.radar, ArrayRadar):
        return scene.config.processing.make_frames(w.duration, w.prf, w.f0).length
    board = board_of(scene.radar, scene.seconds)
    seconds = board.frames * board.period_s
    frames = scene.config.processing.make_frames(seconds, 1 / board.loop_s, board.centre_hz)
    return min(frames.length, board.loops)


def chest_point(person: Person) -> Float:
    """Point at CHEST_M above the place of a person [3, 1, 1], m, for estimates of their echo."""
    return np.array([*person.place, CHEST_M])[:, None, None]


def _losses_db(scene: Scene) -> dict[str, float]:
    """Compute the losses of a scene's echo in the wall and by the beam, both ways, dB."""
    antennas, person = antennas_of(scene), scene.people[0]
    p = chest_point(person)
    left = antennas.field(p)
    pattern = 1.0 if left is None else float(left.max())
    return {"the wall": _wall_loss_db(scene), "the beam": -20 * log10(max(pattern, TINY))}


def _thermal_snr_db(scene: Scene) -> float:
    """SNR of a raw sample of 1 m^2 where people begin, in free space and thermal noise, dB."""
    antennas, person, w = antennas_of(scene), scene.people[0], waveform_of(scene)
    p = chest_point(person)
    legs = leg(p, antennas.tx), leg(p, antennas.rx)
    r_tx, r_rx = (np.maximum(r, MIN_DISTANCE_M) for r in legs)
    echo = amplitude(r_tx, r_rx, np.ones((1, 1)), antennas.gain, w.wavelength)
    sigma = noise_law_of(scene.config).sigma(0.0, w.sample_rate)
    return 20 * log10(float(echo[0, 0]) / sigma)


def _wall_loss_db(scene: Scene) -> float:
    """Compute the loss of an echo from behind the middle of the wall, both ways, dB."""
    wall, antennas = wall_of(scene), antennas_of(scene)
    if wall is None:
        return 0.0
    behind = np.array(wall.center)[:, None, None] + [[[wall.size[0]]], [[0.0]], [[0.0]]]
    fc = waveform_of(scene).fc
    ways = [transmission(behind, one, wall, fc) for one in (antennas.tx, antennas.rx)]
    left = float(np.prod([way.factor[0, 0] for way in ways]))
    return -20 * log10(max(left, TINY))
