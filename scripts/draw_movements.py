"""Write docs/reference/movements.md, and a picture of every activity and movement.

    python scripts/draw_movements.py [--page] [NAME ...]

Pictures are docs/images/movements/NAME.png: the body at some instants, from its side and from where
it faces at first (its right side green), and the Doppler map of that recording at 24 GHz, in which
the person faces the radar. NAMEs draw these alone; --page writes the page alone. Rows come from
ACTIVITIES, MOVEMENTS, the schema and the vocabulary: what is new there needs no line here.
"""

import argparse
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from draw_people import frames
from draw_pictures import record_pictures
from PIL import Image, ImageDraw

from radhar_cli.config import Config
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.sample import synthesise
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import ACTIVITIES, Activity, activity_named
from radhar_cli.motion.activities.vocabulary import MEANINGS, meaning_of
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.movements.catalogue import MOVEMENTS, users_of
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.numerics.arrays import Float, Levels
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene
from radhar_cli.schema.annotations import People, of_kind

ROOT = Path(__file__).resolve().parents[1]
PAGE, PICTURES = ROOT / "docs/reference/movements.md", ROOT / "docs/images/movements"
INDEX = 1  # of the sample that is drawn
SECONDS = 6.0
FAR_M = 28.0  # start of runners
FIGURES, FIGURE_WIDTH, VIEW = 8, 88, 104
PIXELS_PER_METRE = 44
STEADY_S = 2.1  # time from the first to the last figure of what goes on and on
HIGHEST_MPS = 7.0  # of the map
COLOURS, MAP_COLOURS = 24, 64  # of the palettes, so that pictures stay small
MAX_BYTES = 45_000


def config_of(name: str, start_m: float | None = None) -> Config:
    """Config of one class, in which people face the radar, with little noise.

    Args:
        name: name of the class.
        start_m: range at which they start; None as data sets have it.
    """
    return Config.model_validate(
        {
            "activities": [name],
            "duration_s": SECONDS,
            "radar": {"carrier_hz": 24e9, "bandwidth_hz": 5e8, "prf_hz": 2500},
            "motion": {"angle_deg": 180.0, "range_m": start_m},
            "timing": {"onset": 0.5, "visible": 1.0},  # all of it, in the middle
            "image": {
                "size_px": 2 * VIEW,
                "dynamic_range_db": 40.0,
                "doppler_limits_mps": [-HIGHEST_MPS, HIGHEST_MPS],
            },
            "maps": ["stft"],
            "snr_db": 55.0,
        }
    )


def draw_picture(name: str) -> Image.Image:
    """Figures and map of one recording of a class."""
    config = config_of(name)
    activity = config.chosen_activities[0]
    try:
        scene, _ = draw_valid_scene(config, activity, INDEX)
    except SceneError:  # who runs towards the radar reaches it
        config = config_of(name, FAR_M)
        scene, _ = draw_valid_scene(config, activity, INDEX)
    image = synthesise(scene, plan_images(config), config).images["stft"]
    times = _figure_times(name, activity, scene)
    panel = _map_panel(image.levels, config.image.colour_map, times)
    return _joined(_figure_panel(name, scene, times), panel)


def _figure_times(name: str, activity: Activity, scene: Scene) -> Float:
    """Instants of the figures of a scene, s; none of nobody."""
    if name == NOBODY:
        return np.zeros(0)
    motion = motion_of(scene.people[0])
    assert isinstance(motion, HumanMotion)
    return instants(activity, motion)


def _figure_panel(name: str, scene: Scene, times: Float) -> Image.Image:
    """Figures [2 VIEW, FIGURES * FIGURE_WIDTH] of the person of a scene; none of nobody."""
    panel = Image.new("RGB", (FIGURES * FIGURE_WIDTH, 2 * VIEW), "white")
    if name == NOBODY:
        ImageDraw.Draw(panel).text((3, 2), "nobody", fill=(0, 0, 0))
        return panel
    motion = motion_of(scene.people[0])
    assert isinstance(motion, HumanMotion)
    size = (FIGURE_WIDTH, VIEW, PIXELS_PER_METRE)
    for place, figure in enumerate(frames(motion, times, "", size)):
        panel.paste(figure, (place * FIGURE_WIDTH, 0))
    return panel


def instants(activity: Activity, motion: HumanMotion) -> Float:
    """Instants of the figures, s: all of what ends, some repetitions of what goes on."""
    first, last = motion.parts[0][0], motion.parts[-1][0]
    if STEADY_S / 3 < last.end <= SECONDS:
        return np.linspace(max(first.begin, 0.0), min(last.end + 0.1, SECONDS - 0.05), FIGURES)
    if len(activity.movements) > 1 and len(motion.parts) > 1:
        return np.linspace(0.1, SECONDS - 0.1, FIGURES)
    middle = SECONDS / 2
    return np.linspace(middle - STEADY_S / 2, middle + STEADY_S / 2, FIGURES)


def _map_panel(levels: Levels, colour_map: str, times: Float) -> Image.Image:
    """Doppler map [2 VIEW, 2 VIEW] with its edges in words, and marks at the times (s)."""
    picture = Image.fromarray(colour_table(colour_map)[levels])
    picture = picture.resize((2 * VIEW, 2 * VIEW))
    draw = ImageDraw.Draw(picture)
    for time in times.tolist():
        x = time / SECONDS * 2 * VIEW
        draw.line([(x, 2 * VIEW - 24), (x, 2 * VIEW - 17)], fill="white")
    for text, place in (
        (f"{HIGHEST_MPS:+g} m/s", (3, 2)),
        (f"{-HIGHEST_MPS:+g} m/s", (3, 2 * VIEW - 13)),
        (f"{SECONDS:g} s", (2 * VIEW - 22, 2 * VIEW - 13)),
    ):
        draw.text(place, text, fill="white", stroke_width=1, stroke_fill="black")
    return picture


def _joined(figures: Image.Image, map_panel: Image.Image) -> Image.Image:
    """Two panels side by side, of few colours each."""
    panels = [
        panel.quantize(colours, dither=Image.Dither.NONE).convert("RGB")
        for panel, colours in ((figures, COLOURS), (map_panel, MAP_COLOURS))
    ]
    whole = Image.new("RGB", (figures.width + map_panel.width, 2 * VIEW), "white")
    whole.paste(panels[0], (0, 0))
    whole.paste(panels[1], (figures.width, 0))
    return whole.quantize(COLOURS + MAP_COLOURS, dither=Image.Dither.NONE)


def names() -> list[str]:
    """The twelve activities, then the other movements."""
    return list(dict.fromkeys((*(activity.slug for activity in ACTIVITIES), *MOVEMENTS)))


def page() -> str:
    """docs/reference/movements.md."""
    twelve = [activity.slug for activity in ACTIVITIES]
    lines = [*INTRODUCTION, "", "## The twelve activities", ""]
    for name in twelve:
        lines += _entry(name)
    lines += ["## Further movements", ""]
    for name in names():
        lines += [] if name in twelve else _entry(name)
    return "\n".join(lines).rstrip("\n") + "\n"


def _entry(name: str) -> Iterator[str]:
    """Lines of one class or movement."""
    activity = activity_named(name)
    label = f"{activity.label} " if activity.number <= len(ACTIVITIES) else ""
    yield from (f"### {label}{name}", "")
    yield from (f"{_states(name, activity)}. {_words(name)}Keys: {_keys(activity)}.", "")
    yield from (f"![{name}](../images/movements/{name}.png)", "")


def _states(name: str, activity: Activity) -> str:
    """How a class begins, ends and how long it takes, in words."""
    if name == NOBODY:
        return "Nobody is there; the room and the noise alone"
    if name not in MOVEMENTS:
        return " then ".join(f"`{movement}`" for movement in activity.movements).capitalize()
    seconds, pairs = MOVEMENTS[name].seconds, MOVEMENTS[name].states.items()
    ways = (before if before == after else f"{before} to {after}" for before, after in pairs)
    states = ", or ".join(ways).capitalize().replace("_", " ")
    if seconds is None:
        return f"{states}; as long as the recording"
    return f"{states}; {seconds:g} s"


def _words(name: str) -> str:
    """Other words for a class, as a sentence; empty without any."""
    words = sorted(w for w in MEANINGS if meaning_of(w, (*MOVEMENTS, *names())) == name)
    return f"Also {', '.join(f'`{word}`' for word in words)}. " if words else ""


def _keys(activity: Activity) -> str:
    """Keys that this class uses and not every one does."""
    mine = {activity.label, *activity.movements}
    keys = [key for key, users in _users().items() if not mine.isdisjoint(users)]
    return ", ".join(f"`{key}`" for key in keys) or "those of everybody"


@cache
def _users() -> dict[str, frozenset[str]]:
    """{key: movements and labels that use it} of the keys that not everybody uses."""
    return {
        key: frozenset(names)
        for key, people in of_kind(Config, People)
        if (names := users_of(key, people))
    }


INTRODUCTION = (
    "# Classes and movements",
    "",
    "After this page you know what can be named in `activities:` and `sequence:`, and what it",
    "looks like. `scripts/draw_movements.py` writes it and draws the pictures; a test keeps it",
    "true. Each picture shows the person at eight instants, from the side and from where they face",
    "at first (right side green, left orange), and the Doppler map of 6 s at 24 GHz, facing the",
    "radar; lines in the map mark the instants of the figures. The states",
    "are those at the beginning and the end: movements follow each other in a sequence where these",
    "agree. A movement that is a class takes its usual time within 15 %, or lasts as long as the",
    "recording. Other words are understood, too, in any case, with spaces or hyphens. Keys are",
    "those that not everybody uses: [the keys](config.md) says what they mean.",
)


def main() -> None:
    """Write the page and the pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    arguments = parser.parse_args()
    PAGE.write_text(page(), encoding="utf-8")
    if arguments.page:
        return
    PICTURES.mkdir(parents=True, exist_ok=True)
    given_names = arguments.names or names()
    for name in given_names:
        path = PICTURES / f"{name}.png"
        draw_picture(name).save(path, optimize=True)
        print(f"{path}: {path.stat().st_size} bytes", flush=True)
    paths = [PICTURES / f"{name}.png" for name in given_names]
    record_pictures(paths, "python scripts/draw_movements.py")


if __name__ == "__main__":
    main()
