"""`radhar models`: the networks one can train."""

from typing import Annotated

import typer

from radhar_cli.commands.tell import report, tell


def models(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names; ours and the paper's rivals if none.")
    ] = None,
    size: Annotated[int, typer.Option(min=32, help="Side of the images in pixels.")] = 256,
    classes: Annotated[int, typer.Option(min=2, help="Number of classes.")] = 12,
) -> None:
    """List networks with their parameters and multiply-adds.

    Example:

      radhar models --size 128

    fftnet is the paper's network, smallnet a plain one that learns in seconds, smallnet_bn the same
    with batch norm, which `radhar adapt` gains more by; every other name is one of timm's
    (pip install 'radhar[zoo]'). framenet and cloudnet learn sequences of boards.
    """
    from radhar_cli.commands.learning_options import needs_torch

    needs_torch()
    from radhar_cli.errors import ModelError
    from radhar_cli.learning.models.build import RIVALS, cost
    from radhar_cli.learning.models.zoo import OURS

    tell(f"{'model':<24} {'parameters':>12} {'multiply-adds':>14}   at {size} x {size} px")
    for name in names or [*OURS, *RIVALS]:
        try:
            price = cost(name, classes, (size, size))
        except ModelError as error:
            if names or name in OURS:
                raise
            tell(f"the paper's rivals ({', '.join(RIVALS)}) cannot be built: {error}")
            break
        work = f"{price.multiply_adds / 1e9:.3f} G"
        report(
            model=name,
            parameters=price.parameters,
            multiply_adds=price.multiply_adds,
            size_px=size,
            classes=classes,
        )
        tell(f"{name:<24} {price.parameters:>12,} {work:>14}")
