"""The page of captures prints what its commands print."""

from helpers.capture_files import write_all
from helpers.command_line import ROOT, radhar
from helpers.documents import blocks
from helpers.shell import Answer, Call, run_shell


def answer(call: Call) -> Answer:
    done = radhar(*call.words)
    return Answer(done.returncode, done.stdout, done.stderr)


def test_first_lines_of_every_import_are_those_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_all(tmp_path)
    page_blocks = blocks(ROOT / "docs/guide/captures.md")
    commands = [block for block in page_blocks if block.language == "sh"]
    printed = [block for block in page_blocks if block.language == "text"]
    assert len(commands) == len(printed) > 5
    for command, text in zip(commands, printed, strict=True):
        done = run_shell(command.text, tmp_path, {"radhar": answer})
        assert done.returncode == 0, done.stderr
        assert done.stdout == text.text
