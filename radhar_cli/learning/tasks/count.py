"""Number of people: one class an input (`target: count`)."""

from dataclasses import replace

import numpy as np

from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.tasks.categories import Classifier
from radhar_cli.motion.movements.standing import NOBODY


class Count(Classifier):
    """The number of people in a scene; the classes are "0 people", "1 person" and so on."""

    def relabel(self, images: ImageSet) -> ImageSet:
        """Images whose classes are the numbers of people that occur."""
        counts = np.array([len(names) - names.count(NOBODY) for names in images.activities])
        occurring, label = np.unique(counts, return_inverse=True)
        classes = tuple(f"{n} {'person' if n == 1 else 'people'}" for n in occurring)
        samples = replace(images.samples, label=label, activities=None)
        return replace(images, classes=classes, samples=samples)
