"""Calls that a script of mmWave Studio would make, found by following its statements.

Nothing outside the script is reached: numbers, tables, conditions and loops are followed, calls of
the radar are written down and succeed, and all else (registers of a chip, files, the clock) is
unknown. Where a condition is unknown, all its blocks are followed apart; what they leave alike
holds, what they leave different is unknown.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from radhar_cli.capture.lua_syntax import (
    Assignment,
    Block,
    Branches,
    Break,
    CallOf,
    Constant,
    CountingLoop,
    EntryLoop,
    Expression,
    FunctionOf,
    Index,
    Loop,
    Name,
    Operation,
    Return,
    Scope,
    Statement,
    TableOf,
    Unread,
)
from radhar_cli.errors import CaptureError

MAX_STEPS = 100_000  # statements and expressions that are followed
MAX_TEXT = 1000
DEEPEST_CALL = 20
DEVICE = "ar1."


class Unknown(NamedTuple):
    """Value that only the radar, another file or the computer could tell.

    Attributes:
        path: Names of what it is, such as `os.getenv`; empty of what is computed.
        cause: What it depends on, for messages.
    """

    path: str
    cause: str


@dataclass(eq=False)
class Table:
    """Table of Lua, or the names of a block.

    Attributes:
        entries: Values by their keys.
        is_block: Whether keys are names of variables.
    """

    entries: dict["Value", "Value"] = field(default_factory=dict)
    is_block: bool = False


@dataclass(eq=False)
class Closure:
    """Function of the script, with the names that it sees."""

    function: FunctionOf
    scope: "Variables"


Value: TypeAlias = float | str | bool | Table | Closure | Unknown | None


class DeviceCall(NamedTuple):
    """Call of the radar.

    Attributes:
        line: Line of the script.
        name: Name after `ar1.`.
        arguments: Values of the arguments.
    """

    line: int
    name: str
    arguments: tuple[Value, ...]


@dataclass(eq=False)
class Variables:
    """Names of a block, and those around it."""

    outer: "Variables | None" = None
    values: Table = field(default_factory=lambda: Table(is_block=True))

    def enter(self, names: Mapping[str, "Value"]) -> "Variables":
        """Names of a block within this one, some of which have values."""
        return Variables(self, Table(dict[Value, Value](names.items()), is_block=True))

    def holder_of(self, name: str) -> Table:
        """Table that holds a name: the nearest, or that of the global names."""
        scope = self
        while name not in scope.values.entries and scope.outer is not None:
            scope = scope.outer
        return scope.values


class _Leave(Exception):
    """End of a loop, a function or the script."""

    def __init__(self, kind: str, values: Sequence[Value] = ()) -> None:
        self.kind, self.values = kind, list(values)


Entry: TypeAlias = tuple[Table, Value]


class Script:
    """A script that is followed, whose calls of the radar go to `record`.

    Args:
        where: its file, for messages.
        record: takes each call of the radar; it stores what it keeps by `write`.
    """

    def __init__(self, where: str, record: Callable[["Script", DeviceCall], None]) -> None:
        self.where, self.record = where, record
        self.steps = 0
        self.doubts: list[str] = []  # of each function that is entered: what its end depends on
        self.journal: list[tuple[Table, Value, bool, Value]] | None = None
        self.variables = Variables()

    def follow(self, block: Block) -> None:
        """Follow the statements of the script.

        Raises:
            CaptureError: it does not end within MAX_STEPS.
        """
        try:
            self._block(block, self.variables)
        except _Leave:
            return

    def write(self, table: Table, key: Value, value: Value) -> None:
        """Set an entry of a table, so that it can be taken back."""
        if self.journal is not None:
            self.journal.append((table, key, key in table.entries, table.entries.get(key)))
        table.entries.pop(key, None)
        table.entries[key] = value

    def _count_step(self) -> None:
        self.steps += 1
        if self.steps > MAX_STEPS:
            raise CaptureError(
                f"{self.where}: does not end within {MAX_STEPS} steps; should configure one capture"
            )

    # Statements.

    def _block(self, block: Block, scope: Variables) -> None:
        """Follow the statements of a block."""
        for statement in block:
            self._count_step()
            self._statement(statement, scope)

    def _statement(self, statement: Statement, scope: Variables) -> None:
        match statement:
            case Assignment():
                self._assign(statement, scope)
            case CallOf():
                self._call(statement, scope)
            case Branches():
                self._branches(statement, scope)
            case Loop():
                self._loop(statement, scope)
            case CountingLoop():
                self._count(statement, scope)
            case EntryLoop():
                self._over_entries(statement, scope)
            case Scope(body):
                self._block(body, Variables(scope))
            case Return(values):
                raise _Leave("return", self._values(values, scope))
            case Break():
                raise _Leave("break")

    def _assign(self, statement: Assignment, scope: Variables) -> None:
        values = self._values(statement.values, scope)
        values += [None] * (len(statement.targets) - len(values))
        for target, value in zip(statement.targets, values, strict=False):
            if isinstance(target, Name):
                new = Unknown("", target.name) if isinstance(value, Unknown) else value
                holder = scope.values if statement.is_local else scope.holder_of(target.name)
                self.write(holder, target.name, new)
                continue
            table, key = self._value(target.table, scope), self._value(target.key, scope)
            if isinstance(table, Table) and isinstance(key, float | str):
                self.write(table, key, value)

    def _branches(self, statement: Branches, scope: Variables) -> None:
        """Follow the block whose condition holds; all that could be where it is unknown."""
        blocks, cause = list[Block](), ""
        for condition, block in statement.arms:
            value = self._value(condition, scope)
            if isinstance(value, Unknown):
                blocks, cause = [*blocks, block], cause or value.cause
            elif value is not None and value is not False:
                blocks.append(block)
                break
        else:
            blocks.append(statement.otherwise)
        if len(blocks) == 1:
            self._block(blocks[0], Variables(scope))
        else:
            self._follow_apart(blocks, scope, cause)

    def _follow_apart(self, blocks: Iterable[Block], scope: Variables, cause: str) -> None:
        """Follow blocks from the same state; what they leave different becomes unknown."""
        outer, outcomes = self.journal, list[dict[tuple[int, Value], tuple[Table, Value, Value]]]()
        for block in blocks:
            self.journal, ends = [], False
            try:
                self._block(block, Variables(scope))
            except _Leave as leave:  # a script that ends there makes no capture
                ends = leave.kind == "error" or (leave.kind == "return" and not self.doubts)
                if leave.kind == "return" and self.doubts:
                    self.doubts[-1] = cause
            changes = {
                (id(table), key): (table, key, table.entries.get(key))
                for table, key, _, _ in self.journal
            }
            for table, key, is_old, old in reversed(self.journal):
                table.entries.pop(key, None)
                if is_old:
                    table.entries[key] = old
            if not ends:
                outcomes.append(changes)
        self.journal = outer
        if not outcomes:
            raise _Leave("error")
        for place in dict.fromkeys(place for changes in outcomes for place in changes):
            table, key, _ = next(changes[place] for changes in outcomes if place in changes)
            unchanged = table.entries.get(key)
            values = [changes[place][2] if place in changes else unchanged for changes in outcomes]
            alike = all(are_alike(value, values[0]) for value in values)
            name = str(key) if table.is_block else cause
            self.write(table, key, values[0] if alike else Unknown("", name))

    def _loop(self, statement: Loop, scope: Variables) -> None:
        """Follow a loop whose condition is known; the body of another once, apart."""
        while not statement.is_repeat or self._goes_on(statement.body, Variables(scope)):
            self._count_step()
            value = self._value(statement.condition, scope)
            if isinstance(value, Unknown):
                if not statement.is_repeat:
                    self._follow_apart([statement.body, ()], scope, value.cause)
                return
            holds = value is not None and value is not False
            if holds == statement.is_repeat:
                return
            if not statement.is_repeat and not self._goes_on(statement.body, Variables(scope)):
                return

    def _goes_on(self, body: Block, scope: Variables) -> bool:
        """Follow the body of a loop once; whether it ended without a break."""
        try:
            self._block(body, scope)
        except _Leave as leave:
            if leave.kind != "break":
                raise
            return False
        return True

    def _count(self, statement: CountingLoop, scope: Variables) -> None:
        """Follow a loop over numbers; the body once, apart, where its ends are unknown."""
        limits = [self._value(limit, scope) for limit in statement.limits] + [1.0]
        first, last, step = limits[:3]
        if not (isinstance(first, float) and isinstance(last, float) and isinstance(step, float)):
            self._each(statement.body, scope, [{statement.name: Unknown("", statement.name)}])
            return
        names, number = list[dict[str, Value]](), first
        while step and (last - number) * step >= 0:
            self._count_step()
            names.append({statement.name: number})
            number += step
        self._each(statement.body, scope, names)

    def _over_entries(self, statement: EntryLoop, scope: Variables) -> None:
        """Follow a loop over the entries of a table that is known."""
        values = self._values(statement.values, scope)
        table = values[0] if values else None
        if not isinstance(table, Table):
            cause = table.cause if isinstance(table, Unknown) else "a loop"
            inner = scope.enter({name: Unknown("", name) for name in statement.names})
            self._follow_apart([statement.body, ()], inner, cause)
            return
        pairs = [
            dict(zip(statement.names, pair, strict=False)) for pair in [*table.entries.items()]
        ]
        self._each(statement.body, scope, pairs)

    def _each(self, body: Block, scope: Variables, names: Iterable[dict[str, Value]]) -> None:
        """Follow a body once for each set of its names, up to a break."""
        for values in names:
            if not self._goes_on(body, scope.enter(values)):
                return

    # Expressions.

    def _values(self, expressions: Sequence[Expression], scope: Variables) -> list[Value]:
        """Values of expressions, of which a call that comes last may give several."""
        if not expressions:
            return []
        values = [self._value(expression, scope) for expression in expressions[:-1]]
        last = expressions[-1]
        if isinstance(last, CallOf):
            return values + self._call(last, scope)
        return [*values, self._value(last, scope)]

    def _value(self, expression: Expression, scope: Variables) -> Value:
        self._count_step()
        match expression:
            case Constant(value):
                return value
            case Name(name):
                variables = scope.holder_of(name).entries
                return variables[name] if name in variables else Unknown(name, name)
            case Index():
                return self._entry(expression, scope)
            case CallOf():
                values = self._call(expression, scope)
                return values[0] if values else None
            case Operation(operator, operands):
                return self._operate(operator, operands, scope)
            case TableOf():
                return self._table(expression, scope)
            case FunctionOf():
                return Closure(expression, scope)
            case Unread(text):
                return Unknown("", text)

    def _entry(self, expression: Index, scope: Variables) -> Value:
        table, key = self._value(expression.table, scope), self._value(expression.key, scope)
        if isinstance(table, Unknown):
            name = f"{table.path}.{key}" if table.path and isinstance(key, str) else ""
            return Unknown(name, name or table.cause)
        if isinstance(table, Table) and not isinstance(key, Unknown | Table | Closure):
            return table.entries.get(key)
        return Unknown("", key.cause if isinstance(key, Unknown) else "an entry of no table")

    def _table(self, expression: TableOf, scope: Variables) -> Table:
        table, place = Table(), 1.0
        for key, item in expression.entries:
            name: Value = place if key is None else self._value(key, scope)
            values = self._values([item], scope) if key is None else [self._value(item, scope)]
            if isinstance(name, Unknown | Table | Closure):
                continue
            for value in values[:1] if key is not None else values:
                table.entries[name] = value
                name = name + 1 if isinstance(name, float) else name
            place += len(values) * (key is None)
        return table

    def _operate(self, operator: str, operands: Sequence[Expression], scope: Variables) -> Value:
        """Value of an operation; `and` and `or` leave out what they need not."""
        left = self._value(operands[0], scope)
        if operator in ("and", "or"):
            if isinstance(left, Unknown):
                if left.path and operator == "or":  # a name that is set nowhere is nil
                    return self._value(operands[1], scope)
                self._value(operands[1], scope)
                return Unknown("", left.cause)
            holds = left is not None and left is not False
            return left if holds == (operator == "or") else self._value(operands[1], scope)
        values = [left, *(self._value(operand, scope) for operand in operands[1:])]
        unknown = next((value for value in values if isinstance(value, Unknown)), None)
        if unknown is not None:
            return Unknown("", unknown.cause)
        return _compute(operator, values)

    def _call(self, call: CallOf, scope: Variables) -> list[Value]:
        """Values of a call: a function of the script, of Lua, of the radar, or an unknown one."""
        self._count_step()
        function = self._value(call.function, scope)
        arguments = self._values(call.arguments, scope)
        if isinstance(function, Closure):
            return self._enter(function, arguments)
        path = function.path if isinstance(function, Unknown) else ""
        if path in ("error", "os.exit"):
            raise _Leave("error")
        known = _LUA.get(path)
        if known is not None:
            return known(arguments)
        self.record(self, DeviceCall(call.line, path.removeprefix(DEVICE), tuple(arguments)))
        cause = f"{path or 'a call'}(...)"
        return [0.0 if path.startswith(DEVICE) else Unknown("", cause), Unknown("", cause)]

    def _enter(self, closure: Closure, arguments: Sequence[Value]) -> list[Value]:
        """Follow a function of the script; return its values."""
        if len(self.doubts) >= DEEPEST_CALL:
            return [Unknown("", "a function that calls itself")]
        parameters = closure.function.parameters
        padded = [*arguments, *[None] * len(parameters)]
        names = dict(zip(parameters, padded, strict=False))
        self.doubts.append("")
        values = list[Value]()
        try:
            self._block(closure.function.body, closure.scope.enter(names))
        except _Leave as leave:
            if leave.kind == "error":
                raise
            values = leave.values
        finally:
            cause = self.doubts.pop()
        return [Unknown("", cause)] if cause else values


def are_alike(first: Value, second: Value, depth: int = 3) -> bool:
    """Whether two values are the same for what follows: tables, if all their entries are."""
    if isinstance(first, Table) and isinstance(second, Table):
        entries, others = first.entries, second.entries
        return first is second or (
            depth > 0
            and [*entries] == [*others]
            and all(are_alike(entries[key], others[key], depth - 1) for key in entries)
        )
    return type(first) is type(second) and first == second


def _compute(operator: str, values: Sequence[Value]) -> Value:
    """Value of an operation on known values; unknown where Lua would refuse them."""
    left, right = values[0], values[-1]
    if operator == "not":
        return left is None or left is False
    if operator in ("==", "~="):
        return are_alike(left, right) == (operator == "==")
    if operator == "#":
        size = len(left.entries) if isinstance(left, Table) else len(str(left))
        return float(size)
    if operator == "..":
        text = f"{left}{right}"
        return text if len(text) <= MAX_TEXT else Unknown("", "a long text")
    numbers = [_number_of(value) for value in values]
    a, b = numbers[0], numbers[-1]
    if a is None or b is None:
        return Unknown("", "a number that is none")
    try:
        return _ARITHMETIC[operator](a, b) if len(values) == 2 else -a
    except (ArithmeticError, ValueError, TypeError):
        return Unknown("", f"{a:g} {operator} {b:g}")


def _number_of(value: Value) -> float | None:
    """Number of a value, also of a text that is one."""
    if isinstance(value, bool) or not isinstance(value, float | str):
        return None
    try:
        return float(int(value, 16)) if str(value)[:2].lower() == "0x" else float(value)  # type: ignore[arg-type]
    except ValueError:
        return None


def _power(a: float, b: float) -> float:
    return float(math.pow(a, b))


_ARITHMETIC: dict[str, Callable[[float, float], float | bool]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "%": lambda a, b: a - math.floor(a / b) * b,
    "^": _power,
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}


def _of_numbers(name: str, compute: Callable[..., float]) -> Callable[[list[Value]], list[Value]]:
    """Function of Lua that takes numbers; unknown of anything else."""

    def call(arguments: list[Value]) -> list[Value]:
        numbers = [_number_of(value) for value in arguments]
        if not numbers or None in numbers:
            causes = [value.cause for value in arguments if isinstance(value, Unknown)]
            return [Unknown("", causes[0] if causes else f"{name}(...)")]
        try:
            return [float(compute(*numbers))]
        except (ArithmeticError, ValueError, TypeError):
            return [Unknown("", f"{name}(...)")]

    return call


def _unpack(arguments: list[Value]) -> list[Value]:
    """Entries 1, 2 ... of a table."""
    table = arguments[0] if arguments else None
    if not isinstance(table, Table):
        return [Unknown("", "unpack(...)")]
    count = next(n for n in range(1, len(table.entries) + 2) if float(n) not in table.entries)
    return [table.entries[float(n)] for n in range(1, count)]


def _list_in_order(arguments: list[Value]) -> list[Value]:
    """Table of the entries 1, 2 ... of a table, in their order."""
    values = _unpack(arguments)
    if arguments and isinstance(arguments[0], Table):
        return [Table({float(n): value for n, value in enumerate(values, 1)})]
    return values


# Functions of Lua, and those of TI's bitoperations.lua, by their names.
_LUA: dict[str, Callable[[list[Value]], list[Value]]] = {
    "tonumber": _of_numbers("tonumber", lambda x, *_: x),
    "assert": lambda arguments: arguments,
    "unpack": _unpack,
    "table.unpack": _unpack,
    "pairs": lambda arguments: arguments[:1],
    "ipairs": _list_in_order,
} | {
    name: _of_numbers(name, compute)
    for name, compute in dict[str, Callable[..., float]](
        {
            "math.floor": math.floor,
            "math.ceil": math.ceil,
            "math.abs": abs,
            "math.max": max,
            "math.min": min,
            "math.sqrt": math.sqrt,
            "math.pow": math.pow,
            "bit_and": lambda a, b: int(a) & int(b),
            "bit_or": lambda a, b: int(a) | int(b),
            "bit_lshift": lambda a, b: int(a) << min(int(b), 63),
            "bit_rshift": lambda a, b: int(a) >> int(b),
        }
    ).items()
}
