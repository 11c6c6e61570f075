"""scripts/document_limits.py: a result as a part of the page, and a page without a place for it."""

import sys

import document_limits
import pytest

from radhar_cli.study.limits.report import HEAD

TEXT = f"""# How far x may go

`radhar limits x.yaml -o OUT`

Every number.

| what is drawn | at most | ends at | beyond | what ends |
| --- | --- | --- | --- | --- |
| speed | 2 m/s | 9 m/s | folds | radar |

## radar

{HEAD}
| `radar.prf_hz` | 500 | 100 | 9000 | folds; there 2.5 times as slow | no; there 9 times as slow |
| `seed` | 1 | 0 | 99 | refused | refused |

Not finished: motion.
"""


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "x"
    folder.mkdir()
    (folder / "limits.md").write_text(TEXT.replace("OUT", str(folder)))
    return folder


def test_numbers_that_their_keys_end_are_named_in_a_sentence(out):
    name, part = document_limits.read_result(out, "abc123")
    assert name == "x"
    assert part.startswith("## x\n\n`radhar limits x.yaml -o out/x` at commit abc123:\n\n| what is")
    assert "| speed | 2 m/s | 9 m/s | folds | radar |" in part
    assert "| 100 | 9000 | folds | no; there 9 times as slow |" in part
    assert "\nAs far as their keys go: `seed` 0 to 99.\n\nNot finished: motion." in part
    assert part.count("`seed`") == 1


def test_a_page_without_a_place_for_the_result_is_refused(out, tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.md"
    page.write_text("<!-- begin y -->\n<!-- end y -->\n")
    monkeypatch.setattr(document_limits, "PAGE", page)
    monkeypatch.setattr(sys, "argv", ["document_limits", "abc123", str(out)])
    with pytest.raises(SystemExit):
        document_limits.main()
    assert "page.md: has no markers for x" in capsys.readouterr().err
    page.write_text("<!-- begin x -->\n<!-- end x -->\n")
    document_limits.main()
    assert page.read_text().startswith("<!-- begin x -->\n## x\n")
