"""A scene of a class of files -> a person who moves as one of them."""

from collections import OrderedDict
from math import radians
from pathlib import Path
from typing import Any

from radhar_cli.config.schema import FilesConfig
from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.clip import Clip, clip_of
from radhar_cli.motion.files.motion import FileMotion
from radhar_cli.motion.files.reading import read_motion
from radhar_cli.scene import Scene

KEPT_BYTES = 2**26  # size of the cache of clips in a process
_clips: OrderedDict[tuple[Any, ...], Clip] = OrderedDict()


def file_motion(scene: Scene) -> FileMotion:
    """The motion of a scene whose class has files.

    Raises:
        MotionFileError: the file cannot be used; names file, line and what is missing or odd.
    """
    config = scene.config
    one = config.files_of(scene.activity)
    assert one is not None
    assert one.file is not None
    path, checksum = [*one.files.items()][one.file]
    if config.motion.folder is None:
        raise MotionFileError(
            f"{path}: where the files of {scene.activity.slug} lie is not known: motion.folder"
        )
    clip = _clip(one, Path(config.motion.folder), path, checksum)
    begin, end = one.section_s or (0.0, clip.seconds)
    end = min(end, clip.seconds)
    if begin >= end:
        raise MotionFileError(
            f"{path}: lasts {clip.seconds:.3g} s; classes.{scene.activity.slug}.section_s "
            f"begins at {begin:g} s"
        )
    seconds, speed = _f(config.duration_s), _f(one.playback_speed)
    return FileMotion(
        clip=clip,
        stature=_f(config.subject.height_m),
        weight=_f(config.subject.weight_kg),
        start=(_f(config.motion.range_m), _f(config.motion.cross_range_m)),
        heading=radians(_f(config.motion.angle_deg)),
        seconds=seconds,
        begin=begin + _f(one.start) * max(0.0, end - begin - speed * seconds),
        end=end,
        speed=speed,
        mirrored=_f(one.mirror) >= 0.5,
        rests=one.past_end == "rest",
    )


def _f(number: object) -> float:
    """A number of a scene's config, none left to draw."""
    assert isinstance(number, (int, float)), number
    return float(number)


def _clip(one: FilesConfig, folder: Path, path: str, checksum: str) -> Clip:
    """The clip of a file, kept for the next scene that uses it."""
    joints = tuple(sorted(one.joints.items()))
    key = (folder, path, checksum, joints, one.up, one.unit_m, one.rate_hz, one.low_pass_hz)
    if key in _clips:
        _clips.move_to_end(key)
        return _clips[key]
    read = read_motion(folder / path, None if one.skeleton is None else folder / one.skeleton)
    if checksum and read.checksum != checksum:
        raise MotionFileError(f"{read.path}: is not the file it was: its SHA-256 is another")
    clip = clip_of(
        read.recording(path), one.joints, one.up, one.unit_m, one.rate_hz, one.low_pass_hz
    )
    _clips[key] = clip
    while len(_clips) > 1 and sum(c.positions.nbytes for c in _clips.values()) > KEPT_BYTES:
        _clips.popitem(last=False)
    return clip
