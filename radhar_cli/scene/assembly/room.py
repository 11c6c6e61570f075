"""Wall, faces, reflectors and ways by them, of a scene's room."""

from math import inf

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.room import DielectricConfig, LayerConfig
from radhar_cli.motion.reflectors import TONES, Reflectors
from radhar_cli.radar.layers import Layer, Layers
from radhar_cli.radar.materials import Material, permittivity
from radhar_cli.radar.room import FACES, Box, Face, Leg, names_of, reflected_legs
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.assembly.radar import antennas_of
from radhar_cli.scene.assembly.receiver import surroundings_stream
from radhar_cli.scene.scene import Scene, nominal_scene


def wall_of(scene: Scene) -> Wall | None:
    """Make the wall of a scene, or None where it has none.

    Layers are one slab of their mean refractive index, in the middle of the band, besides.
    """
    radar, wall = scene.radar, scene.wall
    if wall is None:
        return None
    depth, width, height = wall.size_m
    eps_r, loss_tangent = wall.eps_r, wall.loss_tangent
    if wall.layers is None:
        assert depth is not None  # refused where the config is read
        layers: tuple[Layer, ...] = (Layer(depth, eps_r * (1 - 1j * loss_tangent)),)
    else:
        layers = tuple(map(_layer, wall.layers))
        depth = sum(layer.thickness for layer in layers)
        middle = np.array(radar.carrier_hz + radar.bandwidth_hz / 2)
        n = sum(layer.thickness * np.sqrt(layer.eps(middle)) for layer in layers) / depth
        eps = complex(n * n)
        eps_r, loss_tangent = eps.real, -eps.imag / eps.real
    exact = Layers(layers, parallel=radar.polarisation == "horizontal")
    return Wall(
        center=wall.center_m,
        size=(depth, width, height),
        eps_r=eps_r,
        loss_tangent=loss_tangent,
        rays=wall.rays,
        fresnel=wall.fresnel,
        layers=exact if wall.echoes == "exact" else None,
    )


def _layer(layer: LayerConfig[float]) -> Layer:
    """Layer of a wall: of a material, or of a permittivity."""
    if layer.material is not None:
        return Layer(layer.thickness_m, layer.material)
    assert layer.eps_r is not None  # refused where the config is read
    return Layer(layer.thickness_m, layer.eps_r * (1 - 1j * layer.loss_tangent))


def box_of(scene: Scene) -> Box | None:
    """Box of the faces of a scene's room; None without faces, or for a floor alone."""
    box = scene.room.box_m
    return None if scene.room.faces is None or box is None else Box(box.x, box.y, box.height)


def ways_of(scene: Scene) -> list[tuple[Leg, Leg]]:
    """Ways of the transmitter's and the receiver's leg by faces of the room, or by a back wall."""
    radar, room = scene.radar, scene.room
    if room.back_wall_m is not None:
        reflection = 10 ** (room.back_wall_reflection_db / 20)
        leg = Leg((Face("back", FACES["back"], room.back_wall_m, constant_reflection=reflection),))
        return [(leg, leg)]
    if room.faces is None:
        return []
    box, faces = box_of(scene), []
    face_offsets = {"floor": 0.0} if box is None else box.face_offsets
    normal = FACES["floor" if radar.polarisation == "vertical" else "left"]
    for name, material in room.faces.reflecting.items():
        parallel, reflection_coefficient = FACES[name] != normal, None
        if material == "metal":
            reflection_coefficient = -1.0 if parallel else 1.0
        eps = _permittivity(material, radar.carrier_hz + radar.bandwidth_hz / 2)
        faces.append(
            Face(name, FACES[name], face_offsets[name], eps, parallel, reflection_coefficient)
        )
    outside = min(p[0] for p in antennas_of(scene).places) < face_offsets.get("front", -inf)
    return list(reflected_legs(faces, scene.config.room.order, outside))


def echo_ways_of(scene: Scene) -> list[Leg]:
    """Ways from the transmitter to the receiver by faces of the room alone, at most `order`."""
    ways = [tx for tx, rx in ways_of(scene) if not rx.faces]
    box = box_of(scene)
    if box is None or min(p[0] for p in antennas_of(scene).places) >= box.x[0]:
        return ways
    return [way for way in ways if way.faces[-1].name != "front"]  # behind which the radar is


def kinds_of(config: Config) -> list[str]:
    """Names of the ways by which people are seen, as "floor/-", the straight one, "-/-", first."""
    scene = nominal_scene(config, config.chosen_activities[0])
    return ["-/-", *map(names_of, ways_of(scene))]


def _permittivity(material: Material | DielectricConfig[float], frequency: float) -> complex:
    if isinstance(material, str):
        return complex(permittivity(material, np.array(frequency)))
    return complex(material.eps_r * (1 - 1j * material.loss_tangent))


def reflectors_of(scene: Scene) -> Reflectors | None:
    """Make the reflectors that stand in the room of a scene; None where there are none."""
    each, antennas = scene.room.reflectors, antennas_of(scene)
    if not each:
        return None
    rng = surroundings_stream(scene, "room.reflectors")
    return Reflectors(
        places=np.array([one.position_m for one in each]),
        rcs=10 ** (np.array([one.rcs_dbsm for one in each]) / 10),
        sd=np.array([one.residual_m for one in each]),
        fastest=np.array([one.highest_hz for one in each]),
        fractions=rng.random((len(each), TONES)),
        phases=rng.random((len(each), TONES)),
        towards=(np.array(antennas.tx) + np.array(antennas.rx)) / 2,
    )
