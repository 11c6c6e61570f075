"""A reliability diagram: how often predictions of each confidence are right."""

from radhar_cli.arrays import Float
from radhar_cli.figures.page import page, png_bytes


def reliability_png(confidence: Float, accuracy: Float, count: Float, title: str) -> bytes:
    """Draw accuracy against mean confidence, both [bins]; `count` [bins] is the size of a dot."""
    figure = page(4.8, 4.6)
    axes = figure.subplots()
    used = count > 0
    axes.plot([0, 1], [0, 1], ":", color="gray", linewidth=1)
    axes.scatter(
        confidence[used], accuracy[used], s=20 + 180 * count[used] / count.sum(), alpha=0.7
    )
    axes.set_xlabel("mean probability of the predicted class")
    axes.set_ylabel("share that is right")
    axes.set_xlim(0, 1.02)
    axes.set_ylim(-0.02, 1.05)
    axes.grid(alpha=0.3)
    axes.set_title(title, fontsize=8)
    return png_bytes(figure)
