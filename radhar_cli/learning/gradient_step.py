"""One step of training: learning rate, logits, loss, gradient, update."""

from dataclasses import dataclass
from math import cos, pi
from typing import Any

import torch
from torch import Tensor, nn

from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.machine import ExecutionPlan, autocast
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.targets import class_loss, labels_loss, skeleton_loss

_ADAM = {"step", "exp_avg", "exp_avg_sq"}


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


@dataclass(frozen=True)
class TrainStep:
    """Forward pass, loss, gradient and update of a training step."""

    config: TrainConfig
    prepare: Normalisation
    plan: ExecutionPlan

    def loss_and_correct(
        self, network: nn.Module, levels: Tensor, labels: Tensor
    ) -> tuple[Tensor, float]:
        """Sums over a batch of the loss, and of what is right: classes, or shares of the joints."""
        device = self.plan.device
        wanted, x = labels.to(device), self.prepare(levels.to(device, non_blocking=True))
        with autocast(device, self.plan.precision):
            outputs: Tensor = network(x)
        if self.config.target == "skeleton":
            return skeleton_loss(outputs.float(), wanted)
        if self.config.target == "labels":
            return labels_loss(outputs.float(), wanted)
        return class_loss(outputs.float(), wanted, self.config.label_smoothing)

    def step(
        self, network: nn.Module, optimiser: torch.optim.Optimizer, levels: Tensor, labels: Tensor
    ) -> tuple[float, float]:
        """One update from a batch [B, C, H, W].

        Returns:
            The mean loss of the batch, and how much of it is right.
        """
        optimiser.zero_grad(set_to_none=True)
        loss_sum, correct = self.loss_and_correct(network, levels, labels)
        loss = loss_sum / len(labels)
        torch.autograd.backward(loss)
        if self.config.gradient_clip_norm is not None:
            nn.utils.clip_grad_norm_(network.parameters(), self.config.gradient_clip_norm)
        optimiser.step()
        return float(loss.detach()), correct
