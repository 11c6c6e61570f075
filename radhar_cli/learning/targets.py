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
    target: Target, outputs: Tensor, labels: Tensor, smoothing: float
) -> tuple[Tensor, float]:
    """Sums over a batch of the loss of a target, and of its score.

    The loss of classes is the label-smoothed cross-entropy: the target of class k is
    y_k (1 - zeta) + zeta/K (paper, equation of label smoothing); their score is 1 for the right
    class. Those of the others: `labels_loss`, `skeleton_loss`.

    Args:
        target: what is learned.
        outputs: [B, classes], or [B, T, joint, 3] in m.
        labels: [B] class numbers, or targets of the shape of the outputs.
        smoothing: zeta.
    """
    match target:
        case "skeleton":
            return skeleton_loss(outputs, labels)
        case "labels":
            return labels_loss(outputs, labels)
    loss = cross_entropy(outputs, labels, label_smoothing=smoothing, reduction="sum")
    return loss, int((outputs.argmax(1) == labels).sum())


def labels_loss(logits: Tensor, labels: Tensor) -> tuple[Tensor, float]:
    """Sum over a batch of the mean binary cross-entropy, and of inputs with all labels right.

    Args:
        logits: [B, classes].
        labels: [B, classes], 1 for what anybody does, else 0.
    """
    targets = labels.to(logits.dtype)
    loss = binary_cross_entropy_with_logits(logits, targets, reduction="none").mean(1)
    return loss.sum(), int(((logits > 0) == (labels > 0)).all(1).sum())


def skeleton_loss(predicted: Tensor, joints: Tensor) -> tuple[Tensor, float]:
    """Sum over a batch of the mean absolute error (m), and of the share of joints within 15 cm.

    Args:
        predicted: [B, T, joint, 3] joints, m.
        joints: [B, T, joint, 3] true joints, m; frames of NaN are left out.
    """
    is_known = joints.isfinite()
    deviation = (predicted - joints.nan_to_num()) * is_known
    loss = deviation.abs().sum((1, 2, 3)) / is_known.sum((1, 2, 3)).clamp_min(1)
    known_joints = is_known.all(3)
    is_near = (deviation.detach().norm(dim=3) < NEAR_M) & known_joints
    return loss.sum(), float((is_near.sum((1, 2)) / known_joints.sum((1, 2)).clamp_min(1)).sum())
