"""Calls of the radar in a script of mmWave Studio (Lua), as they stand in its text.

Nothing is run: a script is read from top to bottom. Names that are set to numbers, or to sums of
such, have those values in the calls below them, and blocks whose condition compares them, such as
`if (partId == 1843) then`, are read or left out. A name that is set within another condition, a
loop or a function has no value after that, and a call within them reads only names that are set
once in the whole script. Any other argument stays text, which whoever reads the calls refuses.
"""

import ast
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from operator import add, mul, neg, pos, pow, sub, truediv
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

LONGEST_ARGUMENTS = 1000  # characters between the parentheses of a call
LARGEST = 1e12
DEEPEST = 200  # blocks within each other, as in Lua

_NAME = r"[A-Za-z_]\w*"
_NAMES = rf"{_NAME}(?:\s*,\s*{_NAME}){{0,20}}"
# What a reader of numbers leaves out; strings may hold anything, and so become blank.
_UNREAD = re.compile(
    r"--\[(=*)\[.*?(?:\]\1\]|\Z)|--[^\n]*|\[(=*)\[.*?(?:\]\2\]|\Z)"
    r"""|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'""",
    re.DOTALL,
)
_TOKEN = re.compile(
    rf"""(?<![.:\w])(?:
        (?P<word>if|then|elseif|else|do|repeat|end|until)\b
        | (?P<function>function)\b[^()\n]{{0,200}}\((?P<parameters>[^()]{{0,1000}})\)
        | for\s+(?P<counters>{_NAMES})\s*(?:=|in\b)
        | (?P<names>{_NAMES})\s*=(?!=)
        | local\s+(?!function\b)(?P<declared>(?>{_NAMES}))(?!\s*=)
        | ar1\s*\.\s*(?P<call>\w+)
    ) | (?P<brace>[{{}}])""",
    re.VERBOSE,
)
# An expression ends with its line, unless an operator stands there, or with the next statement.
_EXPRESSION = re.compile(
    r"(?:(?!\b(?:end|else|elseif|local|if|for|while|repeat|until|function|return|do|then)\b)[^\n;]"
    r"|(?<=[-+*/^,(])[ \t]*\n|\n(?=\s*[-+*/^,]))*"
)
_OPERATIONS: Mapping[type, Callable[..., float]] = MappingProxyType(
    {
        ast.Add: add,
        ast.Sub: sub,
        ast.Mult: mul,
        ast.Div: truediv,
        ast.Pow: pow,
        ast.USub: neg,
        ast.UAdd: pos,
    }
)

_NO_PARENTHESES = str.maketrans("()", "  ")
_COMPARISON = re.compile(rf"\s*({_NAME})\s*==\s*([\w.]+)\s*")

Argument: TypeAlias = float | str


class DeviceCall(NamedTuple):
    """Call of the radar.

    Attributes:
        line: Line of the script, from 1.
        name: Name after `ar1.`.
        arguments: Numbers; the text of an argument that is none.
    """

    line: int
    name: str
    arguments: tuple[Argument, ...]


@dataclass
class _Block:
    """Block of a condition, a loop or a function.

    Attributes:
        is_read: Whether its statements may be reached.
        is_sure: Whether they certainly are, once.
        is_done: Whether a branch of its condition certainly holds.
        may_be_done: Whether another branch may hold.
    """

    is_read: bool = True
    is_sure: bool = False
    is_done: bool = False
    may_be_done: bool = False

    def begin_branch(self, holds: bool | None) -> None:
        """Begin a branch whose condition holds, does not, or cannot be told."""
        self.is_read = not self.is_done and holds is not False
        self.is_sure = self.is_read and holds is True and not self.may_be_done
        self.is_done |= holds is True
        self.may_be_done |= holds is None


def read_device_calls(text: str) -> Iterator[DeviceCall]:
    """Yield the calls of a script in the order in which they stand.

    Time and memory are proportional to the length of the text; what blocks deeper than DEEPEST hold
    is not read.
    """
    text = _UNREAD.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    set_once = _names_set_once(text)
    values, constants = dict[str, float](), dict[str, float]()  # constants are set once
    blocks = list[_Block]()
    braces = end = condition = 0
    line = 1
    for token in _TOKEN.finditer(text):
        line, end = line + text.count("\n", end, token.start()), token.start()
        around = blocks[:-1] if token["word"] == "then" else blocks  # what its condition stands in
        is_sure = all(block.is_sure for block in around)
        known = values if is_sure else constants
        match token["word"] or ("do" if token["function"] else ""):
            case "if":
                blocks.append(_Block())
                condition = token.end()
            case "elseif":
                condition = token.end()
            case "then" if blocks:
                blocks[-1].begin_branch(_holds(text[condition : token.start()], known))
            case "else" if blocks:
                blocks[-1].begin_branch(True)
            case "do" | "repeat":
                blocks.append(_Block())
            case "end" | "until" if blocks:
                blocks.pop()
        braces += {"{": 1, "}": -1}.get(token["brace"], 0)
        if len(blocks) > DEEPEST:
            return
        if not all(block.is_read for block in blocks):
            continue
        if token["names"] and not braces:
            _assign(token, text, values, is_sure)
            names = {
                name for name in _split_names(token["names"]) if name in set_once and name in values
            }
            constants |= {name: values[name] for name in names}
        for name in _split_names(token["parameters"] or token["counters"] or token["declared"]):
            values.pop(name, None)
        if name := token["call"]:
            arguments = _split_arguments(text, token.end())
            yield DeviceCall(line, name, tuple(_argument(word, known) for word in arguments))


def _holds(condition: str, values: Mapping[str, float]) -> bool | None:
    """Whether a condition holds that compares names with numbers; None of any other."""
    parts = re.split(r"\bor\b", condition[:LONGEST_ARGUMENTS].translate(_NO_PARENTHESES))
    verdicts = list[bool | None]()
    for part in parts:
        comparison = _COMPARISON.fullmatch(part)
        number = _argument(comparison[2], values) if comparison else ""
        is_known = comparison and comparison[1] in values and isinstance(number, float)
        verdicts.append(values[comparison[1]] == number if comparison and is_known else None)
    return True if True in verdicts else None if None in verdicts else False


def _split_names(text: str | None) -> list[str]:
    return re.findall(r"\w+", text or "")


def _names_set_once(text: str) -> set[str]:
    """Find the names that one place of a script alone sets."""
    counts = Counter[str]()
    for token in _TOKEN.finditer(text):
        for group in ("names", "parameters", "counters", "declared"):
            counts.update(_split_names(token[group]))
    return {name for name, count in counts.items() if count == 1}


def _assign(token: re.Match[str], text: str, values: dict[str, float], is_sure: bool) -> None:
    """Set the names before `=` to the numbers behind it; a name of no sure number has no value."""
    names = _split_names(token["names"])
    expression = _EXPRESSION.match(text, token.end(), token.end() + LONGEST_ARGUMENTS)
    words = expression[0].split(",") if expression else []
    new = [_argument(word, values) for word in words] if len(words) == len(names) else []
    old = [values.pop(name, None) for name in names]
    values |= {
        name: value
        for name, value, before in zip(names, new, old, strict=False)
        if isinstance(value, float) and (is_sure or value == before)
    }


def _split_arguments(text: str, start: int) -> list[str]:
    """Split what stands in parentheses at its commas; parentheses within stay whole.

    Returns:
        Texts of the arguments; one that is no number where no parenthesis follows, or none closes.
    """
    opening = re.compile(r"\s{0,100}\(").match(text, start)
    if not opening:
        return ["a name of this call"]
    words, depth = [""], 0
    for character in text[opening.end() : opening.end() + LONGEST_ARGUMENTS]:
        if character == ")" and not depth:
            return words if any(word.strip() for word in words) else []
        depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(character, 0)
        if character == "," and not depth:
            words.append("")
        else:
            words[-1] += character
    return ["arguments without an end"]


def _argument(text: str, values: Mapping[str, float]) -> Argument:
    """Number that a text of Lua is; itself, on one line, where it is none."""
    try:
        tree = ast.parse(" ".join(text.replace("^", "**").split()), mode="eval")
        number = _evaluate(tree.body, values)
    except (ValueError, SyntaxError, KeyError, ArithmeticError, RecursionError, MemoryError):
        return " ".join(text.split())
    is_number = isinstance(number, float) and abs(number) < LARGEST
    return number if is_number else " ".join(text.split())


def _evaluate(tree: ast.expr, values: Mapping[str, float]) -> float:
    """Number of an expression of numbers, names and + - * / ^.

    Raises:
        KeyError: A name has no value.
        ValueError: Something else stands in it.
        ArithmeticError: The number has no bounds.
    """
    match tree:
        case ast.Constant(int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(name):
            return values[name]
        case ast.UnaryOp(operator, operand) if type(operator) in _OPERATIONS:
            return _OPERATIONS[type(operator)](_evaluate(operand, values))
        case ast.BinOp(left, operator, right) if type(operator) in _OPERATIONS:
            return _OPERATIONS[type(operator)](_evaluate(left, values), _evaluate(right, values))
    raise ValueError
