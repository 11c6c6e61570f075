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
    overwrite: Replace = False,
) -> None:
    """Estimate a config from recordings: waveform, SNR and ranges.

    Prints the noise floor, and draws it with the SNRs in a .png file beside the config.

    Example:

      radhar fit walk.h5 fall.h5 -o measured.yaml
    """
    import json

    from radhar_cli.capture.fitting import draw, refuse_frames_and_receivers
    from radhar_cli.capture.fitting import fit as fit_recordings
    from radhar_cli.errors import FolderError
    from radhar_cli.files.replacing import write_text

    if out.resolve() in {path.resolve() for path in recordings}:
        raise FolderError(f"{out}: is one of the recordings; -o should name another file")
    if out.suffix == ".png":
        raise FolderError(f"{out}: .png is for the figure; -o should end in .yaml")
    refuse_to_replace(out, overwrite, "measured.yaml")
    for path in recordings:
        refuse_frames_and_receivers(path)
    fitted = fit_recordings(recordings)
    for key, value in fitted.numbers().items():
        tell(f"  {key:<19} {value:.4g}")
    text = f"# Fitted to {len(fitted.parts)} parts of recordings.\n"
    lines = [f"{key}: {json.dumps(value)}" for key, value in fitted.document.items()]
    out.parent.mkdir(parents=True, exist_ok=True)
    write_text(out, text + "\n".join(lines) + "\n")
    draw(fitted, out.with_suffix(".png"))
    report(files=[out, out.with_suffix(".png")], numbers=fitted.numbers(), parts=len(fitted.parts))
