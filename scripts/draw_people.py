"""Draw how people move: docs/images/people.gif, twelve activities at true speed, and frames.

    python scripts/draw_people.py [-o docs/images] [--index 1] [--falls]

Each cell shows the body from its side and, below, from where it faces at first, where the radar is;
its right side is green, its left orange. Scenes: configs/human/free_space_77GHz.yaml, facing the
radar. people_frames.png has a row of frames for each activity. --falls draws falls.png instead:
what people of configs/human/older.yaml do around falls, from their side.
"""

import argparse
from pathlib import Path
from typing import TypeAlias

import numpy as np
from draw_pictures import record_pictures
from PIL import Image, ImageColor, ImageDraw, ImageFont

from radhar_cli.config import Config, load_config
from radhar_cli.figures.style import LEFT, RIGHT
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import draw_scene

ROOT = Path(__file__).resolve().parents[1]
OVERRIDES = (
    "motion.angle_deg=180",
    "motion.walking.lane_m={per_activity: {default: 0, S8: 3}}",
    "on_invalid=keep",
)
Size: TypeAlias = tuple[int, int, int]  # width and height of a view, px; pixels a metre
SIZE: Size = (150, 126, 56)
STILL_SIZE: Size = (160, 128, 60)
FRAMES_PER_SECOND, FRAMES = 10, 8
# Movements, and the direction of the fall.
FALLS = (
    ("falling_off_seat getting_up", "forward"),
    ("falling_off_seat trying_to_get_up", "backward"),
    ("falling_on_rising getting_up", "backward"),
    ("falling_on_rising getting_up", "sideways"),
    ("falling_on_hands getting_up", "forward"),
    ("falling_on_hands trying_to_get_up", "backward"),
    ("stumbling", "forward"),
    ("stumbling", "sideways"),
    ("tripping", "forward"),
)
COLOURS = {"right": ImageColor.getrgb(RIGHT), "left": ImageColor.getrgb(LEFT)}


def stick_figure(p: Float, hips: Float, name: str, size: Size = SIZE) -> Image.Image:
    """Joints [3, 13] and hip joints [3, 2] in m, x ahead: from the side, and from ahead below."""
    width, height, pixels_per_metre = size
    picture = Image.new("RGB", (width, 2 * height), "white")
    draw = ImageDraw.Draw(picture)
    centre = p.mean(axis=1)
    for view, (axis, sign) in enumerate(((0, 1.0), (1, 1.0))):
        floor = height * (view + 1) - 8

        def place(q: Float, axis: int = axis, sign: float = sign, floor: int = floor) -> Float:
            across = width / 2 + sign * (q[axis] - centre[axis]) * pixels_per_metre
            return np.stack([across, floor - q[2] * pixels_per_metre], axis=-1)

        draw.line([(0, floor), (width, floor)], fill=(190, 190, 190))
        points, sockets = place(p), place(hips)
        for joint, parent in enumerate(PARENTS):
            if parent is None:
                continue
            side = JOINTS[joint].partition("_")[0]
            start = points[parent]
            if JOINTS[joint].endswith("knee"):
                start = sockets[int(side == "left")]
            ends = [*start.tolist(), *points[joint].tolist()]
            draw.line(ends, fill=COLOURS.get(side, (0, 0, 0)), width=max(2, pixels_per_metre // 18))
        x, y = points[JOINTS.index("head")].tolist()
        radius = pixels_per_metre / 10
        draw.ellipse([x - radius, y - radius, x + radius, y + radius], outline=(0, 0, 0))
    draw.text((3, 2), name, fill=(0, 0, 0), font=ImageFont.load_default(13))
    return picture


def frames(motion: HumanMotion, times: Float, name: str, size: Size = SIZE) -> list[Image.Image]:
    """The figure at some times (s), x as it faces at first."""
    p, hips = motion.positions(times), motion.hip_joints(times)
    cos, sin = np.cos(motion.heading), np.sin(motion.heading)
    turn = np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    p, hips = (np.einsum("ab,bjm->ajm", turn, q) for q in (p, hips))
    return [
        stick_figure(p[..., k], hips[..., k], f"{name}  {t:.1f} s".strip(), size)
        for k, t in enumerate(times)
    ]


def draw_people(config: Config, index: int, out: Path) -> None:
    """Write people.gif and people_frames.png."""
    seconds = 6.0
    film = np.arange(0, seconds, 1 / FRAMES_PER_SECOND)
    stills = np.linspace(0.2, seconds - 0.1, FRAMES)
    moving, rows = [], []
    for activity in ACTIVITIES:
        motion = motion_of(draw_scene(config, activity, index).people[0])
        assert isinstance(motion, HumanMotion)
        moving.append(frames(motion, film, f"{activity.label} {activity.slug.replace('_', ' ')}"))
        rows.append(frames(motion, stills, activity.slug.replace("_", " "), STILL_SIZE))
    grid = [
        _tiled([[moving[6 * row + n][k] for n in range(6)] for row in range(2)])
        for k in range(film.size)
    ]
    grid[0].save(
        out / "people.gif",
        save_all=True,
        append_images=grid[1:],
        duration=1000 // FRAMES_PER_SECOND,
        loop=0,
    )
    _with_legend(_tiled(rows)).save(out / "people_frames.png", optimize=True)
    record_pictures(
        [out / "people.gif", out / "people_frames.png"], "python scripts/draw_people.py"
    )


def draw_falls(index: int, out: Path) -> None:
    """Write falls.png, a row of frames for each of FALLS."""
    rows = []
    for sequence, direction in FALLS:
        own = f"classes={{own: {{sequence: [{sequence.replace(' ', ', ')}]}}}}"
        chosen = [
            own,
            "activities=[own]",
            f"motion.falling.direction={direction}",
            "motion.angle_deg=180",
            "timing.onset=0",
            "timing.visible=1",
        ]
        chosen.append("motion.range_m={uniform: [4, 6]}")  # the file's has classes by name
        config = load_config(ROOT / "configs/human/older.yaml", chosen)
        motion = motion_of(draw_scene(config, config.chosen_activities[0], index).people[0])
        assert isinstance(motion, HumanMotion)
        end = min(motion.parts[-1][0].end, 6.0)
        names = f"{sequence.split()[0].removeprefix('falling_').replace('_', ' ')} {direction}"
        rows.append(frames(motion, np.linspace(0.0, end, FRAMES), names, STILL_SIZE))
    _with_legend(_tiled(rows)).save(out / "falls.png", optimize=True)
    record_pictures([out / "falls.png"], "python scripts/draw_people.py --falls")


def _tiled(cells: list[list[Image.Image]]) -> Image.Image:
    """Pictures of one size in rows, of 64 colours."""
    sheet = np.concatenate([np.concatenate([np.asarray(c) for c in row], axis=1) for row in cells])
    return Image.fromarray(sheet).quantize(64, dither=Image.Dither.NONE)


def _with_legend(tiles: Image.Image) -> Image.Image:
    """Pictures with the meaning of their colours and views in a line above."""
    side = "above from the side, the radar on the right"
    words = f"{side}; below from the radar, which the person faces at first"
    sheet = Image.new("RGB", (tiles.width, tiles.height + 26), "white")
    draw, x, font = ImageDraw.Draw(sheet), 6.0, ImageFont.load_default(16)
    for text, colour in (
        ("right side", COLOURS["right"]),
        ("left side", COLOURS["left"]),
        (words, (0, 0, 0)),
    ):
        draw.text((x, 3), text, fill=colour, font=font)
        x += draw.textlength(text, font) + 24
    sheet.paste(tiles, (0, 26))
    return sheet.quantize(64, dither=Image.Dither.NONE)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images")
    parser.add_argument("--index", type=int, default=1, help="number of the sample in its class")
    parser.add_argument("--falls", action="store_true", help="draw falls.png instead")
    given = parser.parse_args()
    if given.falls:
        draw_falls(given.index, given.out)
        return
    config = load_config(ROOT / "configs/human/free_space_77GHz.yaml", OVERRIDES)
    draw_people(config, given.index, given.out)


if __name__ == "__main__":
    main()
