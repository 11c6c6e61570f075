"""Who is told how far a build or a sweep is, in tests."""


class Listener:
    """A progress that remembers what was said."""

    def __init__(self) -> None:
        self.said: list[str] = []
        self.stages: list[str] = []

    def stage(self, name: str, total: int, done: int) -> None:
        self.stages.append(name)

    def advance(self, samples: int) -> None:
        pass

    def say(self, message: str) -> None:
        self.said.append(message)
