"""`radhar motion`: how somebody moves in one scene, as a BVH file."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import (
    Activity,
    Nominal,
    Overrides,
    Replace,
    find_activity,
    refuse_to_replace,
)
from radhar_cli.commands.tell import report, tell


def motion(
    config: Annotated[Path, typer.Argument(help="YAML config that the scene is drawn from.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="BVH file to write, such as walk.bvh.")],
    activity: Activity = None,
    index: Annotated[
        int, typer.Option(min=0, help="Number of the sample within its class, from 0.")
    ] = 0,
    nominal: Nominal = False,
    rate: Annotated[float, typer.Option(min=1, max=10_000, help="Frames per second.")] = 120.0,
    overwrite: Replace = False,
    set_: Overrides = None,
) -> None:
    """Write the motion of a scene as a BVH file, as Blender reads it.

    The y axis points up, lengths are in cm, and joints have Mixamo's names.

    Example:

      radhar motion human/free_space_77GHz --activity walking -o walk.bvh
    """
    from radhar_cli.config.reading import load_radars
    from radhar_cli.errors import ConfigError, UnfinishedError
    from radhar_cli.files.replacing import write_text
    from radhar_cli.scene.single.motion_file import scene_bvh

    if out.suffix.lower() != ".bvh":
        raise ConfigError(f"{out}: should end in .bvh")
    refuse_to_replace(out, overwrite, "walk.bvh")
    loaded = next(iter(load_radars(config, set_ or []).values()))  # people are alike for all
    person_activity = find_activity(activity, loaded)
    text, frames = scene_bvh(loaded, person_activity, index=index, nominal=nominal, rate=rate)
    try:
        write_text(out, text)
    except OSError as error:
        raise UnfinishedError(f"{out}: {error.strerror}; nothing was written") from None
    report(file=out, frames=frames, rate_hz=rate)
    tell(f"{out}: {frames} frames, {rate:g} per second")
