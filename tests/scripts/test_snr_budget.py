"""scripts/snr_budget.py: theory and maps agree where theory is exact."""

from dataclasses import dataclass

import numpy as np
import pytest
import reproduce_paper
import snr_budget
from command_line import ROOT

from radhar_cli import load_config
from radhar_cli.arrays import Float
from radhar_cli.echo.paths import Paths
from radhar_cli.light import SPEED_OF_LIGHT
from radhar_cli.pipeline.run import record
from radhar_cli.processing.frames import Frames
from radhar_cli.scene import Scene, draw_scene

PAGE = ROOT / "docs" / "results.md"
RESULT = ROOT / "docs" / "results" / "snr_budget.json"
SLOW = ("radar.prf_hz=500", "radar.carrier_hz=10e9", "snr_db=0")


@dataclass(frozen=True)
class Tone:
    """One scatterer at a constant radial speed, m/s."""

    speed: float
    breakpoints: tuple[float, ...] = ()
    highest_frequency: float = 1.0
    smooth: bool = True

    def __call__(self, t: Float) -> Paths:
        delay = 2 * (3.0 - self.speed * t) / SPEED_OF_LIGHT
        return Paths(delay[None], np.ones((1, t.size)))


def both(number: int, *more: str, slug: str = "walking") -> tuple[Scene, Scene]:
    config = ROOT / "configs" / "paper" / "free_space.yaml"
    plain, gated = (load_config(config, [*SLOW, *more, *g]) for g in ((), snr_budget.GATE))
    activity = next(one for one in plain.every_class if one.slug == slug)
    return draw_scene(plain, activity, number), draw_scene(gated, activity, number)


def test_a_tone_has_the_snr_of_theory() -> None:
    # Slow, and of coarse range resolution: it stays in its bins while a frame lasts.
    scenes = both(0, "radar.bandwidth_hz=1e9", "processing.gate_m=[1, 5]")
    found = record(scenes[1], ("waveform", "frames", "gate"))
    w, frames, gate = found["waveform"], found["frames"], found["gate"]
    known = snr_budget.gains(w, frames, gate.count)
    assert known.half_band == pytest.approx(3.01, abs=0.01)
    assert known.window == pytest.approx(10 * np.log10(frames.length / 1.5), abs=1e-6)
    doppler = 4 * w.prf / frames.length  # in the middle of a cell
    tone = Tone(doppler * SPEED_OF_LIGHT / (2 * w.f0))
    parts = snr_budget.parts_of(*scenes, paths=tone)
    canceller = 10 * np.log10(2 * np.sin(np.pi * doppler / w.prf) ** 2)
    assert snr_budget.db(parts.canceller) == pytest.approx(canceller, abs=1e-6)
    assert snr_budget.db(parts.echo / parts.noise) == pytest.approx(
        known.half_band + canceller, abs=0.5
    )
    # White noise of the raw samples, after the canceller: sum g^2 (2 sin(pi f/PRF))^2 a cell.
    shape = np.sum(frames.window**2) * (2 * np.sin(np.pi * frequencies(frames))) ** 2
    for gain, most, echo_map, noise_map in (
        (known.half_band, 0.2, parts.echo_map, parts.noise_map),
        (known.gate, 0.5, parts.gated_echo, parts.gated_noise),
    ):
        noise = shape * w.n_adc * (w.n_bins if gain == known.half_band else gate.count)
        assert snr_budget.db(noise_map.mean() / noise.mean()) == pytest.approx(0, abs=0.5)
        peak, _ = snr_budget.cells(echo_map[102:], noise[102:])
        assert peak == pytest.approx(gain + known.window, abs=most)


def frequencies(frames: Frames) -> Float:
    """Frequencies of a map's rows as a share of the PRF."""
    return np.fft.fftshift(np.fft.fftfreq(frames.length))


def test_a_walker_has_the_snr_of_theory_after_the_canceller() -> None:
    found = snr_budget.parts_of(*both(0))
    made = snr_budget.db(found.echo / found.noise)
    assert made == pytest.approx(3.01 + snr_budget.db(found.wall * found.canceller), abs=1.0)


def test_cells_of_a_map() -> None:
    echo = np.array([[100.0, 1.0, 0.0], [50.0, 50.0, 1e-9]])
    peak, median = snr_budget.cells(echo, np.array([10.0, 1.0]))
    assert (peak, median) == pytest.approx((10 * np.log10(50),) * 2)


def test_the_committed_tables_are_those_of_the_record() -> None:
    inside = PAGE.read_text().partition(snr_budget.BEGIN)[2].partition(reproduce_paper.END)[0]
    assert inside.strip() == snr_budget.page_text(snr_budget.read_budget(RESULT)).strip()
