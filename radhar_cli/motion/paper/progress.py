"""Raised-cosine progress P, and the distance walked under a raised-cosine speed ramp."""

import numpy as np

from radhar_cli.numerics.arrays import Float


def progress(t: Float, start: float, duration: float) -> Float:
    """Raised-cosine progress P = (1 - cos(pi clip((t - start)/duration, 0, 1)))/2 [...].

    A duration of 0 is a step, on at t >= start (docs/physics/model.md, Activities).

    Args:
        t: Times [...], s.
        start: Beginning of the progress, s.
        duration: Time that it takes, s.
    """
    if duration == 0:
        return (t >= start).astype(float)
    p: Float = 0.5 - 0.5 * np.cos(np.pi * np.clip((t - start) / duration, 0, 1))
    return p


def progress_integral(t: Float, start: float, duration: float) -> Float:
    """Exact integral of P from minus infinity to t [...], s.

    Within the ramp it is duration (s/2 - sin(pi s)/(2 pi)) with s = (t - start)/duration; arguments
    are those of `progress`.
    """
    if duration == 0:
        return np.asarray(np.maximum(t - start, 0))
    s = np.clip((t - start) / duration, 0, 1)
    after = np.maximum(t - (start + duration), 0)
    walked: Float = duration * (0.5 * s - np.sin(np.pi * s) / (2 * np.pi)) + after
    return walked
