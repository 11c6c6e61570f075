"""A scene of a class of files -> a person who moves as one of them."""

from collections import OrderedDict
from math import radians
from pathlib import Path
from typing import Any

from radhar_cli.config.schema import FilesConfig
from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.clip import Clip, clip_of
from radhar_cli.motion.files.cycle import find_cycle
from radhar_cli.motion.files.motion import FileMotion
from radhar_cli.motion.files.reading import read_motion
from radhar_cli.scene import Person

KEPT_BYTES = 2**26  # size of the cache of clips in a process
_clips: OrderedDict[tuple[Any, ...], Clip] = OrderedDict()


def file_motion(person: Person) -> FileMotion:
    """The motion of a person whose class has files; MotionFileError of one that cannot be used."""
    one, slug = person.config.files_of(person.activity), person.activity.slug
    folder = person.motion.folder
    assert one is not None
    assert one.file is not None
    numbers = person.own_class
    path, checksum = [*one.files.items()][one.file]
    if folder is None:
        raise MotionFileError(f"{path}: where the files of {slug} lie is not known: motion.folder")
    clip = _clip(one, Path(folder), path, checksum)
    begin, end = one.section_s or (0.0, clip.seconds)
    end = min(end, clip.seconds)
    if begin >= end:
        raise MotionFileError(
            f"{path}: lasts {clip.seconds:.3g} s; classes.{slug}.section_s begins at {begin:g} s"
        )
    seconds, speed = person.seconds, numbers.playback_speed
    spare = end - begin - speed * seconds
    cycle = find_cycle(clip, begin, end) if one.past_end == "loop" and spare < 0 else None
    latest = cycle.period if cycle else max(0.0, spare)  # s after the beginning
    return FileMotion(
        clip=clip,
        stature=person.subject.height_m,
        weight=person.subject.weight_kg,
        start=(person.motion.range_m, person.motion.cross_range_m),
        heading=radians(person.motion.angle_deg),
        seconds=seconds,
        begin=begin + numbers.start * latest,
        end=end,
        speed=speed,
        mirrored=numbers.mirror >= 0.5,
        cycle=cycle,
    )


def _clip(one: FilesConfig, folder: Path, path: str, checksum: str) -> Clip:
    """The clip of a file, kept for the next scene that uses it."""
    joints = tuple(sorted(one.joints.items()))
    how = (joints, one.up, one.unit_m, one.rate_hz, one.low_pass_hz)
    key = (folder, path, checksum, one.skeleton, *how)
    if key in _clips:
        _clips.move_to_end(key)
        return _clips[key]
    read = read_motion(folder / path, folder / one.skeleton if one.skeleton else None)
    if checksum and read.checksum != checksum:
        raise MotionFileError(f"{read.path}: is not the file it was: its SHA-256 is another")
    clip = clip_of(
        read.recording(path), one.joints, one.up, one.unit_m, one.rate_hz, one.low_pass_hz
    )
    _clips[key] = clip
    while len(_clips) > 1 and sum(c.positions.nbytes for c in _clips.values()) > KEPT_BYTES:
        _clips.popitem(last=False)
    return clip
