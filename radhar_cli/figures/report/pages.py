"""Reports as pages for people: Markdown, and HTML that needs no other file."""

import re
from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from html import escape

from radhar_cli.figures.report.parts import (
    Details,
    Part,
    ReportFigure,
    ReportSection,
    ReportTable,
    Sentences,
    number_text,
)
from radhar_cli.files.table_text import markdown_table

DIGITS = 3  # of a number in a table for people
NUMBER = re.compile(r"[-+]?[\d\u202f]*\.?\d+(e[-+]?\d+)?( %)?")  # of a cell
STYLE = """
:root { --line: #d8dee4; --soft: #57606a; }
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2328; max-width: 66rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; }
h2 { border-bottom: 1px solid var(--line); padding-bottom: .25rem; margin-top: 2.4rem; }
h3 { margin: 1.4rem 0 .3rem; font-size: 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .4rem 0 1.2rem; font-variant-numeric: tabular-nums; }
@media (max-width: 40rem) { body { margin: 1rem auto; } th, td { padding: .2rem .35rem; } }
th, td { padding: .22rem .7rem; border-bottom: 1px solid var(--line); text-align: left;
  vertical-align: top; }
th { color: var(--soft); font-weight: 600; }
.number { text-align: right; }
.soft, figcaption { color: var(--soft); }
.warning { background: #fff8c5; border-left: 4px solid #d4a72c; padding: .4rem .8rem; }
figure { margin: 1.2rem 0; } img { max-width: 100%; height: auto; }
code, pre { background: #f6f8fa; font-size: 13px; }
pre { padding: .8rem; overflow-x: auto; }
"""


def markdown_page(title: str, about: str, sections: Iterable[ReportSection]) -> str:
    """Text of a page in Markdown, whose figures are the files beside it."""
    blocks = [f"# {title}", about]
    for section in sections:
        blocks += [f"## {section.title}" if section.title else "", *_markdown(section.parts)]
    return "\n\n".join(block for block in blocks if block) + "\n"


def _markdown(parts: Iterable[Part]) -> Iterator[str]:
    """Yield blocks of Markdown."""
    for part in parts:
        match part:
            case Sentences(texts, is_list):
                yield "\n".join(f"- {text}" for text in texts) if is_list else "\n\n".join(texts)
            case ReportTable(is_shown=True):
                yield from (f"### {part.title}" if part.title else "", part.about)
                yield markdown_table(_heads(part), [map(number_text, row) for row in part.rows])
            case ReportFigure(file, caption, _):
                yield f"![{caption}]({file})"
            case Details(title, text):
                yield f"### {title}\n\n```\n{text}\n```"


def html_page(title: str, about: str, sections: Iterable[ReportSection], note: str) -> str:
    """Text of a page in HTML with its figures in it.

    Args:
        title: title of the page.
        about: line below it.
        sections: parts of the page.
        note: last line.
    """
    body = [f"<h1>{escape(title)}</h1>", f'<p class="soft">{_inline(about)}</p>']
    for section in sections:
        body += [
            f"<h2>{escape(section.title)}</h2>" if section.title else "",
            *_html(section.parts),
        ]
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style></head><body>\n"
        + "\n".join(line for line in body if line)
        + f'\n<p class="soft">{escape(note)}</p>\n</body></html>\n'
    )


def _html(parts: Iterable[Part]) -> Iterator[str]:
    """Yield elements of HTML."""
    for part in parts:
        match part:
            case Sentences(texts, True):
                yield f"<ul>{''.join(f'<li>{_inline(text)}</li>' for text in texts)}</ul>"
            case Sentences(texts, False):
                for text in texts:
                    kind = ' class="warning"' if "warning:" in text else ""
                    yield f"<p{kind}>{_inline(text)}</p>"
            case ReportTable(is_shown=True):
                yield f"<h3>{escape(part.title)}</h3>" if part.title else ""
                yield f"<p>{_inline(part.about)}</p>" if part.about else ""
                yield _html_table(part)
            case ReportFigure(_, caption, png):
                source = f"data:image/png;base64,{b64encode(png).decode()}"
                yield f'<figure><img alt="{escape(caption)}"\nsrc="{source}">'
                yield f"<figcaption>{escape(caption)}</figcaption></figure>"
            case Details(title, text):
                yield f"<details><summary>{escape(title)}</summary>"
                yield f"<pre>{escape(text)}</pre></details>"


def _html_table(table: ReportTable) -> str:
    """HTML of a table; columns of numbers lie on the right."""
    rows = [[number_text(cell, DIGITS) for cell in row] for row in table.rows]
    is_number = [_is_of_numbers(column) for column in zip(*rows, strict=True)]
    is_number += [False] * (len(table.header) - len(is_number))

    def line(cells: Sequence[str], tag: str) -> str:
        kinds = (' class="number"' if right else "" for right in is_number)
        pairs = zip(cells, kinds, strict=True)
        return (
            f"<tr>{''.join(f'<{tag}{kind}>{_inline(cell)}</{tag}>' for cell, kind in pairs)}</tr>"
        )

    body = "\n".join(line(row, "td") for row in rows)
    head = line(_heads(table), "th")
    return f'<div class="scroll"><table>{head}\n{body}</table></div>'


def _is_of_numbers(column: Sequence[str]) -> bool:
    """Whether most cells of a column are numbers."""
    cells = [cell for cell in column if cell]
    return 2 * sum(NUMBER.fullmatch(cell) is not None for cell in cells) > len(cells)


def _heads(table: ReportTable) -> list[str]:
    return [str(name).replace("_", " ") for name in table.header]


def _inline(text: str) -> str:
    """HTML of a text in which `words` are code."""
    parts = escape(text).split("`")
    if len(parts) % 2 == 0:  # as where a name has one
        return escape(text)
    return "".join(f"<code>{part}</code>" if n % 2 else part for n, part in enumerate(parts))
