"""Progress of a build or a sweep, recorded for tests."""


class Listener:
    """A `Progress` that keeps messages and names of stages."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.stages: list[str] = []

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        self.stages.append(name)

    def advance(self, samples: int) -> None:
        pass

    def say(self, message: str) -> None:
        self.messages.append(message)
