"""`radhar verify`: check that a data set is what its config and seed determine."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import counted, for_each_radar, report, tell


def verify(
    out: Annotated[Path, typer.Argument(help="Folder that `radhar generate` wrote.")],
    samples: Annotated[
        int, typer.Option(min=0, help="Number of samples to synthesise again.")
    ] = 24,
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            help="Folder of the motion files. Without it, samples that follow files are not "
            "synthesised again.",
        ),
    ] = None,
) -> None:
    """Check a data set, and synthesise some of its samples again.

    Compares checksums, labels and counts. The exit status is 0 if everything agrees, and 1 if
    something differs.

    Example:

      radhar verify datasets/quickstart --samples 24
    """
    from radhar_cli.dataset.radar_folders import folders_of_radars

    folders, wrong = folders_of_radars(out), list[str]()

    def verify_radar(name: str, folder: Path) -> None:
        if not _is_sound(folder, samples, motion):
            wrong.append(name)

    if len(folders) > 1:
        _refuse_unfinished([*folders.values()])
    for_each_radar(folders, verify_radar)
    if len(folders) > 1 and not wrong:
        wrong += _tell_of_other_scenes([*folders.values()])
    if wrong:
        raise typer.Exit(1)


def _refuse_unfinished(folders: list[Path]) -> None:
    """Refuse several radars of which some data set is not made yet; name the command for each.

    Raises:
        FolderError: there are such radars, a line for each.
    """
    from radhar_cli.dataset.layout import DATASET
    from radhar_cli.dataset.reading import why_missing
    from radhar_cli.errors import FolderError

    missing = [folder for folder in folders if not (folder / DATASET).exists()]
    if missing:
        raise FolderError("\n".join(f"{folder}: {why_missing(folder)}" for folder in missing))


def _tell_of_other_scenes(folders: list[Path]) -> list[str]:
    """Print whether the data sets of several radars are of the same scenes; return what differs."""
    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.dataset.same_scenes import differing_columns

    different = list[str]()
    with open_dataset(folders[0]) as first:
        for folder in folders[1:]:
            with open_dataset(folder) as other:
                different += [f"{folder}: {name}" for name in differing_columns(first, other)]
    for name in different:
        tell(f"WRONG {name} is not as in {folders[0]}: should be of the same people")
    if not different:
        tell(f"{len(folders)} radars: the same people, labels and splits in every sample")
    return different


def _is_sound(out: Path, samples: int, motion: Path | None) -> bool:
    """Verify the data set in a folder, print its faults, and return whether it has none."""
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.verify import verify as verify_folder

    with BarProgress() as bars:
        outcome = verify_folder(out, samples, motion, bars)
    report(**vars(outcome))
    if outcome.other_versions:
        tell("built with other versions, compared within one grey level:")
        for line in outcome.other_versions:
            tell(f"  {line}")
    for problem in outcome.problems[:20]:
        tell(f"WRONG {problem}")
    if len(outcome.problems) > 20:
        tell(f"... and {len(outcome.problems) - 20} more")
    if outcome.problems:
        return False
    within = f"within {outcome.worst_level} grey level"
    anew = f"synthesised again and equal {within if outcome.other_versions else 'byte for byte'}"
    tell(
        f"{out}: {counted(outcome.samples, 'sample')}; checksums, labels and counts correct; "
        + (f"{outcome.resynthesised} {anew}" if outcome.resynthesised else "none synthesised again")
        + (f"; {outcome.pngs} PNG files show the same" if outcome.pngs else "")
    )
    if outcome.unmade:
        tell(f"{outcome.unmade} samples use motion files; --motion FOLDER checks them, too")
    tell(_leak_in_words(out))
    return True


def _leak_in_words(out: Path) -> str:
    """Describe in a line the clues to the class besides the movement, and the command for more."""
    from radhar_cli.config.class_laws import laws_by_class
    from radhar_cli.config.data_set import Config
    from radhar_cli.dataset.audited import audit_folder, read_audit
    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.study.audit.cheap import most_telling_number
    from radhar_cli.study.audit.scene_numbers import sentences_on_cue

    command = f"radhar audit {out}"
    stored = read_audit(out)
    if stored is not None:
        leaks = [line for line in stored.lines if line.cure]
        count = f"{len(leaks)} of {len(stored.lines)} lines tell the class beyond chance"
        return "; ".join([f"audited: {count}", *stored.sentences, f"see {audit_folder(out)}"])
    with open_dataset(out) as data:
        telling, samples = most_telling_number(data), len(data)
        lines = laws_by_class(data.config) if isinstance(data.config, Config) else []
        lines += sentences_on_cue(data, data.label[:].astype(int)).on_cue
    if telling is not None and telling.number is not None:
        key, share, chance = telling.number
        name = key if " " not in key else "when it begins or ends"
        lines.append(
            f"{name} alone tells the class in {100 * share:.0f} % (chance {100 * chance:.0f})"
        )
    if lines:
        return f"{'; '.join(lines)}: {command}"
    none = ""
    if telling is not None and telling.is_enough:
        but = " but when the movement begins, which was not tried," if telling.has_onset else ""
        none = f"no scene number alone{but} was seen to tell the class in more than "
        none += f"{100 * telling.limit:.0f} %; "
    elif telling is not None:
        none = f"{samples} samples are too few to tell whether a scene number tells the class; "
    return f"{none}{command} says what else does, such as margins and noise of images"
