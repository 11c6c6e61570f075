"""scripts/page_parts.py: a text takes the place of its part of the page alone."""

import pytest
from page_parts import replace_part


def test_a_part_is_replaced_and_the_others_stay():
    page = "top\n<!-- begin a -->\nold\n<!-- end a -->\n<!-- begin b -->\nb\n<!-- end b -->\n"
    changed = replace_part(page, "a", "\nnew\n")
    assert "old" not in changed
    assert "<!-- begin a -->\n\nnew\n\n<!-- end a -->" in changed
    assert changed.endswith("<!-- begin b -->\nb\n<!-- end b -->\n")


def test_parts_may_share_the_marker_of_their_end():
    page = "<!-- a -->\n1\n<!-- end -->\nbetween\n<!-- b -->\n2\n<!-- end -->\n"
    changed = replace_part(page, "b", "new", "<!-- b -->", "<!-- end -->")
    assert changed == page.replace("2", "new")


@pytest.mark.parametrize("page", ["page", "<!-- begin c -->", "<!-- end c --><!-- begin c -->"])
def test_a_page_without_its_markers_is_refused(page):
    with pytest.raises(ValueError, match="no markers for c"):
        replace_part(page, "c", "new")
