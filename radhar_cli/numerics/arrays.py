"""Names for the array types that appear in signatures."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Float: TypeAlias = NDArray[np.floating[Any]]
Complex: TypeAlias = NDArray[np.complex128]
Bool: TypeAlias = NDArray[np.bool_]
Index: TypeAlias = NDArray[np.intp]
Half: TypeAlias = NDArray[np.float16]
Levels: TypeAlias = NDArray[np.uint8]
