"""The one reader of YAML: plain values and the line of every key, within bounds.

Scalars are those of YAML 1.2: ``77e9`` is a number, ``1:30`` and ``yes`` are text. Keys are text
and do not repeat; tags are refused.
"""

import re
from typing import Any, NoReturn

import yaml

from radhar_cli.errors import ConfigError
from radhar_cli.files.untrusted import DEEPEST

MAX_TEXT = 2**16  # characters, every alias written out
MAX_KEY_LENGTH = 100
Lines = dict[str, int]

_INT = re.compile(r"[-+]?(?:0|[1-9][0-9_]*)")
_FLOAT = re.compile(
    r"[-+]?(?:[0-9][0-9_]*\.[0-9_]*(?:[eE][-+]?[0-9]+)?|\.[0-9][0-9_]*(?:[eE][-+]?[0-9]+)?|[0-9][0-9_]*[eE][-+]?[0-9]+"
    r"|\.(?:inf|Inf|INF))|\.(?:nan|NaN|NAN)"
)
_WORDS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def parse_yaml(text: str, where: str) -> tuple[Any, Lines]:
    """Parse one YAML document.

    Args:
        text: the document.
        where: file or option that messages name.

    Returns:
        The value, None for an empty document, and {dotted key: line}.

    Raises:
        ConfigError: the text is not YAML, has tags, repeats keys, or is too deep or too long.
    """
    lines: Lines = {}
    try:
        node = _Loader(text).get_single_node()
        return (None if node is None else _value(node, "", lines)), lines
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f":{mark.line + 1}" if mark else ""
        raise ConfigError(f"{where}{line}: not valid YAML: {error.problem}") from None
    except yaml.YAMLError as error:
        raise ConfigError(f"{where}: not valid YAML: {str(error).splitlines()[0]}") from None


class _Loader(yaml.BaseLoader):
    """Composes nodes, and counts what they would hold if every alias were written out."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = self._written = 0
        self._sizes: dict[yaml.Node | None, int] = {}

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        before = self._written
        event = self.peek_event()  # type: ignore[no-untyped-call]
        self._depth += 1
        if self._depth > DEEPEST:
            _refuse(event, f"it is nested deeper than {DEEPEST} levels")
        if getattr(event, "tag", None) is not None:
            _refuse(event, f"the tag {event.tag!r} has no meaning here")
        node = super().compose_node(parent, index)
        self._depth -= 1
        if not isinstance(event, yaml.AliasEvent):
            self._written += 1 + len(getattr(event, "value", ""))
            self._sizes[node] = self._written - before
        elif node in self._sizes:
            self._written += self._sizes[node]
        else:
            _refuse(event, f"the alias {event.anchor!r} stands inside of what it stands for")
        if self._written > MAX_TEXT:
            _refuse(event, f"with every alias written out it has more than {MAX_TEXT} characters")
        return node


def _refuse(node: Any, problem: str) -> NoReturn:
    raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def _value(node: yaml.Node, key: str, lines: Lines) -> Any:
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, key, lines)
    if isinstance(node, yaml.SequenceNode):
        return [_value(item, f"{key}.{place}", lines) for place, item in enumerate(node.value)]
    return _scalar(node)


def _scalar(node: Any) -> Any:
    text: str = node.value
    if node.style is not None:  # quoted, or a block of text
        return text
    if text in _WORDS:
        return _WORDS[text]
    try:
        if _INT.fullmatch(text):
            return int(text.replace("_", ""))
    except ValueError:  # more digits than Python converts
        _refuse(node, f"{text[:20]}... has {len(text)} digits")
    if _FLOAT.fullmatch(text):
        return float(text.replace("_", "").lower().replace(".inf", "inf").replace(".nan", "nan"))
    return text


def _mapping(node: yaml.MappingNode, key: str, lines: Lines) -> dict[str, Any]:
    mapping: dict[str, Any] = {}
    for name_node, value_node in node.value:
        name = _value(name_node, "", {})
        if not isinstance(name, str) or len(name) > MAX_KEY_LENGTH:
            shortened = repr(name)[: MAX_KEY_LENGTH // 2]
            _refuse(
                name_node,
                f"the key {shortened} should be text of at most {MAX_KEY_LENGTH} characters",
            )
        if name in mapping:
            _refuse(name_node, f"the key {name!r} appears twice")
        inner = f"{key}.{name}" if key else name
        lines[inner] = name_node.start_mark.line + 1
        mapping[name] = _value(value_node, inner, lines)
    return mapping
