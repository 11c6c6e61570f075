"""Warnings of a config or a scene before anything is computed."""

from collections.abc import Mapping
from typing import Any

from radhar_cli.config.checks.board_doubts import angle_warnings, board_warnings
from radhar_cli.config.checks.doubts import (
    band_warnings,
    timing_warnings,
    tolerance_warnings,
    tone_warnings,
    word_warnings,
)
from radhar_cli.config.checks.unused_keys import unused_keys
from radhar_cli.config.data_set import Config
from radhar_cli.errors import SceneError
from radhar_cli.radar.propagation import leg
from radhar_cli.scene.checks.drawing import CROWDED, describe_crowd, find_crowded, suggest_cure
from radhar_cli.scene.checks.flags import Flags, describe_flag, describe_flags
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.checks.visibility import chest_point, looks_away, noise_alone
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.room import ways_of
from radhar_cli.scene.scene import Scene, nominal_scene


def config_warnings(config: Config) -> list[str]:
    """Warn of keys and lines without effect, of aliases, and of maps that are noise alone."""
    return [*word_warnings(config), *unused_keys(config), *warnings_of_signal(config)]


def warnings_of_signal(config: Config) -> list[str]:
    """Warn of aliases, and of maps that are noise alone, whatever keys have no effect."""
    noise = noise_alone(config)
    return [
        *tone_warnings(config),
        *band_warnings(config),
        *board_warnings(config),
        *noise,
        *(() if any("the beam" in line for line in noise) else looks_away(config)),
        *_folding_warnings(config),
        *angle_warnings(config),
        *tolerance_warnings(config),
    ]


def _folding_warnings(config: Config) -> list[str]:
    """Warn of echoes by way of faces that come from beyond the ranges that the radar has."""
    if config.room.faces is None or not config.radar.sweeps:
        return []
    farthest, reach = 0.0, 0.0
    for activity in config.chosen_activities:
        scene = nominal_scene(config, activity)
        antennas, person = antennas_of(scene), scene.people[0]
        p = chest_point(person)
        for tx, rx in ways_of(scene):
            both_legs = leg(tx.image(p), antennas.tx) + leg(rx.image(p), antennas.rx)
            farthest = max(farthest, float(both_legs[0, 0]) / 2)
        reach = waveform_of(scene).half_band_range
    if farthest < reach:
        return []
    return [
        f"echoes by way of room.faces come from up to {farthest:.3g} m, beyond the range half-band "
        f"of {reach:.3g} m: they are missing from maps, or alias (radar.adc_rate_hz, room.order)"
    ]


def scene_warnings(scene: Scene) -> list[str]:
    """Check one scene, which keeps 5 cm from antennas, and return its warnings, in words."""
    number = find_crowded(scene)
    if number is not None:
        raise SceneError(f"{scene.name}: {describe_crowd(number)}; {CROWDED}")
    check = check_scene(scene)
    if check.too_close:
        raise SceneError(f"{scene.name}: {check.invalid}; {suggest_cure(scene.people[0], check)}")
    flags = check.flags & ~Flags.BRIDGED  # which is said with joints and frames
    lines = [describe_flag(flag, scene.config) for flag in Flags if flag in flags]
    if check.outside[1] and check.invalid is not None:
        lines[0] = check.invalid
    lines += _file_notes(scene)
    return lines + config_warnings(scene.config) + timing_warnings(scene.config, (scene.activity,))


def _file_notes(scene: Scene) -> list[str]:
    """List the gaps that are bridged in the motion files of a scene, and other remarks on them."""
    clips = [getattr(motion_of(person), "clip", None) for person in scene.people]
    return [
        f"{clip.where}: {note}"
        for clip in clips
        if clip is not None
        for note in (clip.bridged, *clip.remarks)
        if note
    ]


def collect_warnings(
    config: Config, counts: Mapping[Flags, int], recordings: int | None = None
) -> list[dict[str, Any]]:
    """Collect the warnings of a run, each once: [{kind, recordings, message}].

    Args:
        counts: number of recordings with each flag.
        recordings: number of all recordings; None for those of the config.
    """
    recordings = recordings or sum(map(config.samples_of, config.chosen_activities))
    messages = [
        {"kind": "config", "recordings": recordings, "message": message}
        for message in config_warnings(config)
    ]
    timings = [
        {"kind": "timing", "recordings": config.samples_of(activity), "message": message}
        for activity in config.chosen_activities
        for message in timing_warnings(config, (activity,))
    ]
    return [*describe_flags(counts, recordings, config), *messages, *timings]
