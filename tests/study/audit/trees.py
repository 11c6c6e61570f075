"""Trees of images and tables with leaks that somebody planted."""

import numpy as np
from PIL import Image

SIDE = 48


def body(rng, size=SIDE, floor=40.0):
    """Noise, and a bump of any height, length and place in the middle rows."""
    levels = rng.normal(floor, 12, (size, size))
    start, length, tall = rng.integers(0, size - 12), rng.integers(6, 12), rng.integers(2, 8)
    middle = size // 2
    levels[middle - tall : middle + tall, start : start + length] += 150
    return levels


def save(levels, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.clip(levels, 0, 255).astype(np.uint8)).save(path)


def tree(root, draw, classes=("walking", "falling"), count=30, seed=0, name="{number:03d}"):
    """A tree of images; draw(rng, number of the class) makes one."""
    rng = np.random.default_rng(seed)
    for label, class_name in enumerate(classes):
        for number in range(count):
            file = name.format(number=number, label=label) + ".png"
            save(draw(rng, label), root / class_name / file)
    return root


def clean(rng, label):
    return body(rng)
