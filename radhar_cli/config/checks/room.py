"""Walls, rooms and noise that do not fit together."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

from radhar_cli.config.first_level import Request
from radhar_cli.config.radar import ArrayRadar, ImpulseRadar
from radhar_cli.config.room import LayerConfig, WallConfig, mean_slab
from radhar_cli.schema.number import nominal, support
from radhar_cli.schema.section import Problem, for_activity


def wall_problems(c: Request) -> Iterator[Problem]:
    """Find the problems of the wall: its layers, and antennas inside of it."""
    if c.wall is None:
        return
    yield from _layer_problems(c, c.wall)
    depth = sum(support(layer.thickness_m)[1] for layer in c.wall.layers or ())
    sizes = [depth if size is None else support(size)[1] for size in c.wall.size_m]
    for name in c.radar.place_keys:
        antenna = getattr(c.radar, name)
        along = zip(map(support, antenna), map(support, c.wall.center_m), sizes, strict=True)
        if all(p[0] <= m[1] + size / 2 and p[1] >= m[0] - size / 2 for p, m, size in along):
            wall = f"wall.center_m = {list(c.wall.center_m)}, wall.size_m = {list(c.wall.size_m)}"
            right = f"should be outside the wall, whose faces count as inside ({wall})"
            yield Problem(f"radar.{name}", list(antenna), right)


def _layer_problems(c: Request, wall: WallConfig) -> Iterator[Problem]:
    """Layers and exact echoes of a wall that do not go with other keys."""
    if (wall.layers is None) != (wall.size_m[0] is not None):
        right = "should be null with wall.layers" if wall.layers else "should be a number"
        yield Problem("wall.size_m.0", wall.size_m[0], right)
    layers = wall.layers or ()
    for number, layer in enumerate(layers):
        forms = (layer.material is not None) + (layer.eps_r is not None)
        if forms != 1 or (layer.material and layer.loss_tangent):
            right = "should have a material, or eps_r and loss_tangent"
            yield Problem(f"wall.layers.{number}", layer.model_dump(mode="json"), right)
            return
    if layers and isinstance(c.radar, ArrayRadar):
        written = [layer.material or f"eps_r {nominal(layer.eps_r):g}" for layer in layers]
        yield Problem("wall.layers", written, _describe_slab(c, wall, layers))
        return
    default = WallConfig()
    for key in ("eps_r", "loss_tangent") if wall.layers else ():
        if getattr(wall, key) != getattr(default, key):
            yield Problem(f"wall.{key}", getattr(wall, key), "should be left to wall.layers")
    if wall.echoes == "none":
        if wall.layers:
            yield Problem("wall.echoes", "none", "should be exact with wall.layers")
        return
    if wall.rays != "plane":
        yield Problem("wall.rays", wall.rays, "should be plane with wall.echoes: exact")
    if wall.fresnel != "normal":
        right = "should be left out with wall.echoes: exact, which has radar.polarisation"
        yield Problem("wall.fresnel", wall.fresnel, right)
    if isinstance(c.radar, ArrayRadar):
        yield Problem("wall.echoes", "exact", f"should be none with {c.radar.named}")
    elif c.engine.kind == "direct" and not isinstance(c.radar, ImpulseRadar):
        right = "should be cube with wall.echoes: exact, which the direct engine does not have"
        yield Problem("engine.kind", "direct", right)


def _describe_slab(c: Request, wall: WallConfig, layers: Sequence[LayerConfig]) -> str:
    """Describe the single layer that stands for the layers of a wall before an array."""
    hz = nominal(c.radar.carrier_hz)
    depth, eps_r, loss = mean_slab([layer.make_layer() for layer in layers], hz)
    width, height = (nominal(size) for size in wall.size_m[1:])
    return (
        f"should be left out with {c.radar.named}, whose walls are one layer: size_m: "
        f"[{depth:.4g}, {width:g}, {height:g}], eps_r: {eps_r:.4g}, loss_tangent: {loss:.3g} "
        f"delays and absorbs {hz / 1e9:.4g} GHz alike, without the echoes between layers"
    )


def back_wall_problems(c: Request) -> Iterator[Problem]:
    """Find the problems of the back wall: another wall, or a place in front of people."""
    key, wall = "room.back_wall_m", c.room.back_wall_m
    if wall is None:
        return
    if c.wall is not None:
        right = "should be null with a wall in front: one of the two is simulated"
        yield Problem(key, wall, right)
    for at_range, _, ends in _coordinates(c, "range_m"):
        farthest = max([0.0, *(end for _, end in ends)])
        if support(wall)[0] <= farthest:
            where = f"at up to {farthest:g} m ({at_range})"
            yield Problem(key, wall, f"should be beyond the people, who stand {where}")


def _coordinates(c: Request, name: str) -> Iterator[tuple[str, Any, list[tuple[float, float]]]]:
    """Find the coordinates of everybody under one name, `range_m` or `cross_range_m`.

    Yields:
        (dotted key, value, [(least, most) of each activity]) of each person: of where they start,
        and of where they are at one instant (`motion.place`).
    """
    people = [("", c.motion, c.chosen_activities)]
    with suppress(ValueError):  # of an unknown activity, which is told by itself
        people += [
            (f"people.{n}.", one.motion, c.activities_of(n + 1)) for n, one in enumerate(c.people)
        ]
    if c.places_people and c.stream is not None:
        yield f"stream.zone.{name}", list(zone := getattr(c.stream.zone, name)), [zone]
        people = people[1:]
    for prefix, motion, activities in people:
        value, at_place = getattr(motion, name), getattr(motion.place, name)
        numbers = [for_activity(value, one) for one in activities]
        yield f"{prefix}motion.{name}", value, [support(one) for one in numbers if one is not None]
        starts = [for_activity(motion.range_m, one) for one in activities]
        placed = [
            for_activity(at_place, one)
            for one, *start in zip(activities, numbers, starts, strict=True)
            if start == [None, None]
        ]
        yield f"{prefix}motion.place.{name}", at_place, [support(one) for one in placed]


def room_problems(c: Request) -> Iterator[Problem]:
    """Faces, box and antennas that do not go together."""
    room, radar = c.room, c.radar
    if room.faces is None:
        return
    if room.back_wall_m is not None:
        right = "should be null with room.faces, of which back is one"
        yield Problem("room.back_wall_m", room.back_wall_m, right)
    if room.box_m is None:
        for name in radar.place_keys:
            if support(getattr(radar, name)[2])[0] <= 0:
                right = "should be above the floor of room.faces, at a height of 0"
                yield Problem(f"radar.{name}", list(getattr(radar, name)), right)
        if walls := [name for name in room.faces.reflecting if name != "floor"]:
            right = f"should say where {', '.join(walls)} of room.faces are; a floor needs none"
            yield Problem("room.box_m", None, right)
        return
    box, height = room.box_m, support(room.box_m.height)
    for key, (low, high) in (("x", box.x), ("y", box.y)):
        if support(low)[1] >= support(high)[0]:
            yield Problem(f"room.box_m.{key}", [low, high], "should be [lower, higher]")
            return
    tall = support(c.subject.height_m)[0]
    if height[1] <= tall:
        right = f"should be above people, {tall:g} m tall or more (subject.height_m)"
        yield Problem("room.box_m.height", box.height, right)
    within = [(support(low)[1], support(high)[0]) for low, high in (box.x, box.y)]
    within.append((0.0, height[0]))
    for name in radar.place_keys:
        antenna = getattr(radar, name)
        places = [support(one) for one in antenna]
        before = places[0][1] < support(box.x[0])[0]
        inside = [low < a and b < high for (a, b), (low, high) in zip(places, within, strict=True)]
        if before and all(inside[1:]) and c.wall is None:
            right = "should be inside room.box_m, or have a wall: to see through"
            yield Problem(f"radar.{name}", list(antenna), right)
        elif not all(inside[1:] if before else inside):
            right = _describe_inside(places, within, radar.named)
            yield Problem(f"radar.{name}", list(antenna), right)
    for key, name, ends_of_box in (("x", "range_m", box.x), ("y", "cross_range_m", box.y)):
        low, high = support(ends_of_box[0])[0], support(ends_of_box[1])[1]
        for where, value, ends in _coordinates(c, name):
            if any(most <= low or least >= high for least, most in ends):
                right = f"should be inside room.box_m.{key}, {low:g} to {high:g} m"
                yield Problem(where, value, right)


def _describe_inside(
    places: Sequence[tuple[float, float]], within: Sequence[tuple[float, float]], named: str
) -> str:
    """Describe the coordinates of an antenna that are not inside the box, nor before its front."""
    outside = " and ".join(
        f"{axis} is {b:g}, not between {low:g} and {high:g}"
        for axis, (a, b), (low, high) in zip("xyz", places, within, strict=True)
        if not (low < a and b < high)
    )
    front = within[0][0]
    cure = ""
    if places[0][1] == front:
        cure = f"; the box begins there: box_m.x: [{front - 0.1:g}, ...], or x = {front + 0.1:g}"
    return f"should be inside room.box_m, or before its front, x = {front:g}: {outside}{cure}"


def tone_problems(c: Request) -> Iterator[Problem]:
    """Find the keys of the receiver that need noise where it has none."""
    extra = {"tones": c.receiver.tones, "noise_corner_hz": support(c.receiver.noise_corner_hz)[1]}
    for key in [key for key, is_used in extra.items() if is_used and not c.has_noise]:
        right = (
            f"should be a number, or receiver.noise_figure_db be given: receiver.{key} is relative "
            "to the noise"
        )
        yield Problem("snr_db", None, right)
