"""The learning rate at every step."""

from math import cos, pi

from radhar_cli.learning.settings import TrainConfig


def rate(config: TrainConfig, epoch: int, done: float) -> float:
    """Learning rate in an epoch (from 0) of which the share `done` lies behind.

    A linear warm-up over the first `warmup_epochs`, then the schedule.
    """
    initial, schedule, now = config.learning_rate, config.schedule, epoch + done
    if now < config.warmup_epochs:
        return initial * max(now, 1e-3) / config.warmup_epochs
    if schedule.kind == "step":
        return initial * float(schedule.factor ** (epoch // schedule.every_epochs))
    if schedule.kind == "cosine":
        span = max(config.epochs - config.warmup_epochs, 1e-9)
        return initial * (1 + cos(pi * (now - config.warmup_epochs) / span)) / 2
    return initial
