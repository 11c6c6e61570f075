"""What a network learns of an input: its class, or the joints of the person in every frame."""

from torch import Tensor
from torch.nn.functional import cross_entropy

NEAR_M = 0.15  # joints found within it count as found
SCORES = {"classes": "accuracy", "skeleton": "joints within 15 cm"}
LOSSES = {"classes": "label-smoothed cross-entropy", "skeleton": "mean absolute error, m"}


def class_loss(logits: Tensor, label: Tensor, smoothing: float) -> tuple[Tensor, float]:
    """Sum of the label-smoothed cross-entropy over a batch, and number of right classes.

    The target of class k is y_k (1 - zeta) + zeta/K (paper, equation of label smoothing).
    """
    loss = cross_entropy(logits, label, label_smoothing=smoothing, reduction="sum")
    return loss, int((logits.argmax(1) == label).sum())


def skeleton_loss(found: Tensor, joints: Tensor) -> tuple[Tensor, float]:
    """Sum over a batch of the mean absolute error (m), and of the share of joints within 15 cm.

    Args:
        found: [B, T, joint, 3].
        joints: as that; frames of NaN are left out.
    """
    known = joints.isfinite()
    off = (found - joints.nan_to_num()) * known
    loss = off.abs().sum((1, 2, 3)) / known.sum((1, 2, 3)).clamp_min(1)
    seen = known.all(3)
    near = (off.detach().norm(dim=3) < NEAR_M) & seen
    return loss.sum(), float((near.sum((1, 2)) / seen.sum((1, 2)).clamp_min(1)).sum())
