"""Parts of a page of the documents that a script writes: what stands between two markers."""


def replace_part(page: str, name: str, text: str, begin: str = "", end: str = "") -> str:
    """Put a text into the part of a page between its markers; what stands around it stays.

    Args:
        page: text of the page.
        name: name of the part.
        text: text of the part, which stands on lines of its own.
        begin: marker before the part; "" for `<!-- begin NAME -->`.
        end: marker after it; "" for `<!-- end NAME -->`.

    Returns:
        Text of the page with the new part.

    Raises:
        ValueError: the page does not have both markers.
    """
    begin, end = begin or f"<!-- begin {name} -->", end or f"<!-- end {name} -->"
    before, first_marker, rest = page.partition(begin)
    _, second_marker, after = rest.partition(end)
    if not first_marker or not second_marker:
        raise ValueError(f"has no markers for {name}")
    return f"{before}{begin}\n{text}\n{end}{after}"
