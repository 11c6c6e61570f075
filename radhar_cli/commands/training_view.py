"""What `train` prints while it works and when it is done."""

from dataclasses import asdict

from radhar_cli.commands.bars import Bars
from radhar_cli.commands.tell import report, tell
from radhar_cli.learning import run_files as run
from radhar_cli.learning.run_folder import Epoch
from radhar_cli.learning.training import Outcome


class TrainingView(Bars):
    """A bar per epoch on a terminal; a line per epoch everywhere."""

    def __init__(self) -> None:
        super().__init__()
        self._epochs = 0

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        self._epochs = epochs
        self.open(f"epoch {number}/{epochs}", steps, "step", leave=False)

    def step(self, loss: float, accuracy: float) -> None:
        self.advance(1, f"loss {loss:.3f}, right {100 * accuracy:.1f} %")

    def epoch_done(self, row: Epoch, best: bool) -> None:
        self.close()
        self.say(
            f"epoch {row.epoch}/{self._epochs}  training {100 * row.train_accuracy:6.2f} % loss "
            f"{row.train_loss:.4f}  validation {100 * row.val_accuracy:6.2f} % loss "
            f"{row.val_loss:.4f}  rate {row.learning_rate:.2e}  {row.seconds:.0f} s"
            + ("  best so far" if best else "")
        )

    def print_outcome(self, outcome: Outcome) -> None:
        """Print the results and their files."""
        folder, best = outcome.folder, outcome.best
        report(
            folder=folder,
            epochs=len(outcome.history),
            resumed=outcome.resumed,
            best=asdict(best),
            weights=folder / run.BEST,
        )
        if outcome.resumed == len(outcome.history):
            tell(f"{folder} is complete: {outcome.resumed} epochs; nothing to do")
        tell(f"best epoch {best.epoch}: validation {outcome.score} {100 * best.val_accuracy:.2f} %")
        tell(f"  weights   {folder / run.BEST}")
        tell(f"  curves    {folder / run.CURVES}")
        tell(f"  summary   {folder / run.SUMMARY}")
        tell(f"  evaluate  radhar eval {folder} DATA")
