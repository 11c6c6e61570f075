"""Syntax of Lua 5.1 as scripts of mmWave Studio use it: text becomes statements and expressions.

Source: R. Ierusalimschy, L. H. de Figueiredo, W. Celes, "Lua 5.1 Reference Manual", sections 2.1
(lexical conventions) and 2.4 to 2.6 (statements, expressions, precedence).
"""

import re
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from radhar_cli.errors import CaptureError

DEEPEST = 60  # expressions and blocks within each other
KEYWORDS = {
    "and", "break", "do", "else", "elseif", "end", "false", "for", "function", "goto", "if", "in",
    "local", "nil", "not", "or", "repeat", "return", "then", "true", "until", "while",
}  # fmt: skip
# Left and right binding power of operators (manual, 2.5.6); the right one is lower where they
# associate to the right.
BINARY = {
    "or": (1, 2), "and": (3, 4),
    "<": (5, 6), ">": (5, 6), "<=": (5, 6), ">=": (5, 6), "~=": (5, 6), "==": (5, 6),
    "..": (10, 9), "+": (11, 12), "-": (11, 12), "*": (13, 14), "/": (13, 14), "%": (13, 14),
    "^": (18, 17),
}  # fmt: skip
UNARY = {"not", "-", "#"}
UNARY_POWER = 15
_TOKEN = re.compile(
    r"""(?P<space>\s+|--\[(?P<level>=*)\[.*?\](?P=level)\]|--[^\n]*)
    |(?P<number>0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)
    |(?P<name>[A-Za-z_]\w*)
    |(?P<text>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\[(?P<depth>=*)\[.*?\](?P=depth)\])
    |(?P<mark>\.\.\.|\.\.|==|~=|<=|>=|::|[-+*/%^\#<>=(){}\[\];:,.])""",
    re.DOTALL | re.VERBOSE,
)


class Token(NamedTuple):
    """Word of a script."""

    kind: str  # number, name, text, mark, or the keyword itself; "" of the end
    text: str
    line: int


class Constant(NamedTuple):
    """Number, text, truth value or nil."""

    value: float | str | bool | None


class Name(NamedTuple):
    """Name of a variable."""

    name: str


class Index(NamedTuple):
    """Entry of a table."""

    table: "Expression"
    key: "Expression"


class CallOf(NamedTuple):
    """Call of a function."""

    function: "Expression"
    arguments: "tuple[Expression, ...]"
    line: int


class Operation(NamedTuple):
    """Operator with one operand or two."""

    operator: str
    operands: "tuple[Expression, ...]"


class TableOf(NamedTuple):
    """Constructor of a table; entries without a key have None there."""

    entries: "tuple[tuple[Expression | None, Expression], ...]"


class FunctionOf(NamedTuple):
    """Body of a function."""

    parameters: tuple[str, ...]
    body: "Block"


class Unread(NamedTuple):
    """Expression whose value is not needed, such as the arguments of a function by `...`."""

    text: str


class Assignment(NamedTuple):
    """Assignment of values to variables or entries of tables."""

    targets: "tuple[Name | Index, ...]"
    values: "tuple[Expression, ...]"
    is_local: bool


class Branches(NamedTuple):
    """Conditions with their blocks, and the block where none holds."""

    arms: "tuple[tuple[Expression, Block], ...]"
    otherwise: "Block"
    line: int


class Loop(NamedTuple):
    """Loop while a condition holds; `repeat` runs before the first test, until it holds."""

    condition: "Expression"
    body: "Block"
    is_repeat: bool


class CountingLoop(NamedTuple):
    """Loop over numbers from first to last."""

    name: str
    limits: "tuple[Expression, ...]"  # first, last, and a step
    body: "Block"


class EntryLoop(NamedTuple):
    """Loop over the entries of a table."""

    names: tuple[str, ...]
    values: "tuple[Expression, ...]"
    body: "Block"


class Return(NamedTuple):
    """End of a function, with its values."""

    values: "tuple[Expression, ...]"


class Break(NamedTuple):
    """End of a loop."""


class Scope(NamedTuple):
    """Block of its own, `do ... end`."""

    body: "Block"


Expression: TypeAlias = Constant | Name | Index | CallOf | Operation | TableOf | FunctionOf | Unread
Statement: TypeAlias = (
    Assignment | Branches | Loop | CountingLoop | EntryLoop | Return | Break | Scope | CallOf
)
Block: TypeAlias = tuple[Statement, ...]


def parse_lua(text: str, where: str) -> Block:
    """Parse a script.

    Args:
        text: the script.
        where: its file, for messages.

    Raises:
        CaptureError: it is no Lua; names file and line.
    """
    parser = _Parser(_tokens(text, where), where)
    block = parser.block()
    if parser.token.kind:
        raise parser.refusal("the end of the file")
    return block


def _tokens(text: str, where: str) -> list[Token]:
    """Words of a script, without blanks and comments, and one for its end."""
    tokens, place, line = list[Token](), 0, 1
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise CaptureError(f"{where}:{line}: {text[place : place + 20]!r}: is no Lua")
        kind = next(k for k in ("space", "number", "name", "text", "mark") if match[k] is not None)
        if kind != "space":
            word = match[0]
            tokens.append(Token(word if word in KEYWORDS else kind, word, line))
        line += match[0].count("\n")
        place = match.end()
    return [*tokens, Token("", "the end of the file", line)]


class _Parser:
    """Recursive descent over the words of a script."""

    def __init__(self, tokens: Sequence[Token], where: str) -> None:
        self.tokens, self.where, self.place, self.depth = tokens, where, 0, 0

    @property
    def token(self) -> Token:
        """Next word."""
        return self.tokens[self.place]

    def refusal(self, expected: str) -> CaptureError:
        """Error that says what should stand in the place of the next word."""
        token = self.token
        return CaptureError(
            f"{self.where}:{token.line}: {token.text[:40]}: should be {expected}, as in Lua"
        )

    def take(self) -> Token:
        """Take the next word."""
        token = self.token
        self.place += bool(token.kind)
        return token

    def takes(self, *texts: str) -> bool:
        """Take the next word if it is one of these; say whether."""
        is_taken = self.token.text in texts and self.token.kind not in ("text", "")
        if is_taken:
            self.take()
        return is_taken

    def expect(self, text: str) -> None:
        """Take a word that has to follow."""
        if not self.takes(text):
            raise self.refusal(repr(text))

    def name(self) -> str:
        """Take a name."""
        if self.token.kind != "name":
            raise self.refusal("a name")
        return self.take().text

    def block(self) -> Block:
        """Parse statements up to the end of a block."""
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.refusal(f"nested {DEEPEST}-fold at most")
        statements = list[Statement]()
        while self.token.kind not in ("", "end", "else", "elseif", "until"):
            if not self.takes(";"):
                statements += self.statement()
        self.depth -= 1
        return tuple(statements)

    def body(self) -> Block:
        """Parse a block that ends with `end`."""
        block = self.block()
        self.expect("end")
        return block

    def statement(self) -> tuple[Statement, ...]:
        """Parse a statement."""
        match self.token.kind:
            case "if":
                return (self.branches(),)
            case "for":
                return (self.counting(),)
            case "while" | "repeat":
                return (self.loop(),)
            case "local" | "function":
                return (self.definition(),)
            case "do":
                self.take()
                return (Scope(self.body()),)
            case "return":
                self.take()
                ends = self.token.text in (";", "end", "else", "elseif", "until")
                return (Return(() if ends or not self.token.kind else self.expressions()),)
            case "break":
                self.take()
                return (Break(),)
            case _:
                return (self.assignment(),)

    def branches(self) -> Branches:
        """Parse `if`."""
        line, arms, otherwise = self.token.line, list[tuple[Expression, Block]](), Block()
        while self.takes("if", "elseif"):
            condition = self.expression()
            self.expect("then")
            arms.append((condition, self.block()))
        if self.takes("else"):
            otherwise = self.block()
        self.expect("end")
        return Branches(tuple(arms), otherwise, line)

    def counting(self) -> CountingLoop | EntryLoop:
        """Parse `for`."""
        self.take()
        names = [self.name()]
        if self.takes("="):
            limits = self.expressions()
            self.expect("do")
            return CountingLoop(names[0], limits, self.body())
        while self.takes(","):
            names.append(self.name())
        self.expect("in")
        values = self.expressions()
        self.expect("do")
        return EntryLoop(tuple(names), values, self.body())

    def loop(self) -> Loop:
        """Parse `while` and `repeat`."""
        if self.take().kind == "while":
            condition = self.expression()
            self.expect("do")
            return Loop(condition, self.body(), is_repeat=False)
        block = self.block()
        self.expect("until")
        return Loop(self.expression(), block, is_repeat=True)

    def definition(self) -> Assignment:
        """Parse `local` and `function`."""
        is_local = self.takes("local")
        if self.takes("function"):
            target: Name | Index = Name(self.name())
            while self.token.text in (".", ":"):
                self.take()
                target = Index(target, Constant(self.name()))
            return Assignment((target,), (self.function(),), is_local)
        targets = [Name(self.name())]
        while self.takes(","):
            targets.append(Name(self.name()))
        values = self.expressions() if self.takes("=") else ()
        return Assignment(tuple(targets), values, is_local=True)

    def assignment(self) -> Assignment | CallOf:
        """Parse a call, or an assignment."""
        first = self.suffixed()
        if isinstance(first, CallOf) and self.token.text not in ("=", ","):
            return first
        targets = [first]
        while self.takes(","):
            targets.append(self.suffixed())
        self.expect("=")
        variables = [target for target in targets if isinstance(target, Name | Index)]
        if len(variables) < len(targets):
            raise self.refusal("an assignment to a name")
        return Assignment(tuple(variables), self.expressions(), is_local=False)

    def expressions(self) -> tuple[Expression, ...]:
        """Parse expressions with commas between."""
        values = [self.expression()]
        while self.takes(","):
            values.append(self.expression())
        return tuple(values)

    def expression(self, least: int = 0) -> Expression:
        """Parse an expression of operators that bind at least so tightly."""
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.refusal(f"nested {DEEPEST}-fold at most")
        left: Expression
        if self.token.kind not in ("text", "") and self.token.text in UNARY:
            operator = self.take().text
            left = Operation(operator, (self.expression(UNARY_POWER),))
        else:
            left = self.simple()
        while self.token.kind != "text" and self.token.text in BINARY:
            left_power, right_power = BINARY[self.token.text]
            if left_power < least:
                break
            operator = self.take().text
            left = Operation(operator, (left, self.expression(right_power)))
        self.depth -= 1
        return left

    def simple(self) -> Expression:
        """Parse an expression without operators."""
        match self.token:
            case Token("number", text):
                self.take()
                return Constant(float(int(text, 16)) if text[:2] in ("0x", "0X") else float(text))
            case Token("text", text):
                self.take()
                return Constant(_content_of(text))
            case Token("true" | "false" | "nil" as word):
                self.take()
                return Constant({"true": True, "false": False}.get(word))
            case Token("function"):
                self.take()
                return self.function()
            case Token("mark", "..."):
                return Unread(self.take().text)
            case Token("mark", "{"):
                return self.table()
        return self.suffixed()

    def suffixed(self) -> Expression:
        """Parse a name or an expression in brackets, with what is called or looked up in it."""
        if self.takes("("):
            value = self.expression()
            self.expect(")")
        else:
            value = Name(self.name())
        while True:
            line, text, kind = self.token.line, self.token.text, self.token.kind
            if kind == "text" or text == "{":
                value = CallOf(value, (self.simple(),), line)
            elif self.takes("."):
                value = Index(value, Constant(self.name()))
            elif self.takes("["):
                value = Index(value, self.expression())
                self.expect("]")
            elif self.takes(":"):
                value = Index(value, Constant(self.name()))
            elif self.takes("("):
                arguments = () if self.token.text == ")" else self.expressions()
                self.expect(")")
                value = CallOf(value, arguments, line)
            else:
                return value

    def function(self) -> FunctionOf:
        """Parse parameters and body of a function."""
        self.expect("(")
        parameters = list[str]()
        while not self.takes(")"):
            parameters.append(self.take().text)
            if not self.takes(",") and self.token.text != ")":
                raise self.refusal("')'")
        return FunctionOf(tuple(parameters), self.body())

    def table(self) -> TableOf:
        """Parse the constructor of a table."""
        self.expect("{")
        entries = list[tuple[Expression | None, Expression]]()
        while not self.takes("}"):
            key: Expression | None = None
            if self.takes("["):
                key = self.expression()
                self.expect("]")
                self.expect("=")
            elif self.token.kind == "name" and self.tokens[self.place + 1].text == "=":
                key = Constant(self.name())
                self.expect("=")
            entries.append((key, self.expression()))
            if not self.takes(",", ";") and self.token.text != "}":
                raise self.refusal("'}'")
        return TableOf(tuple(entries))


def _content_of(text: str) -> str:
    """Content of a text with its quotes; escapes stay as they are, as no value needs them."""
    if text[0] == "[":
        return text[text.index("[", 1) + 1 : text.rindex("]", 0, -1)]
    return text[1:-1]
