"""What a network learns of an input: classes, or the joints of the person in every frame."""

from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits, cross_entropy

from radhar_cli.learning.settings import Target

NEAR_M = 0.15  # joints found within it count as found
SCORES = {
    "classes": "accuracy",
    "count": "accuracy",
    "labels": "all labels right",
    "skeleton": "joints within 15 cm",
}
LOSSES = {
    "classes": "label-smoothed cross-entropy",
    "count": "label-smoothed cross-entropy",
    "labels": "binary cross-entropy",
    "skeleton": "mean absolute error, m",
}


def loss_and_score(
    target: Target, outputs: Tensor, wanted: Tensor, smoothing: float
) -> tuple[Tensor, float]:
    """Sums over a batch of the loss of a target, and of what is right.

    That of classes is the label-smoothed cross-entropy: the target of class k is
    y_k (1 - zeta) + zeta/K (paper, equation of label smoothing).
    """
    match target:
        case "skeleton":
            return skeleton_loss(outputs, wanted)
        case "labels":
            return labels_loss(outputs, wanted)
    loss = cross_entropy(outputs, wanted, label_smoothing=smoothing, reduction="sum")
    return loss, int((outputs.argmax(1) == wanted).sum())


def labels_loss(logits: Tensor, shown: Tensor) -> tuple[Tensor, float]:
    """Sum over a batch of the mean binary cross-entropy, and of inputs with all labels right.

    Args:
        logits: [B, classes].
        shown: as that, 1 for what anybody does, else 0.
    """
    wanted = shown.to(logits.dtype)
    loss = binary_cross_entropy_with_logits(logits, wanted, reduction="none").mean(1)
    return loss.sum(), int(((logits > 0) == (shown > 0)).all(1).sum())


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
