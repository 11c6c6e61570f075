"""Names of joints without prefix, case and punctuation: `mixamorig:RightArm` is `rightarm`."""

import re
from collections.abc import Sequence
from itertools import takewhile

FEWEST = 8  # joints whose names may have a beginning in common that is no part of them
END_SITE = ".end"  # of the names that ends of bones without one have in a BVH
_PREFIX = re.compile(
    r"^(?:.*:|bip\d+|j_bip_(?:c_)?|c_|mixamorig\d*|(?:k4abt_|xr_body_|xr_full_body_)?joint(?:type)?_(?:fb_|meta_)?)"
)
_PARTS = (
    "hip knee ankle foot shoulder elbow wrist hand eye ear bigtoe smalltoe toe heel collar clavicle"
).replace(" ", "|")
_SIDED = (
    re.compile(r"^(?P<side>left|right)(?P<part>.+)$"),
    re.compile(r"^(?P<part>.+)(?P<side>left|right)$"),
    re.compile(rf"^(?P<side>[lr])(?P<part>{_PARTS})$"),
    re.compile(rf"^(?P<part>{_PARTS})(?P<side>[lr])$"),
)


def own_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names without what all of them begin and end with, but for one: Character1_Hips is Hips.

    The one may be a root or a reference, which programs name otherwise.
    """
    begin = _common_beginning([*names])
    inner = [name.removeprefix(begin) for name in names]
    ends = [name[::-1] for name in inner if not name.endswith(END_SITE)]
    end = _common_beginning(ends)[::-1]
    return tuple(name.removesuffix(end) for name in inner)


def _common_beginning(names: list[str]) -> str:
    """Longest text that all names begin with, but for one at most; "" of few names."""
    if len(names) < FEWEST:
        return ""
    low, second, *_, before_last, high = sorted(names)
    # A name that begins otherwise is the first or the last.
    return max(_shared_beginning(second, high), _shared_beginning(low, before_last), key=len)


def _shared_beginning(a: str, b: str) -> str:
    """Longest text that both begin with."""
    return "".join(
        x for x, _ in takewhile(lambda pair: pair[0] == pair[1], zip(a, b, strict=False))
    )


def plain_name(name: str) -> str:
    """Name in lower case, without prefix and punctuation."""
    return re.sub(r"[^a-z0-9]", "", _PREFIX.sub("", name.lower()))


def canonical_name(name: str) -> str:
    """Plain name that begins with its side: RHip, hip_r and HIP_RIGHT are all `righthip`."""
    plain = plain_name(name)
    for pattern in _SIDED:
        sided = pattern.match(plain)
        if sided:
            return {"l": "left", "r": "right"}[sided["side"][0]] + sided["part"]
    return plain
