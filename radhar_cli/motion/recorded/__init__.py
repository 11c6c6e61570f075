"""Recorded movements: the thirteen joints of a file's joints, and how they move.

MotionRecording (joints over frames, by `readers.motion`) -> Clip (thirteen joints, m) -> FileMotion
"""
