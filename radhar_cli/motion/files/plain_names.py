"""Names of joints without prefix, case and punctuation: `mixamorig:RightArm` is `rightarm`."""

import re

_PREFIX = re.compile(
    r"^(?:.*:|bip\d+|j_bip_(?:c_)?|mixamorig\d*|(?:k4abt_|xr_body_|xr_full_body_)?joint(?:type)?_(?:fb_|meta_)?)"
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
