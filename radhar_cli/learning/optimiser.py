"""The learning rate of every step, and the optimiser that takes it."""

from math import cos, pi
from typing import Any

import torch
from torch import nn

from radhar_cli.learning.settings import TrainConfig

_ADAM = {"step", "exp_avg", "exp_avg_sq"}


def learning_rate_of_step(config: TrainConfig, epoch: int, step: int, steps: int) -> float:
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


def optimiser_for(config: TrainConfig, model: nn.Module) -> torch.optim.Optimizer:
    """The config's optimiser; biases, norm layers and what timm exempts have no weight decay."""
    exempt: set[str] = getattr(model, "no_weight_decay", set)()
    weights: list[nn.Parameter] = []
    others: list[nn.Parameter] = []
    for name, parameter in model.named_parameters():
        (others if parameter.ndim <= 1 or name in exempt else weights).append(parameter)
    groups: list[dict[str, Any]] = [
        {"params": weights, "weight_decay": config.weight_decay},
        {"params": others, "weight_decay": 0.0},
    ]
    groups = [group for group in groups if group["params"]]
    if config.optimiser == "adam":
        return torch.optim.Adam(groups, lr=config.learning_rate)
    if config.optimiser == "adamw":
        return torch.optim.AdamW(groups, lr=config.learning_rate)
    return torch.optim.SGD(groups, lr=config.learning_rate, momentum=0.9)


def check_state(optimiser: torch.optim.Optimizer, stored: dict[str, Any]) -> None:
    """Check the stored state of an optimiser before it is used.

    Raises:
        ValueError: other settings, or numbers that do not belong to the weights.
        KeyError, TypeError, AttributeError: it is not the state of an optimiser.
    """
    settings, here = (
        [{k: v for k, v in group.items() if k != "lr"} for group in groups]
        for groups in (stored["param_groups"], optimiser.state_dict()["param_groups"])
    )
    if settings != here:
        raise ValueError("its optimiser has other settings")
    names = {"momentum_buffer"} if isinstance(optimiser, torch.optim.SGD) else _ADAM
    parameters = [p for group in optimiser.param_groups for p in group["params"]]
    for number, parameter in enumerate(parameters):
        state = stored["state"][number]
        for name in names:
            shape = torch.Size() if name == "step" else parameter.shape
            if state.keys() != names or state[name].shape != shape:
                raise ValueError(f"the optimiser's {name} of weight {number} does not fit it")
