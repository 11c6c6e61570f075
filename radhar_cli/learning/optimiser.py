"""The learning rate of every step, and the optimiser that takes it."""

from math import cos, pi
from typing import Any

import torch
from torch import nn

from radhar_cli.learning.settings import TrainConfig

_ADAM = {"step", "exp_avg", "exp_avg_sq"}


def learning_rate_of_step(config: TrainConfig, epoch: int, step: int, steps: int) -> float:
    """Learning rate of one step: a linear rise, then the schedule.

    The rise over the first `warmup_epochs` reaches the initial rate with their last step.

    Args:
        config: learning rate, warm-up and schedule.
        epoch: number of the epoch, from 0.
        step: number of the step in its epoch, from 0.
        steps: steps of the epoch.
    """
    initial, schedule = config.learning_rate, config.schedule
    epochs_done = epoch + (step + 1) / steps
    if epochs_done < config.warmup_epochs:
        return initial * min(1.0, epochs_done / config.warmup_epochs)
    if schedule.kind == "step":
        return initial * float(schedule.factor ** (epoch // schedule.every_epochs))
    if schedule.kind == "cosine":
        epochs_since_warmup = max(0.0, epoch + step / steps - config.warmup_epochs)
        return (
            initial
            * (1 + cos(pi * epochs_since_warmup / max(config.epochs - config.warmup_epochs, 1e-9)))
            / 2
        )
    return initial


def optimiser_for(config: TrainConfig, model: nn.Module) -> torch.optim.Optimizer:
    """Optimiser of a config; biases, norm layers and weights that timm exempts have no decay."""
    exempt: set[str] = getattr(model, "no_weight_decay", set)()
    weights: list[nn.Parameter] = []
    undecayed: list[nn.Parameter] = []
    for name, parameter in model.named_parameters():
        (undecayed if parameter.ndim <= 1 or name in exempt else weights).append(parameter)
    groups: list[dict[str, Any]] = [
        {"params": weights, "weight_decay": config.weight_decay},
        {"params": undecayed, "weight_decay": 0.0},
    ]
    groups = [group for group in groups if group["params"]]
    if config.optimiser == "adam":
        return torch.optim.Adam(groups, lr=config.learning_rate)
    if config.optimiser == "adamw":
        return torch.optim.AdamW(groups, lr=config.learning_rate)
    return torch.optim.SGD(groups, lr=config.learning_rate, momentum=0.9)


def check_state(optimiser: torch.optim.Optimizer, stored: dict[str, Any]) -> None:
    """Check the stored state of an optimiser before it is used.

    Args:
        optimiser: new optimiser of the same network.
        stored: state_dict of an optimiser, from a file that is not trusted.

    Raises:
        ValueError: other settings, or numbers that do not belong to the weights.
        KeyError, TypeError, AttributeError: it is not the state of an optimiser.
    """
    stored_settings, settings = (
        [{k: v for k, v in group.items() if k != "lr"} for group in groups]
        for groups in (stored["param_groups"], optimiser.state_dict()["param_groups"])
    )
    if stored_settings != settings:
        raise ValueError("its optimiser has other settings")
    names = {"momentum_buffer"} if isinstance(optimiser, torch.optim.SGD) else _ADAM
    parameters = [p for group in optimiser.param_groups for p in group["params"]]
    for number, parameter in enumerate(parameters):
        state = stored["state"][number]
        for name in names:
            shape = torch.Size() if name == "step" else parameter.shape
            if state.keys() != names or state[name].shape != shape:
                raise ValueError(f"the optimiser's {name} of weight {number} does not fit it")
