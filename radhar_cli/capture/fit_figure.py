"""Figure of `radhar fit`: noise over range and Doppler, what stands there, and SNRs."""

from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.capture.fitting import FEW, Fit
from radhar_cli.figures.page import page, write_figure


def draw(fit: Fit, path: Path) -> None:
    """Write the figure, measured values beside fitted ones."""
    figure = page(10.0, 7.0)
    (floor, doppler), (room, snrs) = figure.subplots(2, 2)
    ranges = fit.waveform.range_axis()
    floor.plot(ranges, fit.floor_db, label="measured")
    floor.axhline(0, color="k", linestyle="--", linewidth=0.8, label="fitted: the same everywhere")
    floor.set(xlabel="range (m)", ylabel="noise floor (dB over its median)")
    floor.legend()
    _draw_spectrum(fit, doppler)
    room.plot(ranges, 10 * np.log10(np.maximum(fit.room.power, 1e-30)), label="measured")
    room.plot(
        [one.range for one in fit.reflectors],
        [10 * np.log10(one.power) for one in fit.reflectors],
        "kx",
        label=f"fitted: {len(fit.reflectors)} reflectors",
    )
    room.set(xlabel="range (m)", ylabel="what stands still (dB over the noise\nof a raw sample)")
    room.legend()
    snr = fit.snr_db
    snrs.hist(snr, bins=min(20, max(3, snr.size // 2)), density=True, label="measured")
    if snr.size >= FEW and snr.std() > 0:
        at = np.linspace(snr.min() - 3, snr.max() + 3, 200)
        bell = np.exp(-(((at - snr.mean()) / snr.std()) ** 2) / 2)
        snrs.plot(at, bell / (snr.std() * np.sqrt(2 * np.pi)), "k--", label="fitted: normal")
    else:
        snrs.axvline(snr.mean(), color="k", linestyle="--", label="fitted: constant")
    snrs.set(xlabel="SNR of a raw sample (dB)", ylabel="density")
    snrs.legend()
    write_figure(figure, path, 90)


def _draw_spectrum(fit: Fit, axes: Any) -> None:
    spectrum, both = fit.spectrum, fit.spectrum.over_all_ranges()
    axes.set(xlabel="Doppler (Hz)", ylabel="noise where nobody is\n(dB over the white noise)")
    if both is None:
        axes.set_title("no range bin without a person", fontsize=9)
        return
    f = np.fft.fftshift(spectrum.frequency)
    kept = np.abs(f) > 1.5 * spectrum.prf / spectrum.length
    model = fit.colour(np.where(kept, f, spectrum.prf))
    gain = np.sum(spectrum.window) ** 2 / np.sum(spectrum.window**2)
    for line in fit.lines:
        model[int(np.argmin(np.abs(f - line.doppler)))] += line.level * line.share * gain
    for power, style, label in (
        (np.fft.fftshift(both[0]), "C0-", "measured"),
        (model, "k--", "fitted"),
    ):
        axes.plot(f[kept], 10 * np.log10(power[kept]), style, linewidth=0.8, label=label)
    axes.legend()
