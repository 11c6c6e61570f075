"""Magnitudes of the global filters of a trained network, by spatial frequency."""

from typing import Any

import numpy as np
import torch
from torch import nn

from radhar_cli.learning.models.fftnet import GlobalFilter
from radhar_cli.numerics.arrays import Float


def filter_magnitudes(model: nn.Module) -> list[Float]:
    """Magnitudes |H| [H, W] of every global filter, first to last; mean over channels, FFT order.

    H is the Hermitian part of the stored weight, the only part that acts.
    """
    filters = []
    with torch.no_grad():
        for layer in model.modules():
            if isinstance(layer, GlobalFilter):
                half = layer.hermitian_half().abs().mean(0).double().cpu().numpy()
                width = layer.weight.shape[2]
                mirrored = np.roll(half[::-1, 1 : width - half.shape[1] + 1][:, ::-1], 1, axis=0)
                filters.append(np.concatenate([half, mirrored], axis=1))
    return filters


def filter_table(filters: list[Float]) -> list[dict[str, Any]]:
    """Rows of numbers, one for each filter: size, mean weight, share at low frequencies.

    `low_gain` is the mean squared weight at frequencies below 1/8 of the sampling rate on both
    axes, over the mean of the whole plane: 1 for a filter without a preference. `concentration` is
    1 minus the normalised entropy of the squared weight: 0 for a flat filter, 1 for one line.
    """
    rows = []
    for number, magnitude in enumerate(filters, start=1):
        power = magnitude**2 / (magnitude**2).sum()
        height, width = magnitude.shape
        vertical = np.abs(np.fft.fftfreq(height)) < 0.125
        horizontal = np.abs(np.fft.fftfreq(width)) < 0.125
        positive = power[power > 0]
        entropy = float(-(positive * np.log(positive)).sum())
        rows.append(
            {
                "filter": number,
                "height": height,
                "width": width,
                "mean": float(magnitude.mean()),
                "largest": float(magnitude.max()),
                "low_gain": float(power[np.ix_(vertical, horizontal)].mean() / power.mean()),
                "concentration": float(1 - entropy / np.log(power.size)) if power.size > 1 else 0.0,
            }
        )
    return rows
