"""Motion of a person whose class has motion files."""

from collections import OrderedDict
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any

from radhar_cli.config.classes import FilesConfig
from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip, make_clip, require_complete
from radhar_cli.motion.recorded.cycle import find_cycle
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.readers.motion.reading import read_motion
from radhar_cli.scene.place import start_of
from radhar_cli.scene.scene import Person

CACHE_BYTES = 2**26  # size of the cache of clips in a process
_clips: OrderedDict[tuple[Any, ...], Clip] = OrderedDict()


def file_motion(person: Person) -> FileMotion:
    """Motion of a person whose class has files.

    Raises:
        MotionFileError: The file of this sample is missing, changed, or cannot be used.
    """
    files_config, slug = person.config.files_of(person.activity), person.activity.slug
    folder = person.motion.folder
    assert files_config is not None
    assert files_config.file is not None
    numbers = person.own_class
    assert isinstance(numbers, FilesConfig)
    path, checksum = [*files_config.files.items()][files_config.file]
    if folder is None:
        raise MotionFileError(f"{path}: where the files of {slug} lie is not known: motion.folder")
    clip = _cached_clip(files_config, Path(folder), path, checksum)
    begin, end = files_config.section_s or clip.usable or (0.0, clip.seconds)
    end = min(end, clip.seconds)
    require_complete(clip, begin, end)
    if begin >= end:
        raise MotionFileError(
            f"{path}: lasts {clip.seconds:.3g} s; classes.{slug}.section_s begins at {begin:g} s"
        )
    seconds, speed = person.seconds, numbers.playback_speed
    spare = end - begin - speed * seconds
    cycle = find_cycle(clip, begin, end) if files_config.past_end == "loop" and spare < 0 else None
    latest = cycle.period if cycle else max(0.0, spare)  # s after the beginning
    motion = FileMotion(
        clip=clip,
        stature=person.subject.height_m,
        weight=person.subject.weight_kg,
        start=(0.0, 0.0),
        heading=radians(person.motion.angle_deg),
        seconds=seconds,
        begin=begin + numbers.start * latest,
        end=end,
        speed=speed,
        mirrored=numbers.mirror >= 0.5,
        cycle=cycle,
    )
    return replace(motion, start=start_of(person, motion))


def _cached_clip(files_config: FilesConfig, folder: Path, path: str, checksum: str) -> Clip:
    """Clip of a file, kept for the next scene that uses it."""
    named = files_config.joints
    joints = (
        named if isinstance(named, str) else tuple(sorted((k, str(v)) for k, v in named.items()))
    )
    reading_options = (
        joints,
        files_config.up,
        files_config.unit_m,
        files_config.rate_hz,
        files_config.low_pass_hz,
        files_config.travel,
        files_config.left_handed,
    )
    key = (folder, path, checksum, files_config.skeleton, *reading_options)
    if key in _clips:
        _clips.move_to_end(key)
        return _clips[key]
    motion_bytes = read_motion(
        folder / path, folder / files_config.skeleton if files_config.skeleton else None
    )
    if checksum and motion_bytes.checksum != checksum:
        raise MotionFileError(
            f"{motion_bytes.path}: is not the file it was: its SHA-256 is another"
        )
    clip = make_clip(
        motion_bytes.recording(path),
        files_config.joints,
        *reading_options[1:],
    )
    _clips[key] = clip
    while len(_clips) > 1 and sum(c.positions.nbytes for c in _clips.values()) > CACHE_BYTES:
        _clips.popitem(last=False)
    return clip
