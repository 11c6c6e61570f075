"""The learning rate at every step."""

from math import cos, pi

from radhar_cli.learning.settings import TrainConfig


def rate(config: TrainConfig, epoch: int, step: int, steps: int) -> float:
    """Learning rate of a step (from 0) of an epoch (from 0) that has `steps` of them.

    A linear rise over the first `warmup_epochs` that reaches the initial rate with their last
    step, then the schedule.
    """
    initial, schedule = config.learning_rate, config.schedule
    risen = epoch + (step + 1) / steps
    if risen < config.warmup_epochs:
        return initial * min(1.0, risen / config.warmup_epochs)
    if schedule.kind == "step":
        return initial * float(schedule.factor ** (epoch // schedule.every_epochs))
    if schedule.kind == "cosine":
        since = max(0.0, epoch + step / steps - config.warmup_epochs)
        return initial * (1 + cos(pi * since / max(config.epochs - config.warmup_epochs, 1e-9))) / 2
    return initial
