"""Axis of a file that points up: people stand along it, on a floor, and fall down along it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Bool, Float

UPRIGHT = 0.8  # least cosine of the angle to the vertical that tells which way is up
MAJORITY = 0.5  # least share of the frames in which the head is above the feet
LEAST_SHARE = 0.03  # least share of the frames in which an axis is that of a body at all
FLOOR = 0.25  # largest range of heights of the lowest joint on a floor, over the stature
CLIMB = 0.5  # least path along the body's own axis that makes somebody a crawler, statures
FALL = 1.2  # least speed of a head that falls, statures per second; a person who gets up is slower
IN_PLACE = 0.3  # most that hips go across the body of a person who takes no steps, over the stature
NO_SQUAT = 0.08  # largest way of hips along a body that neither squats nor jumps, the same
LEGS = 0.5  # least cosine of hips over feet to an axis that is up; a bent body has none
BENT_LEG = 0.5  # most cosine of thighs to the line from feet to head of a person who sits or crawls
FLAT = 0.45  # largest height of a body that lies or is on all fours, over the stature
FLOOR_AT = (-0.02, 0.09)  # heights of the lowest joint on a floor at 0, over the stature
BED = 0.45  # largest height of the lowest joint of a lying person; a camera stands farther off
USUAL = ("z", "y", "-y")  # the vertical of nearly all files

_HEAD, _HIP = JOINTS.index("head"), JOINTS.index("hip")
_ANKLES = [JOINTS.index(f"{s}_ankle") for s in ("right", "left")]
_KNEES = [JOINTS.index(f"{s}_knee") for s in ("right", "left")]
_HIP_JOINTS = [len(JOINTS), len(JOINTS) + 1]
_AXES = [(sign, axis) for axis in range(3) for sign in (1, -1)]


class UpAxis(NamedTuple):
    """Axis that points up, if it is clear, and a remark on it."""

    name: str | None  # "z", "-y", ...
    remark: str = ""  # where it is assumed


def find_up_axis(p: Float, rate: float, stature: float, rest: Float | None = None) -> UpAxis:
    """Find the axis that points up of the frames of a person.

    Of the axes along which the body is ever straight, those go that have no floor while another
    one has, and those along which somebody seems to get up where another says that he falls. The
    rest pose comes last, for it need not stand: in games its root is turned by every frame. Where
    it stands along a usual vertical, another one of frames in which nobody moves needs a floor.

    Args:
        p: Positions [frames, 15, 3], the thirteen joints and the hip joints.
        rate: Frames per second.
        stature: Of the person in the unit of the positions.
        rest: Positions [15, 3] of the rest pose, or None.
    """
    p = p / stature
    feet = p[:, _ANKLES].mean(axis=1)
    body, legs = _directions(p[:, _HEAD] - feet), _directions(p[:, _HIP] - feet)
    shares = {
        _name(*signed): float(
            ((body @ _vector(*signed) > UPRIGHT) & (legs @ _vector(*signed) > LEGS)).mean()
        )
        for signed in _AXES
    }
    axes = [signed for signed in _AXES if shares[_name(*signed)] >= LEAST_SHARE]
    standing = [signed for signed in axes if not _crawls_along(p, signed)]
    of_rest = _axis_of_rest(rest)
    clear = [signed for signed in standing if shares[_name(*signed)] > MAJORITY]
    if len(axes) == 1 and clear:
        name = _name(*clear[0])
        doubt = "" if name == of_rest else _doubt(p, body, clear[0])
        if doubt and of_rest and not _is_on_floor(p, clear[0]):
            return UpAxis(None, _name_choice([name, f"{of_rest} in its rest pose"]))
        others = _axes_of_who_lies(p, clear[0]) if doubt else []
        if doubt and (others or name not in USUAL):
            otherwise = f", or lies if {' or '.join(others or USUAL[:2])} points up"
            return UpAxis(None, f"for somebody is straight along {name}{otherwise}")
        return UpAxis(name, doubt)
    if not standing or (len(standing) == 1 and not (clear or _has_floor(p, standing[0]))):
        return UpAxis(of_rest)
    possible = _drop_fallen(p, body, rate, _keep_floors(p, standing))
    usual = [signed for signed in possible if _name(*signed) in USUAL] or possible
    if not usual or of_rest in {_name(*signed) for signed in usual}:
        return UpAxis(of_rest)
    if len(usual) != 1:
        return UpAxis(None, _name_choice([_name(*signed) for signed in usual]))
    name = _name(*usual[0])
    lying = [axis for axis in shares if axis != name and shares[axis] >= LEAST_SHARE]
    if not lying or shares[name] > 1 - LEAST_SHARE:
        return UpAxis(name)
    along = " and ".join(lying)
    return UpAxis(
        name,
        f"somebody lies along {along} for {max(shares[axis] for axis in lying):.0%} of it if "
        f"{name} points up, as is assumed; up: {lying[0]} of its class (--up {lying[0]}) would "
        "say otherwise",
    )


def _name_choice(names: Sequence[str]) -> str:
    """Words for several axes that may point up."""
    return f"for somebody is upright along {' and '.join(names)}" if names else ""


def _name(sign: int, axis: int) -> str:
    """Name of an axis with its sign, such as z or -y."""
    return ("-" if sign < 0 else "") + "xyz"[axis]


def _vector(sign: int, axis: int) -> Float:
    """Unit vector [3] of an axis with its sign."""
    vector: Float = sign * np.eye(3)[axis]
    return vector


def _directions(vectors: Float) -> Float:
    """Unit vectors of vectors [..., 3]."""
    unit: Float = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
    return unit


def _axis_of_rest(rest: Float | None) -> str | None:
    """Usual vertical along which the rest pose [15, 3] stands; along another one bones are laid."""
    if rest is None:
        return None
    body = _directions(rest[_HEAD] - rest[_ANKLES].mean(axis=0))
    names = [_name(*signed) for signed in _AXES if body @ _vector(*signed) > UPRIGHT]
    return next((name for name in names if name in USUAL), None)


def _floor_range(p: Float, axis: int, sign: int) -> float:
    """Range of heights of the lowest joint in nearly all frames, over the stature."""
    low, high = np.percentile((sign * p[..., axis]).min(axis=1), [3, 97])
    return float(high - low)


def _has_floor(p: Float, signed: tuple[int, int]) -> bool:
    """Whether the lowest joint stays at one height along an axis."""
    return _floor_range(p, signed[1], signed[0]) < FLOOR


def _keep_floors(p: Float, axes: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Axes along which the lowest joint stays; all of them where it stays along none."""
    return [signed for signed in axes if _has_floor(p, signed)] or [*axes]


def _crawls_along(p: Float, signed: tuple[int, int]) -> bool:
    """Whether the hips go along the body's own axis and nowhere else: on all fours, or a ladder."""
    paths = np.ptp(p[:, _HIP], axis=0)
    sideways = np.delete(paths, signed[1]).max()
    return bool(paths[signed[1]] > max(CLIMB, 2 * sideways)) and not _has_floor(p, signed)


def _drop_fallen(
    p: Float, body: Float, rate: float, axes: Sequence[tuple[int, int]]
) -> list[tuple[int, int]]:
    """Leave out axes along which a head would shoot up from a body that lies: it falls instead."""
    velocity = np.diff(p[:, _HEAD], axis=0) * rate
    possible = []
    for signed in axes:
        along = body @ _vector(*signed) > UPRIGHT
        is_fall = any(
            _falls(velocity @ _vector(*other), body @ _vector(*other) > UPRIGHT, along, rate)
            for other in axes
            if other != signed
        )
        if not is_fall:
            possible.append(signed)
    return possible


def _falls(rise: Float, upright: Bool, lying: Bool, rate: float) -> bool:
    """Whether a head comes down fast within a second before the body begins to lie.

    Args:
        rise: Speed of the head upwards [frames - 1], statures per second.
        upright: Frames in which the body stands.
        lying: Frames in which it lies.
        rate: Frames per second.
    """
    second = max(1, round(rate))
    for start in np.flatnonzero(np.diff(lying.astype(int)) > 0) + 1:
        before = slice(max(0, start - second), start)
        after = slice(max(0, start - second), start + second)
        if upright[before].any() and rise[after].min(initial=0) < -FALL:
            return True
    return False


def _axes_of_who_lies(p: Float, signed: tuple[int, int]) -> list[str]:
    """Axes that may point up of somebody who lies, sits or crawls, and is straight along another.

    A room has its floor at 0, and a bed not far above it; a camera is farther away from a body
    that it has in its picture whole.
    """
    own_floor = _is_on_floor(p, signed)
    possible = []
    for name, other in zip(USUAL, ((1, 2), (1, 1), (-1, 1)), strict=True):
        height = _height(p, other)
        is_flat = float(np.median(np.ptp(p[..., other[1]], axis=1))) < FLAT
        is_low = FLOOR_AT[0] < height < (FLOOR_AT[1] if own_floor else BED)
        if other[1] != signed[1] and is_flat and is_low:
            possible.append(name)
    return possible


def _is_on_floor(p: Float, signed: tuple[int, int]) -> bool:
    """Whether the lowest joint along an axis is at the height of a floor at 0."""
    return FLOOR_AT[0] < _height(p, signed) < FLOOR_AT[1]


def _height(p: Float, signed: tuple[int, int]) -> float:
    """Height of the lowest joint in nearly all frames along an axis, over the stature."""
    sign, axis = signed
    return float(np.median((sign * p[..., axis]).min(axis=1)))


def _doubt(p: Float, body: Float, signed: tuple[int, int]) -> str:
    """Words for a body that is straight along one axis only, as a lying one may be, too."""
    name = _name(*signed)
    say = f"{name} is assumed to point up; up: AXIS of its class (--up AXIS) says otherwise"
    thighs = _directions(p[:, _KNEES] - p[:, _HIP_JOINTS]).mean(axis=1)
    across = np.abs((thighs * body).sum(axis=1)) < BENT_LEG
    if across.mean() > MAJORITY:
        return f"somebody sits, or is on all fours, for most of it: {say}"
    axes = np.ptp(p[:, _HIP], axis=0)
    if axes[signed[1]] < NO_SQUAT and np.delete(axes, signed[1]).max() < IN_PLACE:
        return f"nobody steps away, squats or jumps, and who lies straight may look so: {say}"
    return ""
