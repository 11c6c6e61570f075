"""Data sets with planted leaks of each kind, and clean ones, by the program."""

import json

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.listener import Listener
from helpers.slow import slow
from helpers.small import SMALL, small_config
from PIL import Image
from study.audit.trees import body, clean, save, tree

from radhar_cli.dataset.audited import read_audit
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.study.audit.audit import AuditLine, audit
from radhar_cli.study.audit.card import END, with_section
from radhar_cli.study.audit.cheap import _limit, binned_share
from radhar_cli.study.audit.evidence import Evidence, EvidencePart
from radhar_cli.study.audit.held_out import Effort, class_share

FAST = Effort(trees=12, folds=3, permutations=200)


def audited(path, **options):
    return audit(path, Listener(), effort=FAST, **options)


def line(result, name):
    (found,) = [one for one in result.lines if one.evidence.name == name]
    return found


def leaks(result):
    return {one.evidence.name for one in result.lines if one.is_leak}


def test_of_a_clean_tree_nothing_tells(tmp_path):
    result = audited(tree(tmp_path / "clean", clean, count=40))
    assert not leaks(result)
    for one in result.lines:
        if one.result is not None:
            assert one.verdict.startswith("at chance")
            assert one.cure == ""
    assert not result.sentences
    assert result.held_out == "sample"


def edge(side):
    def draw(rng, label):
        levels = body(rng)
        columns = slice(0, 3) if side == "first" else slice(-3, None)
        levels[20:28, columns] += 90 * label
        return levels

    return draw


@pytest.mark.parametrize("side", ["first", "last"])
def test_what_is_under_way_at_an_edge(tmp_path, side):
    result = audited(tree(tmp_path / "edge", edge(side)))
    found = line(result, f"{side} columns")
    assert found.is_leak
    assert "it may be the movement" in found.verdict
    assert "cut windows anywhere" in found.cure
    other = {"first": "last", "last": "first"}[side]
    assert line(result, f"{other} columns").result.share < 0.75 < found.result.share


def test_a_louder_room(tmp_path):
    result = audited(tree(tmp_path / "loud", lambda rng, label: body(rng, floor=40 + 15 * label)))
    assert {"rows far from bodies", "noise: its level", "levels: mean, spread"} <= leaks(result)
    assert line(result, "noise: its level").verdict == "gives the class away"
    assert not line(result, "noise: its texture").is_leak


def test_noise_of_another_texture(tmp_path):
    def draw(rng, label):
        noise = rng.normal(0, 12, (48, 49))
        smooth = np.sqrt(0.5) * (noise[:, 1:] + noise[:, :-1])
        levels = 60 + (smooth if label else noise[:, 1:])
        levels[20:28, 10:20] += 150
        return levels

    assert line(audited(tree(tmp_path / "texture", draw)), "noise: its texture").is_leak


def test_pictures_of_other_sizes(tmp_path):
    result = audited(tree(tmp_path / "size", lambda rng, label: body(rng, 48 + 8 * label)))
    assert line(result, "size: compressed, file, pixels").is_leak


def test_numbers_in_names_of_files(tmp_path):
    root = tree(tmp_path / "order", clean, name="rec{label}{number:03d}")
    assert "number in the name" in leaks(audited(root))


def write(path, header, rows):
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_table_of_recordings(tmp_path):
    root = tree(tmp_path / "tree", clean)
    rows = [
        f"{name}/{n:03d}.png,P{n % 6},{4 + 2 * label if n % 7 else ''},2024-0{label + 1}-11"
        for label, name in enumerate(("walking", "falling"))
        for n in range(30)
    ]
    table = write(tmp_path / "t.csv", "file,person,length_s,date", rows)
    result = audited(root, table=table)
    assert {"length_s", "date"} <= leaks(result)
    assert result.held_out == "person"
    assert not line(result, "person").is_leak, "everybody does everything"


def test_missing_cells_of_one_class_tell_it(tmp_path):
    root = tree(tmp_path / "tree", clean)
    rng = np.random.default_rng(0)
    rows = [f"walking/{n:03d},{rng.random():.3f}" for n in range(30)]
    rows += [f"falling/{n:03d}," for n in range(30)]
    result = audited(root, table=write(tmp_path / "t.csv", "file,gain", rows))
    assert line(result, "gain").verdict == "gives the class away"


def test_a_person_who_does_one_class(tmp_path):
    persons = ((n, label, n % 4 + 7 * (label == "b")) for n in range(40) for label in "ab")
    rows = [f"{label},{who},{n}" for n, label, who in persons]
    result = audited(write(tmp_path / "t.csv", "class,person,order", rows))
    assert line(result, "person").verdict == "gives the class away"
    assert not line(result, "order").is_leak


def test_one_person_alone_cannot_be_held_out(tmp_path):
    rows = [f"{label},me,{n + 50 * (label == 'b')}" for n in range(20) for label in "ab"]
    result = audited(write(tmp_path / "t.csv", "class,person,order", rows))
    assert result.held_out == "sample"
    assert any("too few persons have each class" in warning for warning in result.warnings)
    assert line(result, "order").is_leak


def test_duplicates_and_persons_in_several_splits(tmp_path):
    rng = np.random.default_rng(0)
    for split in ("train", "test"):
        for name in ("walking", "falling"):
            for n in range(6):
                save(body(rng), tmp_path / "d" / split / name / f"{n}.png")
    twin = body(rng)
    save(twin, tmp_path / "d/train/walking/0.png")
    save(twin, tmp_path / "d/test/walking/5.png")
    save(twin, tmp_path / "d/train/falling/3.png")
    near = twin.copy()
    near[5, 5] += 20
    save(near, tmp_path / "d/test/falling/2.png")
    rows = [
        f"{split}/{name}/{n}.png,P{n}"
        for split in ("train", "test")
        for name in ("walking", "falling")
        for n in range(6)
    ]
    table = write(tmp_path / "t.csv", "file,person", rows)
    result = audited(tmp_path / "d", table=table)
    identical = result.overlaps.identical
    assert (identical.count, identical.across_splits, identical.across_classes) == (3, 3, 3)
    assert result.overlaps.near.count == 4
    assert result.overlaps.across_splits["person"] == 6
    assert any("6 persons are in several splits" in text for text in result.sentences)


def test_three_samples_of_two_classes(tmp_path):
    root = tree(tmp_path / "few", clean, count=1)
    save(body(np.random.default_rng(1)), root / "walking" / "001.png")
    result = audited(root)
    assert all(one.result is None for one in result.lines)
    assert all(one.verdict.startswith("not tested") for one in result.lines)
    assert any("left out" in warning and "falling" in warning for warning in result.warnings)


def test_one_class(tmp_path):
    done = ok("audit", tree(tmp_path / "one", clean, ("walking",), 4), "-o", tmp_path / "out")
    assert "not tested" in done.stdout
    assert (tmp_path / "out/audit.png").exists()


def test_black_images_and_constant_columns(tmp_path):
    root = tree(tmp_path / "black", lambda rng, label: np.zeros((20, 20)), count=4)
    table = write(
        tmp_path / "t.csv",
        "file,gain",
        [f"{c}/{n:03d},7" for c in ("walking", "falling") for n in range(4)],
    )
    result = audited(root, table=table)
    assert "gain" not in {one.evidence.name for one in result.lines}
    assert not leaks(result)
    assert result.overlaps.identical.count == 8


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A small data set: of three classes ten samples, which start at ranges of their own."""
    folder = tmp_path_factory.mktemp("audit")
    text = SMALL.replace("samples_per_class: 3", "samples_per_class: 10") + (
        "timing: {walk_stop_s: 2.0}\n"
    )
    text = text.replace(
        "motion: {model: paper}",
        "motion: {model: paper, range_m: {per_activity: {default: {uniform: [2, 2.5]}, "
        "walking: {uniform: [4, 4.5]}, S12: {uniform: [7, 7.5]}}}}",
    ).replace("[rtm, stft, fsst_compensated]", "[stft]")
    ok("generate", small_config(folder, text), "-o", folder / "data", "--jobs", "1")
    return folder / "data"


def test_a_simulated_data_set(data):
    result = audited(data)
    found = line(result, "motion.range_m")
    assert found.result.share == 1
    assert found.verdict == "gives the class away"
    assert found.cure.startswith("motion.")
    names = {one.evidence.key for one in result.lines}
    assert "subject.height_m" in names
    assert "motion.walking.speed_mps" not in names
    assert not line(result, "subject.height_m").is_leak
    together = [one for one in result.lines if one.evidence.name.startswith("all ")]
    assert together[0].result.share > 0.6
    assert any("walk_stop_s is on cue" in text for text in result.sentences)


def test_the_card_has_a_section_that_a_second_audit_replaces(data):
    for _ in range(2):
        ok("audit", data, "--quick", "--overwrite")
    card = (data / "README.md").read_text()
    assert card.count("## Who is told apart by what") == 1
    assert card.index("## Who is told apart") < card.index("## Known biases and limits")
    assert "| motion.range_m | 100.0 (" in card
    assert (data / "audit/audit.png").is_file()
    ok("verify", data, "--samples", "0")


@pytest.mark.drawn
def test_bytes_depend_on_the_seed_alone(data, tmp_path, monkeypatch):
    ok("audit", data, "--quick", "-o", tmp_path / "a")
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    ok("audit", data, "--quick", "-o", tmp_path / "b")
    for name in ("audit.json", "audit.csv", "audit.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    ok("audit", data, "--quick", "-o", tmp_path / "c", "--seed", "2")
    assert (tmp_path / "c/audit.csv").read_text() != (tmp_path / "a/audit.csv").read_text()


@pytest.mark.drawn
def test_what_is_written(data, tmp_path):
    done = ok("audit", data, "--quick", "--json", "-o", tmp_path / "out")
    printed = json.loads(done.stdout)
    stored = json.loads((tmp_path / "out/audit.json").read_text())
    assert printed["lines"] == stored["lines"]
    with open_dataset(data) as opened:
        assert stored["classes"] == list(opened.classes)
    header, first, *_ = (tmp_path / "out/audit.csv").read_text().splitlines()
    assert header.startswith("part,name,key,share,low_95,high_95,chance,p_uncalibrated,tells,")
    assert first.startswith("numbers,")
    with Image.open(tmp_path / "out/audit.png") as picture:
        assert picture.width > 600


def test_fail_above(data, tmp_path):
    failed = radhar("audit", data, "--quick", "-o", tmp_path / "a", "--fail-above", "0.9")
    assert failed.returncode == 1
    assert "above 0.9: motion.range_m" in failed.stderr
    done = radhar("audit", data, "--quick", "-o", tmp_path / "b", "--fail-above", "1")
    assert done.returncode == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("nowhere", "-o", "out"), "nowhere: no such file or folder"),
        (("tree",), "-o should name a folder"),
        (("tree", "-o", "tree/out"), "lies in the data"),
        (("tree", "-o", "out", "--table", "none.csv"), "none.csv: no such file"),
        (("tree", "-o", "out", "--map", "stft"), "has no map 'stft'"),
        (("t.csv", "-o", "out"), "one should be class or label or activity"),
        (("tree", "-o", "out", "--fail-above", "2"), "--fail-above 2"),
        (("run", "-o", "out"), "is a training run"),
    ],
)
def test_mistakes_are_a_line(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    tree(tmp_path / "tree", clean, count=2)
    write(tmp_path / "t.csv", "file,person", ["a,b"])
    (tmp_path / "run").mkdir()
    (tmp_path / "run/run.json").write_text("{}")
    done = radhar("audit", *words)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_an_earlier_audit_is_not_replaced_unasked(tmp_path):
    root = tree(tmp_path / "tree", clean, count=3)
    ok("audit", root, "-o", tmp_path / "out", "--quick")
    again = radhar("audit", root, "-o", tmp_path / "out", "--quick")
    assert again.returncode == 2
    assert "--overwrite replaces" in again.stderr


def test_a_broken_image_is_named(tmp_path):
    root = tree(tmp_path / "tree", clean, count=3)
    (root / "walking/001.png").write_bytes(b"\x89PNG\r\n")
    done = radhar("audit", root, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "001.png: is not an image, or is truncated" in done.stderr


def test_without_scikit_learn_it_says_what_to_install(tmp_path, monkeypatch):
    import importlib.util

    original = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "sklearn" else original(name)
    )
    done = radhar("audit", tmp_path, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "needs sklearn, which is not installed: " in done.stderr


def test_verify_says_what_tells_most(data):
    ok("audit", data, "--quick", "--overwrite")
    said = ok("verify", data, "--samples", "0").stdout
    assert "lines tell the class beyond chance; " in said
    assert "walk_stop_s is on cue" in said


def test_verify_needs_no_scikit_learn(data, monkeypatch):
    import sys

    (data / "audit/audit.json").unlink(missing_ok=True)
    monkeypatch.setitem(sys.modules, "sklearn", None)
    done = ok("verify", data, "--samples", "0")
    assert "motion.range_m alone tells the class in 100 % (chance 33): radhar audit" in done.stdout
    assert "timing.walk_stop_s is on cue: " in done.stdout
    assert done.stdout.index("is on cue") < done.stdout.index("motion.range_m alone")


def test_a_damaged_audit_is_named(data):
    ok("audit", data, "--quick", "--overwrite")
    path = data / "audit/audit.json"
    stored = json.loads(path.read_text())
    for wrong in ({**stored, "lines": 3}, {**stored, "lines": [{"part": "x"}]}, {}, []):
        path.write_text(json.dumps(wrong))
        with pytest.raises(FolderError, match="is damaged"):
            read_audit(data)
    stored["lines"][0]["name"] = "\x1b[2J"
    path.write_text(json.dumps(stored))
    with pytest.raises(FolderError, match="is not a line of text"):
        read_audit(data)
    path.unlink()
    assert read_audit(data) is None


def test_a_card_without_limits_gets_the_section_at_its_end():
    assert with_section("# mine\n", "## new").endswith(f"## new\n{END}\n")


def test_a_share_beyond_chance_is_four_deviations_of_dependent_tests():
    """Of 170 samples in two classes: 0.5 + 4 sqrt(1.7 0.25 / 170)."""
    assert _limit(0.5, 170) == pytest.approx(0.7)


def test_binned_shares():
    label = np.repeat([0, 1, 2], 40)
    rng = np.random.default_rng(0)
    assert binned_share(rng.random(120), label)[0] == pytest.approx(1 / 3, abs=0.15)
    assert binned_share(label + rng.random(120), label)[0] > 0.9
    assert binned_share(np.array([1.0]), np.array([0])) == (0.0, 1.0)


LAWS = {
    "place": "motion: {place: {range_m: {per_activity: {default: {uniform: [2, 4]}, walking: 6}}}}",
    "range": "motion: {range_m: {per_activity: {default: {uniform: [2, 4]}, walking: 6}}}",
    "onset": "timing: {onset: {per_activity: {default: {uniform: [0, 1]}, punching: 0.2}}}",
    "alike": "motion: {range_m: {per_activity: {default: 3, walking: 3}}}",
    "speed": "motion: {walking: {speed_mps: {per_activity: {default: 1.2, walking: 0.8}}}}",
}


@pytest.mark.parametrize("name", ["place", "alike", *slow(["range", "onset", "speed"])])
def test_a_law_that_differs_by_class_is_told_from_the_config(tmp_path, name):
    """Three samples a class say nothing by statistics; verify and audit agree."""
    text = f"""
activities: [walking, punching]
samples_per_class: 3
duration_s: 1
radar: {{carrier_hz: 24e9, prf_hz: 1000}}
maps: [stft]
image: {{size_px: 16}}
{LAWS[name]}
"""
    (tmp_path / "c.yaml").write_text(text)
    dry = ok("generate", tmp_path / "c.yaml", "-o", tmp_path / "data", "--dry-run", "--jobs", "1")
    ok("generate", tmp_path / "c.yaml", "-o", tmp_path / "data", "--jobs", "1")
    said = ok("verify", tmp_path / "data", "--samples", "0").stdout
    found = ok("audit", tmp_path / "data", "--quick", "-o", tmp_path / "audit").stdout
    is_law = name not in ("alike", "speed")
    for text in (dry.stdout + dry.stderr, said, found):
        assert ("is drawn by another law for some classes" in text) == is_law
    assert "no scene number alone" not in said
    if not is_law:
        assert "6 samples are too few to tell" in said
        assert "too few samples to tell" in found or "not tested" in found


def test_persons_of_one_class_each_are_said_not_to_tell():
    """What tells twenty persons apart tells their classes, of those held out, too, by chance."""
    rng = np.random.default_rng(0)
    group = np.repeat(np.arange(20), 3)
    values = 3 * rng.normal(size=(20, 3))[group] + rng.normal(size=(60, 3))
    evidence = Evidence(EvidencePart.NUMBERS, "x", values)
    for label, is_told in ((group % 4, False), (np.arange(60) % 3, True)):
        result = class_share(values, label, group, FAST, "x")
        verdict = AuditLine(evidence, result, result.p).verdict
        assert verdict.startswith("cannot be told") != is_told
