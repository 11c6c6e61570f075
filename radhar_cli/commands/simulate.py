"""`radhar simulate`: one scene with everything there is to see of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides, Tolerance, with_tolerance

if TYPE_CHECKING:
    from radhar_cli.simulation.simulate import Simulation


def simulate(
    config: Annotated[Path, typer.Argument(help="YAML file whose ranges are drawn from.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    activity: Annotated[
        str | None,
        typer.Option("--activity", "-a", help="Slug or label; not needed if the config has one."),
    ] = None,
    index: Annotated[
        int, typer.Option(min=0, help="Which sample of its class, as in /sample_key.")
    ] = 0,
    seed: Annotated[
        int | None, typer.Option(min=0, max=2**63 - 1, help="Instead of the config's.")
    ] = None,
    nominal: Annotated[
        bool, typer.Option("--nominal", help="Take mid-points instead of drawing.")
    ] = False,
    set_: Overrides = None,
    tolerance: Tolerance = None,
    engine: Annotated[
        str | None, typer.Option(help="cube or direct, instead of the config's.")
    ] = None,
    maps: Annotated[
        str | None, typer.Option(help="Comma-separated maps; all nine if not given.")
    ] = None,
    joint: Annotated[
        str | None, typer.Option(help="Keep this scatterer alone, such as right_ankle.")
    ] = None,
    overlay: Annotated[
        bool, typer.Option("--overlay", help="Draw every joint's true Doppler over the maps.")
    ] = False,
    raw: Annotated[
        bool, typer.Option("--raw", help="Store the beat matrix, static returns included.")
    ] = False,
    figures: Annotated[
        bool, typer.Option("--figures/--no-figures", help="Draw maps.png and the animation.")
    ] = True,
) -> None:
    """Simulate one scene: scene.h5, scene.json, maps.png and an animated stickman.

    Example:

      radhar simulate configs/paper/free_space.yaml --activity walking --seed 7 -o out/walk
    """
    from radhar_cli.config import load_config
    from radhar_cli.dataset.folder import refuse_file
    from radhar_cli.simulation.simulate import map_names
    from radhar_cli.simulation.simulate import simulate as simulate_scene

    overrides = [*with_tolerance(set_, tolerance), *([f"engine.kind={engine}"] if engine else [])]
    loaded = load_config(config, overrides)
    chosen = map_names(None if maps is None else maps.split(","))
    refuse_file(out)
    simulation = simulate_scene(
        loaded,
        activity,
        seed,
        index=index,
        nominal=nominal,
        joint=joint,
        maps=chosen,
        raw=raw,
    )
    for warning in simulation.warnings:
        typer.echo(f"warning: {warning}", err=True)

    from radhar_cli.simulation import scene_file

    written = scene_file.write_all(simulation, out)
    if figures:
        written += _draw(simulation, out, overlay)
    took = sum(simulation.seconds.values())
    typer.echo(
        f"{simulation.activity.label} {simulation.activity.slug}: synthesised in {took:.2f} s"
    )
    for path in written:
        typer.echo(f"  {path}")


def _draw(simulation: "Simulation", out: Path, overlay: bool) -> list[Path]:
    import sys

    from tqdm import tqdm

    from radhar_cli.figures import maps_panel, stickman

    maps = out / "maps.png"
    maps_panel.draw_maps(simulation, maps, overlay)
    animation = out / "stickman.gif"
    frames = stickman.frame_count(simulation)
    with tqdm(
        total=frames, desc=animation.name, unit="frame", disable=None, file=sys.stderr
    ) as bar:
        stickman.draw_stickman(simulation, animation, bar.update)
    return [maps, animation]
