"""Write the tables of docs/reference/ti_commands.md: TI's commands, and what comes of real files.

    python scripts/ti_command_table.py

The table of commands is the parser's. It stands between `<!-- commands -->` and `<!-- end -->`,
that of files between `<!-- files -->` and `<!-- end of files -->`; the rest is written by hand.
"""

from collections.abc import Iterator
from pathlib import Path

from page_parts import replace_part

from radhar_cli.config.radar import BoardRadar
from radhar_cli.errors import CaptureError
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg
from radhar_cli.readers.ti.ti_commands import COMMANDS, Argument, Command, Effect
from radhar_cli.scene.radar import board_of

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/reference/ti_commands.md"
BOARDS = {  # that the files of tests/radar/cfg run on
    "people_isk_bpm": "IWR6843ISK",
    "chirp_range": "IWR1443BOOST",
    "two_profiles": "IWR1443BOOST",
    "advframe": "IWR1443BOOST",
    "iwr1642_pc": "IWR1642BOOST",
    "level_1tx1rx": "IWR1443BOOST",
    "xwrl6432": "IWRL6432BOOST",
}


def fill_table(page: str) -> str:
    """Return a page with its tables as the parser has them."""
    files = "\n".join(_rows_of_files())
    page = replace_part(page, "files", files, "<!-- files -->", "<!-- end of files -->")
    table = "\n".join(_sections())
    return replace_part(page, "commands", table, "<!-- commands -->", "<!-- end -->")


def _rows_of_files() -> Iterator[str]:
    """Lines of the table of files."""
    yield "| file, device | software | chain | frames | /cube | /range_doppler |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for name, device in BOARDS.items():
        text = (ROOT / f"tests/radar/cfg/{name}.cfg").read_text()
        try:
            header = parse_ti_cfg(text, f"{name}.cfg", device)
        except CaptureError as error:
            yield f"| {name}, {device} | refused: `{error}` | | | | |"
            continue
        chain, period_ms = header.firmware or "best, said", header.timing.period_s * 1e3
        cubes, maps = zip(*_shapes(text, device, header.timing.subframes), strict=True)
        software = header.family.value
        yield (
            f"| {name}, {device} | {software if software != 'all' else 'any'} | {chain} "
            f"| {period_ms:g} ms | {'; '.join(cubes)} | {'; '.join(maps)} |"
        )


def _shapes(text: str, device: str, subframes: int) -> Iterator[tuple[str, str]]:
    """Shapes of the cube and of the range-Doppler maps of each subframe of a file."""
    for subframe in range(subframes):
        numbers = {"cfg": text, "device": device, "subframe": subframe}
        board = board_of(BoardRadar[float].model_validate(numbers))
        end = f"_sf{subframe}: " if subframe else ""
        cube = f"[f, {board.loops}, {board.channels}, {board.samples}]"
        yield f"{end}{cube}", f"{end}[f, {board.n_bins}, {board.n_doppler}]"


def _sections() -> Iterator[str]:
    """Lines of a table for each effect."""
    commands = [command for family in COMMANDS.values() for command in family]
    for effect in Effect:
        yield from ("", f"**{effect.value[0].upper()}{effect.value[1:]}:**", "")
        of_effect = [command for command in commands if command.effect is effect]
        detailed = [command for command in of_effect if command.arguments or command.reason]
        if detailed:
            yield from ("| command | software | right |", "| --- | --- | --- |")
            yield from map(_row, detailed)
            yield ""
        names = [f"`{command.name}`" for command in of_effect if command not in detailed]
        if names:
            yield ", ".join(names) + "."


def _row(command: Command) -> str:
    """Row of a command, with the arguments whose limits say more than that they are numbers."""
    limits = "; ".join(
        f"{argument.name}: {argument.right}" for argument in command.arguments if _says(argument)
    )
    return f"| `{command.usage}` | {command.family.value} | {command.reason or limits} |"


def _says(argument: Argument) -> bool:
    """Whether the limits of an argument are more than those of all numbers."""
    return bool(argument.meaning) or argument.high < 2**16 or argument.low > 0


def main() -> None:
    """Write the page."""
    PAGE.write_text(fill_table(PAGE.read_text()))


if __name__ == "__main__":
    main()
