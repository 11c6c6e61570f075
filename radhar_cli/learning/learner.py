"""A network that learns a task: a training step, validation, averaged weights."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, update_bn

from radhar_cli.learning import machine
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.optimiser import check_state, optimiser_for
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.task import Task
from radhar_cli.numerics.arrays import Float


@dataclass
class Totals:
    """Sums of loss and score over the inputs of an epoch so far."""

    loss_sum: float = 0.0
    score_sum: float = 0.0
    count: int = 0

    def add(self, loss_sum: float, score_sum: float, count: int) -> None:
        """Add a batch of `count` inputs."""
        self.loss_sum += loss_sum
        self.score_sum += score_sum
        self.count += count

    @property
    def loss(self) -> float:
        """Mean loss of an input."""
        return self.loss_sum / self.count

    @property
    def score(self) -> float:
        """Mean score of an input."""
        return self.score_sum / self.count


class Learner:
    """A network on its device, the task that it learns, and its optimiser.

    Attributes:
        model: network that is trained.
        average: running average of its weights; None where none is asked for.
        optimiser: takes the steps.
    """

    def __init__(
        self,
        model: nn.Module,
        task: Task,
        normalise: Normalisation,
        device: torch.device,
        precision: torch.dtype,
    ) -> None:
        """Move a network to its device and make its optimiser.

        Args:
            model: network with its initial weights.
            task: task that it learns, with the settings of the training.
            normalise: normalisation from stored levels to inputs.
            precision: of the passes.
        """
        self.task, self.normalise = task, normalise
        self.device, self.precision = device, precision
        self.model = model.to(device)
        self.average = AveragedModel(model) if self.config.average_last else None
        self.optimiser = optimiser_for(self.config, model)

    @property
    def config(self) -> TrainConfig:
        """Settings of the training."""
        return self.task.settings

    def train_step(self, levels: Tensor, targets: Tensor) -> tuple[float, float]:
        """Update the network by a batch of B inputs.

        Args:
            levels: uint8 [B, C, H, W] as they are stored, or clouds float32 [B, 6, T, points].
            targets: targets [B, ...].

        Returns:
            Mean loss, and sum of the scores.
        """
        self.optimiser.zero_grad(set_to_none=True)
        loss, score = self.measure(self.model, levels, targets)  # [B], [B]
        mean_loss = loss.sum() / len(loss)
        torch.autograd.backward(mean_loss)
        if self.config.gradient_clip_norm is not None:
            nn.utils.clip_grad_norm_(self.model.parameters(), self.config.gradient_clip_norm)
        self.optimiser.step()
        return float(mean_loss.detach()), float(score.sum())

    def measure(self, network: nn.Module, levels: Tensor, targets: Tensor) -> tuple[Tensor, Tensor]:
        """Loss [B] and score [B] of a network for a batch, as of `train_step`."""
        inputs = self.normalise(levels.to(self.device, non_blocking=True))  # float32 [B, C, H, W]
        with machine.autocast(self.device, self.precision):
            outputs = network(inputs)  # logits [B, classes], or joints [B, T, joint, 3]
        outputs, targets = outputs.float(), targets.to(self.device)
        return self.task.loss(outputs, targets), self.task.score(outputs.detach(), targets)

    def set_learning_rate(self, rate: float) -> None:
        """Set the learning rate of the next step."""
        for parameters in self.optimiser.param_groups:
            parameters["lr"] = rate

    def update_average(self, share_done: float) -> None:
        """Take a step into the average, where it is of the last ones.

        Args:
            share_done: share of the steps of the training that are done, 0 to 1.
        """
        if self.average is not None and share_done > 1 - self.config.average_last:
            self.average.update_parameters(self.model)

    @property
    def kept_network(self) -> nn.Module:
        """Network that is validated and kept: the average, as soon as there is one."""
        if self.average is None or not self.average.n_averaged:
            return self.model
        return self.average.module

    def update_average_statistics(self, batches: Iterable[tuple[Tensor, Tensor]]) -> None:
        """Take the batch-norm statistics of averaged weights from images as they are stored.

        Those met in training are of other weights, and of augmented images.
        """
        normalise, device = self.normalise, self.device
        update_bn((normalise(levels.to(device)) for levels, _ in batches), self.kept_network)

    def scores(self, network: nn.Module, batches: Iterable[tuple[Tensor, Tensor]]) -> Float:
        """Score [N] of a network, in evaluation mode, for each input of (levels, targets)."""
        network = network.to(self.device)
        with torch.no_grad():
            scores = [self.measure(network, *batch)[1].cpu().numpy() for batch in batches]
        return np.concatenate(scores).astype(float)

    def validate(self, batches: Iterable[tuple[Tensor, Tensor]]) -> Totals:
        """Loss and score of the kept network for (levels, targets) in batches."""
        network, totals = self.kept_network, Totals()
        network.eval()
        with torch.no_grad():
            for levels, targets in batches:
                loss, score = self.measure(network, levels, targets)
                totals.add(float(loss.sum()), float(score.sum()), len(targets))
        return totals

    def state(self) -> dict[str, Any]:
        """Weights, average and optimiser, from which training goes on."""
        return {
            "model": self.model.state_dict(),
            "average": None if self.average is None else self.average.state_dict(),
            "optimiser": self.optimiser.state_dict(),
        }

    def restore(self, stored: dict[str, Any]) -> None:
        """Take over the `state` of a file that is not trusted.

        Raises:
            Exception: it does not fit; of whatever kind PyTorch raises.
        """
        self.model.load_state_dict(stored["model"])
        check_state(self.optimiser, stored["optimiser"])
        self.optimiser.load_state_dict(stored["optimiser"])
        if self.average is not None:
            self.average.load_state_dict(stored["average"])
