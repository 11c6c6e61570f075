"""A .npy file an array, in folders named as in dataset.h5."""

from pathlib import Path

import numpy as np

from radhar_cli.dataset.formats.arrays import arrays
from radhar_cli.dataset.formats.checked import describe
from radhar_cli.dataset.reading import Dataset
from radhar_cli.progress import Progress

CLASSES = "class_slugs.npy"


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <name>.npy of every array, row by row, and the names of the labels."""
    first = next(iter(data.large))
    for array in arrays(data):
        path = folder / f"{array.name}.npy"
        path.parent.mkdir(exist_ok=True)
        with path.open("wb") as file:
            header = {
                "descr": np.lib.format.dtype_to_descr(array.dtype),
                "fortran_order": False,
                "shape": array.shape,
            }
            np.lib.format.write_array_header_1_0(file, header)
            for piece in array.pieces:
                file.write(np.ascontiguousarray(piece).tobytes())
                progress.advance(len(piece) if array.name == first else 0)
    np.save(folder / CLASSES, np.array(data.class_slugs))
    describe(data, folder, {}, _reading(data))


def _reading(data: Dataset) -> str:
    name = data.config.maps[0]
    return f"""\
```python
import numpy

levels = numpy.load("maps/{name}.npy", mmap_mode="r")     # uint8 [N, H, W], grey levels
label = numpy.load("label.npy")                           # numbers into class_slugs.npy
train = numpy.flatnonzero(numpy.load("split.npy") == 0)   # 0 train, 1 validation, 2 test
```

`scene/<column>.npy` has the numbers of the samples, NaN where one does not apply; `sample_key.npy`
[N, 2] is label and index. A row is the same sample in all files, class after class."""
