"""Every picture of the documentation is recorded with the commit that it was drawn at."""

import draw_pictures as script
import pytest
from matplotlib.figure import Figure
from PIL import Image


def _need_history() -> None:
    is_clone = (script.ROOT / ".git").exists()
    if not is_clone or script.git("rev-parse", "--is-shallow-repository") == "true":
        pytest.skip("the history is not here")


def test_every_picture_is_recorded_as_it_is() -> None:
    drawn = {str(p.relative_to(script.PICTURES)): script.digest(p) for p in script.all_pictures()}
    recorded = {name: entry["sha256"] for name, entry in script.read_record().items()}
    assert drawn == recorded, "python scripts/draw_pictures.py PICTURE --by COMMAND"


def test_every_picture_has_its_commit_and_its_maker() -> None:
    entries = script.read_record()
    assert all(entry["by"] for entry in entries.values())
    _need_history()
    for commit in {entry["commit"] for entry in entries.values()}:
        assert script.git("cat-file", "-t", commit) == "commit", commit


def test_a_saved_picture_keeps_all_its_colours(tmp_path) -> None:
    figure = Figure(figsize=(6, 1))
    figure.add_axes((0, 0, 1, 1)).imshow([[*range(256)]], aspect="auto")
    script.save_picture(figure, tmp_path / "bar.png", 100)
    with Image.open(tmp_path / "bar.png") as picture:
        assert picture.mode == "RGB"
        assert len(picture.getcolors(10_000)) > 200
    assert "bar.png" not in script.read_record()


def test_pictures_are_listed_with_their_dates(capsys: pytest.CaptureFixture[str]) -> None:
    _need_history()
    script.main([])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(script.all_pictures())
    assert lines == sorted(lines)
