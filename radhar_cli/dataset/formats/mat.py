"""A MATLAB file of version 7.3: HDF5 with MATLAB's header, names of types and order of axes."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from radhar_cli.dataset.formats.arrays import arrays
from radhar_cli.dataset.formats.checked import describe
from radhar_cli.dataset.reading import Dataset
from radhar_cli.new_hdf5 import new_hdf5
from radhar_cli.progress import Progress

FILE = "dataset.mat"
USER_BLOCK = 512
# Text of 116 bytes, 8 of nothing, version 2.0, byte order.
HEADER = b"MATLAB 7.3 MAT-file, written by radhar".ljust(116) + bytes(8) + b"\x00\x02IM"
_COMPLEX = np.dtype([("real", "<f4"), ("imag", "<f4")])
_CLASS = "MATLAB_class"


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write dataset.mat: maps.<map> [H, W, N], label [1, N] and so on; the last axis is samples."""
    first, level = next(iter(data.large)), data.config.output.hdf5_level
    path = folder / FILE
    with new_hdf5(path, path, userblock_size=USER_BLOCK) as (file, check):
        for array in arrays(data):
            group, _, _ = array.name.rpartition("/")
            if group and group not in file:
                file.create_group(group).attrs[_CLASS] = np.bytes_("struct")
            kind, name = _stored_as(array.dtype)
            # What MATLAB calls [H, W, N] lies in HDF5 as [N, W, H], and [1, N] as [N, 1].
            shape = (array.shape[0], *(array.shape[:0:-1] or (1,)))
            large = array.name in data.large
            target = file.create_dataset(
                array.name,
                shape,
                kind,
                chunks=(1, *shape[1:]) if large else None,
                compression="gzip" if large and level else None,
                compression_opts=level if large and level else None,
            )
            target.attrs[_CLASS] = np.bytes_(name)
            start = 0
            for piece in array.pieces:
                stop = start + len(piece)
                target[start:stop] = _turned(piece, kind).reshape(-1, *shape[1:])
                check()
                progress.advance(len(piece) if array.name == first else 0)
                start = stop
        _texts(file, "class_slugs", data.class_slugs)
    with path.open("r+b") as raw:
        raw.write(HEADER)
    describe(data, folder, {}, _reading(data))


def _stored_as(dtype: np.dtype[Any]) -> tuple[np.dtype[Any], str]:
    """Type in the file, and MATLAB's name of it, which knows no half precision in files."""
    if dtype.kind == "c":
        return _COMPLEX, "single"
    names = {"u1": "uint8", "i8": "int64", "f2": "single", "f4": "single", "f8": "double"}
    name = names[dtype.str[1:]]
    return np.dtype("f4") if name == "single" else dtype, name


def _turned(piece: NDArray[Any], kind: np.dtype[Any]) -> NDArray[Any]:
    """Samples [rows, ...] with the axes after the first reversed."""
    axes = (0, *range(piece.ndim - 1, 0, -1))
    turned = np.ascontiguousarray(piece.transpose(axes))
    return turned.view(kind) if kind == _COMPLEX else turned.astype(kind, copy=False)


def _texts(file: h5py.File, name: str, texts: list[str]) -> None:
    """Store a cell array {K, 1} of texts: references to what lies in #refs#."""
    cells = file.create_dataset(name, (1, len(texts)), h5py.ref_dtype)
    cells.attrs[_CLASS] = np.bytes_("cell")
    for number, text in enumerate(texts):
        codes = np.array([[ord(c)] for c in text], np.uint16)
        one = file.create_dataset(f"#refs#/{number}", data=codes)
        one.attrs[_CLASS] = np.bytes_("char")
        one.attrs["MATLAB_int_decode"] = np.int32(2)
        cells[0, number] = one.ref


def _reading(data: Dataset) -> str:
    name, (height, width) = data.config.maps[0], data.config.image.size_px
    return f"""\
```
% uint8 [H, W] of sample n alone: data.maps below would read every map
image = h5read('dataset.mat', '/maps/{name}', [1 1 n], [{height} {width} 1]);
data = matfile('dataset.mat');
label = data.label;                       % uint8 [1, N]
slugs = data.class_slugs;                 % slugs{{label(n) + 1}}: the class
train = find(data.split == 0);            % 0 train, 1 validation, 2 test
```

The last axis counts samples, class after class. `scene.<column>` has the numbers of the samples,
NaN where one does not apply; `sample_key` [2, N] is label and index. h5py reads the file with the
axes of a sample reversed."""
