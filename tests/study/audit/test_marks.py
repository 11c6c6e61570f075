"""Marks at fixed places of images are found wherever they are, and bodies and noise are none."""

import re

import numpy as np
import pytest
from helpers.listener import Listener
from study.audit.trees import body, tree

from radhar_cli.study.audit.audit import audit
from radhar_cli.study.audit.held_out import Effort, class_share
from radhar_cli.study.audit.marks import mark_evidence, mark_features, marked_places

CLASSES, COUNT, SIDE = 6, 24, 64
FAST = Effort(trees=12, folds=3, permutations=200)
TRUTH = np.repeat(np.arange(CLASSES), COUNT)


def louder(rng, label):
    """An unmarked image, whose level, noise and body go by the class."""
    levels = 25.0 * label + body(rng, SIDE, floor=40) * (0.3 + 0.2 * label)
    return levels + rng.normal(0, 3 * label, levels.shape)


def plain(rng, label):
    return body(rng, SIDE)


def set_corner(levels, label):
    levels[0, 0] = 40 * label


def set_last_corner(levels, label):
    levels[-1, -1] = 255 - 40 * label


def add_outer_rows(levels, label):
    levels[[0, 1, -2, -1]] += 6 * label


def add_last_row(levels, label):
    levels[-1] += 9 * label


def add_first_column(levels, label):
    levels[:, 0] += 9 * label


def set_colour_bar(levels, label):
    levels[:, -3:] = 40 * label


def set_time_stamp(levels, label):
    levels[10:13, 40:43] = 40 * label


def add_column_within(levels, label):
    levels[:, 20] += 12 * label


def set_one_class(levels, label):
    levels[5, 5] = 255 if label == 3 else levels[5, 5]


MARKS = {
    set_corner: "the first rows|rows 0 to",
    set_last_corner: "the last rows|rows 62 to",
    add_outer_rows: "the (first|last) rows",
    add_last_row: "the last rows",
    add_first_column: "the first columns|columns 0 to 1",
    set_colour_bar: "the last columns|columns 60 to|columns 58 to|columns 62 to",
    set_time_stamp: "rows (8|10|12) to",
    add_column_within: "columns 20 to 21",
    set_one_class: "rows 4 to 5, columns 4 to 5",
}


def evidence(draw, mark, seed):
    rng = np.random.default_rng(seed)
    features = []
    for label in TRUTH:
        levels = draw(rng, int(label))
        if mark is not None:
            mark(levels, int(label))
        features.append(mark_features(np.clip(levels, 0, 255).astype(np.uint8)))
    return mark_evidence(features, TRUTH, (SIDE, SIDE))


def share(found, group=None):
    group = np.arange(TRUTH.size) if group is None else group
    return class_share(found.values, TRUTH, group, FAST, "marks", found.ranks)


@pytest.mark.every(3)
@pytest.mark.parametrize("mark", MARKS, ids=lambda mark: mark.__name__)
@pytest.mark.parametrize("draw", [plain, louder])
def test_a_mark_is_found_and_named(mark, draw):
    found = evidence(draw, mark, seed=0)
    result = share(found)
    assert result.low > result.chance
    assert result.p < 0.05
    assert result.share > (0.25 if mark is set_one_class else 0.5)
    if draw is plain:
        assert re.search(MARKS[mark], found.cure)


@pytest.mark.every(3)
@pytest.mark.parametrize("draw", [plain, louder])
@pytest.mark.parametrize("seed", range(5))
def test_without_a_mark_there_is_none(draw, seed):
    """However loud, noisy and busy a class is."""
    found = evidence(draw, None, seed)
    assert marked_places(found.ranks, TRUTH).size == 0
    result = share(found)
    assert result.share == pytest.approx(result.chance)
    assert result.low <= result.chance <= result.high


def test_what_all_classes_have_is_no_mark():
    def draw(rng, label):
        levels = body(rng, SIDE)
        levels[:, -3:] = 200
        levels[:6, :10] = 0
        return levels

    found = evidence(draw, None, seed=0)
    assert marked_places(found.ranks, TRUTH).size == 0


def test_marks_of_persons_tell_nothing_of_others():
    """Each of eight persons who do all classes has a mark of their own."""
    rng, person = np.random.default_rng(0), np.arange(TRUTH.size) % 8
    features = []
    for who in person:
        levels = body(rng, SIDE)
        levels[0, 0] = 30 * who
        features.append(mark_features(np.clip(levels, 0, 255).astype(np.uint8)))
    result = share(mark_evidence(features, TRUTH, (SIDE, SIDE)), person)
    assert result.low <= result.chance <= result.high


@pytest.mark.parametrize("size", [(1, 1), (2, 3), (8, 8), (5, 300), (70, 9)])
def test_images_of_any_size(size):
    rng = np.random.default_rng(0)
    features = [mark_features(rng.integers(0, 255, size).astype(np.uint8)) for _ in TRUTH]
    found = mark_evidence(features, TRUTH, size)
    assert np.isfinite(found.values).all()
    assert found.values.shape == (TRUTH.size, 2 * found.ranks.shape[1])


@pytest.mark.every(4)
@pytest.mark.parametrize("mark", [set_corner, add_outer_rows, add_first_column, None])
def test_the_audit_says_so(tmp_path, mark):
    def draw(rng, label):
        levels = body(rng)
        if mark is not None:
            mark(levels, 2 * label)
        return levels

    data = tree(tmp_path / "tree", draw, classes=("a", "b", "c"), count=24)
    result = audit(data, Listener(), effort=FAST)
    (line,) = [one for one in result.lines if one.evidence.name == "marks at fixed places"]
    assert line.is_leak == (mark is not None)
    assert ("may be the movement" in line.verdict) is False
    assert line.verdict.startswith("at chance") == (mark is None)
