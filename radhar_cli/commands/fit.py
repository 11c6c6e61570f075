"""`radhar fit`: estimate a simulation config from recordings."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import report, tell


def fit(
    recordings: Annotated[
        list[Path],
        typer.Argument(help="Recordings of one radar, made by `import`; or data sets of clouds."),
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Config file to write, such as measured.yaml.")
    ],
    config: Annotated[
        Path | None,
        typer.Option(help="Of clouds: config of their board and room, such as boards/iwr1443."),
    ] = None,
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

    Of clouds, which need no labels, it estimates the noise figure at which people of --config have
    as many moving points, and where people are. What is written has that config as its base.

    Example:

      radhar fit datasets/own --config boards/iwr1443 -o own.yaml
    """
    from radhar_cli.capture import fitting
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.config.identity import yaml_text
    from radhar_cli.errors import FolderError
    from radhar_cli.files.replacing import write_text
    from radhar_cli.study import cloud_fit

    if out.resolve() in {path.resolve() for path in recordings}:
        raise FolderError(f"{out}: is one of the recordings; -o should name another file")
    if out.suffix == ".png":
        raise FolderError(f"{out}: .png is for the figure; -o should end in .yaml")
    refuse_to_replace(out, overwrite, "measured.yaml")
    if config is None:
        cloud_fit.ask_for_config(recordings[0])
        fitted: fitting.Fit | cloud_fit.CloudFit = fitting.fit(recordings, set_ or [])
    else:
        with BarProgress("scene") as progress:
            fitted = cloud_fit.fit_clouds(recordings, config, out, set_ or [], progress)
    numbers = fitted.numbers()
    for key, value in numbers.items():
        tell(f"  {key:<19} {value:.4g}")
    for note in fitted.notes:
        tell(f"warning: {note}", err=True)
    text = f"# Fitted to {fitted.source}.\n"
    out.parent.mkdir(parents=True, exist_ok=True)
    write_text(out, text + yaml_text(fitted.document))
    fitted.draw(out.with_suffix(".png"))
    report(files=[out, out.with_suffix(".png")], numbers=numbers, parts=int(numbers["parts"]))
