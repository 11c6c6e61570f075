"""The path of somebody whose poses are relative to the hips, as told by the foot on the floor."""

import numpy as np

from radhar_cli.numerics.arrays import Float

LOW = 0.008  # statures; how much lower than the other an ankle is that stands alone, to begin with
HIGH = 0.05  # statures; the same in what follows, for the heel of a foot on the floor rises
AGREEING = 0.25  # statures per second; how well a foot agrees that is on the floor
AVERAGED = 0.6  # s, of a step
ROUNDS = 3


def travel_by_feet(ankles: Float, rate: float) -> Float:
    """Shifts that keep the foot on the floor where it is: a walker has one there.

    A foot k at rest tells the velocity of the hips, -dr_k/dt of its ankle r_k about them. Its
    height tells first which foot that is; then both are weighted by how well they agree with the
    average velocity over a step, w_k ~ exp(-|v_k - v|^2 / 2 AGREEING^2 - z_k / HIGH), in a few
    rounds. A runner or jumper has no foot on the floor at times, and a person who lies or sits
    stands on neither.

    Args:
        ankles: Positions [frames, 2, 3] of both ankles about the hips, over the stature; z is up.
        rate: Frames per second.

    Returns:
        Shifts [frames, 3] to add to all joints; the lower ankle is at z = 0 then.
    """
    heights = ankles[..., 2]
    above = heights - heights.min(axis=1, keepdims=True)
    by_foot = -np.gradient(ankles[..., :2], 1 / rate, axis=0)
    low = _share(np.exp(-above / LOW))
    weights = low
    for _ in range(ROUNDS):
        average = _moving_average(_mean_of_feet(weights, by_foot), max(1, round(AVERAGED * rate)))
        far = ((by_foot - average[:, None]) ** 2).sum(axis=2)
        far -= far.min(axis=1, keepdims=True)
        weights = _share(np.exp(-far / (2 * AGREEING**2) - above / HIGH))
    velocity = _mean_of_feet(weights, by_foot)
    shifts = np.zeros((len(ankles), 3))
    shifts[1:, :2] = np.cumsum((velocity[1:] + velocity[:-1]) / (2 * rate), axis=0)
    shifts[:, 2] = -(low * heights).sum(axis=1)
    return shifts


def _share(weights: Float) -> Float:
    """Weights [frames, 2] of both feet that make 1."""
    shares: Float = weights / weights.sum(axis=1, keepdims=True)
    return shares


def _mean_of_feet(weights: Float, values: Float) -> Float:
    """Weighted mean [frames, 2] of the values [frames, 2, 2] of both feet."""
    mean: Float = np.einsum("fk,fka->fa", weights, values)
    return mean


def _moving_average(values: Float, frames: int) -> Float:
    """Average [frames, 2] over a window of frames around each."""
    from scipy.ndimage import uniform_filter1d

    average: Float = uniform_filter1d(values, frames, axis=0, mode="nearest")
    return average
