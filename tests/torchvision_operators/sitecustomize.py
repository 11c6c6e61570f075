"""Declare the compiled operators of torchvision that a CPU build of PyTorch cannot load.

timm imports torchvision, which refuses to load without them; none of timm's classifiers calls
them. Put this folder on PYTHONPATH where the installed torchvision was built for another PyTorch.
"""

import importlib.util
import sys

libraries = []


class _DeclareFirst:
    """Declares the operators when torchvision is about to be imported, and not before."""

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        if name == "torchvision":
            sys.meta_path.remove(self)
            import torch

            library = torch.library.Library("torchvision", "DEF")
            for name in ("nms", "qnms"):
                library.define(f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
            libraries.append(library)  # it forgets its operators when it is let go
            return importlib.util.find_spec("torchvision")
        return None


sys.meta_path.insert(0, _DeclareFirst())
