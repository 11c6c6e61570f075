"""`radhar fit`: estimate a simulation config from recordings."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import report, tell


def fit(
    recordings: Annotated[
        list[Path], typer.Argument(help="Recordings of one radar, made by `import`.")
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Config file to write, such as measured.yaml.")
    ],
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Key of the config, such as radar.array.rx; may be repeated.",
        ),
    ] = None,
    overwrite: Replace = False,
) -> None:
    """Estimate a config from recordings: radar, SNR and ranges.

    Frames, array and kind of samples are kept; --set says where receivers stand, if nothing does.
    Prints the noise floor, and draws it with the SNRs in a .png file beside the config.

    Example:

      radhar fit walk.h5 fall.h5 -o measured.yaml
    """
    from radhar_cli.capture.fitting import draw
    from radhar_cli.capture.fitting import fit as fit_recordings
    from radhar_cli.config.identity import yaml_text
    from radhar_cli.errors import FolderError
    from radhar_cli.files.replacing import write_text

    if out.resolve() in {path.resolve() for path in recordings}:
        raise FolderError(f"{out}: is one of the recordings; -o should name another file")
    if out.suffix == ".png":
        raise FolderError(f"{out}: .png is for the figure; -o should end in .yaml")
    refuse_to_replace(out, overwrite, "measured.yaml")
    fitted = fit_recordings(recordings, set_ or [])
    for key, value in fitted.numbers().items():
        tell(f"  {key:<19} {value:.4g}")
    for note in (fitted.remark, fitted.doubt):
        if note is not None:
            tell(f"warning: {note}", err=True)
    text = f"# Fitted to {len(fitted.parts)} parts of recordings.\n"
    out.parent.mkdir(parents=True, exist_ok=True)
    write_text(out, text + yaml_text(fitted.document))
    draw(fitted, out.with_suffix(".png"))
    report(files=[out, out.with_suffix(".png")], numbers=fitted.numbers(), parts=len(fitted.parts))
