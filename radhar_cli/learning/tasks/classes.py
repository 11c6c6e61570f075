"""Activity of the main person: one class an input (`target: classes`)."""

from radhar_cli.learning.tasks.categories import Classifier


class Classes(Classifier):
    """The class of the main person, as the data set labels it."""
