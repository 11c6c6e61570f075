"""Draw clouds of people beside their skeletons, by two chains of points: docs/images/clouds.png.

    python scripts/draw_clouds.py [-o docs/images] [--seed 1]

Before an IWR6843ISK 1.5 m high with TI's profile of 3D people tracking (BPM, fine motion on): one
who walks, two who walk, one who stands, one who falls and lies. A row of frames of each scene has
the points of people tracking on the left and those of the out-of-box demo, of the same cube, on the
right: above as seen from above, range upwards, below as seen from the radar. Points are red where
they approach, blue where they recede, black at rest; skeletons are grey.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import record_pictures
from PIL import Image, ImageDraw, ImageFont

from radhar_cli.config.data_set import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.skeleton import PARENTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.points import Cloud, board_points
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_detection import read_detection
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

ROOT = Path(__file__).resolve().parents[1]
CFG = """
dfeDataOutputMode 1
channelCfg 15 7 0
adcCfg 2 1
adcbufCfg -1 0 1 1 1
bpmCfg -1 1 0 2
profileCfg 0 60.75 30.00 25.00 59.10 0 0 54.71 1 96 2950.00 2 1 36
chirpCfg 0 0 0 0 0 0 0 5
chirpCfg 1 1 0 0 0 0 0 2
chirpCfg 2 2 0 0 0 0 0 5
frameCfg 0 2 48 0 55.00 1 0
dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 4.00 8.00 0.40 1 1
staticRACfarCfg -1 6 2 2 2 8 8 6 4 5.00 15.00 0.30 0 0
dynamicRangeAngleCfg -1 0.75 0.0010 1 0
dynamic2DAngleCfg -1 1.5 0.0300 1 0 1 0.30 0.85 8.00
staticRangeAngleCfg -1 0 8 8
fineMotionCfg -1 1 1.0 10 2
antGeometry0 0 -1 -2 -3 -2 -3 -4 -5 -4 -5 -6 -7
antGeometry1 -1 -1 -1 -1 0 0 0 0 -1 -1 -1 -1
antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 1
fovCfg -1 70.0 20.0
compRangeBiasAndRxChanPhase 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0
"""
OUT_OF_BOX = """
cfarCfg -1 0 2 8 4 3 0 15 1
cfarCfg -1 1 0 4 2 3 1 15 1
clutterRemoval -1 1
"""
HEIGHT_M = 1.5
WALKER = {"range_m": 5.5, "angle_deg": 180, "cross_range_m": 0.6}
OTHER = {"activity": "walking", "motion": {"range_m": 2.0, "angle_deg": 10, "cross_range_m": -0.8}}
# Name, activity, motion, other people, frames that are drawn; every tenth has fine motion.
SCENES: tuple[tuple[str, str, Any, list[Any], tuple[int, ...]], ...] = (
    ("walks", "walking", WALKER, [], (5, 25, 45, 55)),
    ("two walk", "walking", WALKER, [OTHER], (5, 25, 45, 55)),
    ("stands", "stationary", {"range_m": 3.0, "angle_deg": 180}, [], (25, 30, 35, 50)),
    ("falls, lies", "falling", {"range_m": 3.0, "angle_deg": 90}, [], (4, 9, 16, 60)),
)
MORE_FRAMES = 5  # of a scene than the last that is drawn
PIXELS_PER_METRE, WIDTH_M, FAR_M, TALL_M = 34, 4.0, 6.2, 2.2
GREY, RED, BLUE, BLACK = (150, 150, 150), (205, 30, 30), (30, 60, 205), (0, 0, 0)
LINE = 22  # height of a line of the legend, px
SLOW_MPS = 0.08  # highest speed of points at rest


def make_clouds(
    activity: str, motion: Any, others: list[Any], count: int, seed: int
) -> tuple[dict[str, Cloud], Float]:
    """Make clouds of a scene by both chains.

    Args:
        activity: What the first person does.
        motion: `motion` of it.
        others: `people`.
        count: Number of frames.
        seed: Seed of the scene.

    Returns:
        {chain: cloud}, and joints [frame, person, joint, (ahead, left, up)] of the radar, m.
    """
    named = activity_named(activity)
    radar = {"device": "IWR6843ISK", "cfg": CFG, "position_m": [0, 0, HEIGHT_M], "tilt_deg": 0}
    document = {
        "radar": radar,
        "activities": [activity],
        "duration_s": count * 0.055 + 0.01,
        "maps": ["points"],
        "body": {"scatterers": "surfaces"},
        "motion": motion,
        "people": others,
        "timing": {"onset": 0.1},
        "on_invalid": "keep",
        "seed": seed,
    }
    scene = draw_scene(Config.model_validate(document), named, 1)
    made = record(scene, ["cube", "board", "cloud", "skeleton"])
    board = made["board"]
    demo = read_detection(split_lines(OUT_OF_BOX, "demo"), board.channels, board.n_fft)
    clouds = {
        "people tracking": made["cloud"],
        "out of box": board_points(made["cube"], board, demo, quantise=True),
    }
    return clouds, made["skeleton"]


def draw_frame(points: Float, skeletons: Float, title: str) -> Image.Image:
    """Draw points [n, 8] and joints [person, joint, 3] of a frame, from above and as seen."""
    scale, width = PIXELS_PER_METRE, round(WIDTH_M * PIXELS_PER_METRE)
    above, front = round(FAR_M * scale), round(TALL_M * scale)
    picture = Image.new("RGB", (width + 2, above + front + 4), "white")
    draw = ImageDraw.Draw(picture)

    def place(p: Float) -> list[Float]:
        """Pixels of positions [..., 3] in both views."""
        x = width / 2 - p[..., 1] * scale
        return [
            np.stack([x, above - p[..., 0] * scale], axis=-1),
            np.stack([x, above + front - (p[..., 2] + HEIGHT_M) * scale], axis=-1),
        ]

    for metre in range(1, int(FAR_M) + 1):
        y = above - metre * scale
        draw.line([(0, y), (width, y)], fill=(232, 232, 232))
        if metre + 0.5 < FAR_M:  # below the title
            draw.text((width - 2, y), f"{metre} m", fill=GREY, anchor="rd")
    draw.line([(0, above), (width, above)], fill=GREY)
    draw.line([(0, above + front), (width, above + front)], fill=GREY)
    for joints in skeletons[np.isfinite(skeletons).all(axis=(1, 2))]:
        for view in place(joints):
            for joint, parent in enumerate(PARENTS):
                if parent is not None:
                    draw.line([*view[parent].tolist(), *view[joint].tolist()], fill=GREY, width=2)
    for view in place(points[:, :3]):
        for (x, y), speed in zip(view.tolist(), points[:, 3].tolist(), strict=True):
            colour = BLACK if abs(speed) < SLOW_MPS else RED if speed > 0 else BLUE
            draw.ellipse([x - 2, y - 2, x + 2, y + 2], outline=colour, fill=colour)
    draw.text((3, 2), f"{title}: {len(points)} points", fill=BLACK)
    draw.rectangle([0, 0, width + 1, above + front + 3], outline=GREY)
    return picture


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rows: list[Float] = []
    for name, activity, motion, others, frames in SCENES:
        clouds, skeletons = make_clouds(
            activity, motion, others, frames[-1] + MORE_FRAMES, arguments.seed
        )
        row: list[Float] = []
        for chain, cloud in clouds.items():
            counts = np.diff(cloud.start)
            print(f"{name}, {chain}: {counts.mean():.1f} points a frame, {counts.tolist()}")
            row += [
                np.asarray(
                    draw_frame(
                        cloud.points[cloud.start[f] : cloud.start[f + 1]],
                        skeletons[f],
                        (f"{name}, {chain}\n" if f == frames[0] else "") + f"frame {f}",
                    )
                )
                for f in frames
            ]
        rows.append(np.concatenate(row, axis=1))
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / "clouds.png"
    _with_legend(Image.fromarray(np.concatenate(rows))).save(path, optimize=True)
    record_pictures([path], "python scripts/draw_clouds.py")


def _with_legend(cells: Image.Image) -> Image.Image:
    """Cells with the meaning of their colours and views above, and of empty ones."""
    sheet = Image.new("RGB", (cells.width, cells.height + 2 * LINE), "white")
    sheet.paste(cells, (0, 2 * LINE))
    draw, x, font = ImageDraw.Draw(sheet), 4.0, ImageFont.load_default(13)
    for words, colour in (
        ("approaching", RED),
        ("receding", BLUE),
        (f"at rest (below {SLOW_MPS} m/s)", BLACK),
        ("skeleton", GREY),
        ("upper parts: from above, the radar at 0 m; lower parts: as the radar sees it", BLACK),
    ):
        draw.text((x, 2), words, fill=colour, font=font)
        x += draw.textlength(words, font) + 18
    words = (
        "Left half: people tracking. Right half: out-of-box demo, whose grouping of peaks leaves "
    )
    words += "a point or two of a person, and whose clutter removal leaves none of who is at rest."
    draw.text((4, LINE + 2), words, fill=BLACK, font=font)
    return sheet


if __name__ == "__main__":
    main()
