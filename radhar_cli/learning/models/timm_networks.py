"""Networks of timm, the paper's rivals among them; needs the extra `zoo`."""

import importlib
import sys
from typing import Any

from torch import nn
from torch.library import Library

from radhar_cli.errors import ModelError, did_you_mean, how_to_install
from radhar_cli.learning.registry import NETWORKS, sequences_of

_OPERATORS: Any = Library("torchvision", "FRAGMENT")  # type: ignore[no-untyped-call]  # forgets what it defines when it is let go


def build_zoo_model(name: str, classes: int, size: tuple[int, int]) -> nn.Module:
    """Build a network of timm with fresh weights.

    Args:
        name: name of the network in timm.
        classes: number of outputs.
        size: (H, W) of the images.

    Raises:
        ModelError: no such network, timm is not installed, or it cannot take images of that size.
    """
    of_images = [ours for ours in NETWORKS if sequences_of(ours) is None]
    suggestion = did_you_mean(name, of_images, "")
    if suggestion:
        raise ModelError(f"model {name!r}: is unknown; {suggestion}")
    try:
        timm = load_timm()
    except ImportError as error:
        raise ModelError(
            f"model {name!r}: is neither {' nor '.join(of_images)}, and timm, which has others, is "
            f"not installed ({error}): {how_to_install('timm')}"
        ) from None
    except RuntimeError as error:
        raise ModelError(
            f"model {name!r}: timm does not load ({error}); torchvision should be built for the "
            "installed PyTorch"
        ) from None
    if not timm.is_model(name):
        hint = did_you_mean(
            name, (*NETWORKS, *timm.list_models()), "timm.list_models() has them all"
        )
        raise ModelError(
            f"model {name!r}: is none of {', '.join(of_images)} nor a name of timm's; {hint}"
        )
    create: Any = timm.create_model
    try:
        try:
            model: nn.Module = create(name, num_classes=classes, img_size=size)
        except TypeError:
            model = create(name, num_classes=classes)
    except (AssertionError, RuntimeError, ValueError) as error:
        raise ModelError(
            f"model {name!r}: cannot take images of {size[0]} x {size[1]} px ({error})"
        ) from None
    return model


def load_timm() -> Any:
    """Module timm, which imports torchvision.

    torchvision refuses to load where its operators were compiled for another PyTorch (there is no
    CPU build beside ours). No classifier calls them, so they are declared and it is loaded again.
    """
    try:
        return importlib.import_module("timm")
    except RuntimeError as error:
        if "operator torchvision::" not in str(error):
            raise
    for name in [name for name in sys.modules if name.partition(".")[0] in ("timm", "torchvision")]:
        del sys.modules[name]
    for name in ("nms", "qnms"):
        _OPERATORS.define(f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
    return importlib.import_module("timm")
