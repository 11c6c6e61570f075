"""`radhar train --tensorboard`: the event file has the rows of history.csv."""

import pytest
from learning.patterns import Watched, settings
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from radhar_cli.learning.run_folder import read_history
from radhar_cli.learning.training import TrainOptions, train


def curves(run):
    (path,) = (run / "tensorboard").iterdir()
    events = EventAccumulator(str(path))
    events.Reload()
    return events, {
        name: {event.step: event.value for event in events.Scalars(name)}
        for name in events.Tags()["scalars"]
    }


@pytest.mark.parametrize("interrupted", [False, True])
def test_the_curves_are_those_of_the_history_each_epoch_once(data, tmp_path, interrupted):
    run, config = tmp_path / "run", settings(epochs=3)
    if interrupted:
        with pytest.raises(KeyboardInterrupt):
            train(config, data, run, Watched(stop_after=2), TrainOptions(tensorboard=True))
    train(config, data, run, Watched(), TrainOptions(tensorboard=True))
    events, found = curves(run)
    history = read_history(run)
    for name, column in (
        ("loss/training", "train_loss"),
        ("loss/validation", "val_loss"),
        ("accuracy/training", "train_accuracy"),
        ("accuracy/validation", "val_accuracy"),
        ("learning rate", "learning_rate"),
    ):
        assert list(found[name]) == [1, 2, 3]
        for row in history:
            assert found[name][row.epoch] == pytest.approx(getattr(row, column), rel=1e-6)
    (text,) = events.Tensors("settings/text_summary")
    assert b'"learning_rate": 0.001' in text.tensor_proto.string_val[0]


def test_overwriting_a_run_removes_its_curves_and_nothing_else(data, tmp_path):
    run = tmp_path / "run"
    train(settings(epochs=1), data, run, Watched(), TrainOptions(tensorboard=True))
    (run / "tensorboard/mine.txt").write_text("notes")
    train(settings(epochs=1, seed=2), data, run, Watched(), TrainOptions(overwrite=True))
    assert [path.name for path in (run / "tensorboard").iterdir()] == ["mine.txt"]
