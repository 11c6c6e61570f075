"""Figure of `radhar fit`: the noise floor over range, and SNRs."""

from pathlib import Path

from radhar_cli.capture.fitting import Fit
from radhar_cli.figures.page import page, write_figure


def draw(fit: Fit, path: Path) -> None:
    """Write the figure."""
    figure = page(10.0, 3.5)
    floor, snrs = figure.subplots(1, 2)
    floor.plot(fit.waveform.range_axis(), fit.floor_db, label="measured")
    floor.axhline(0, color="k", linestyle="--", linewidth=0.8, label="fitted: the same everywhere")
    floor.set(xlabel="range (m)", ylabel="noise floor (dB over its median)")
    floor.legend()
    snr = fit.snr_db
    snrs.hist(snr, bins=min(20, max(3, snr.size // 2)), label="measured")
    snrs.axvline(snr.mean(), color="k", linestyle="--", label="mean")
    snrs.set(xlabel="SNR of a raw sample (dB)", ylabel="parts")
    snrs.legend()
    write_figure(figure, path, 90)
