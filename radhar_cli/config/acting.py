"""Conditions under which a key acts that several sections share."""

from radhar_cli.config.annotations import OfRadar, OnlyMaps, Unless

BOARD = OfRadar("board")
NO_BOARD = OfRadar("fmcw", "sfcw", "cw", "impulse")
NO_IMPULSE = OfRadar("fmcw", "sfcw", "cw", "board")
EVEN = Unless("radar.frames_apart", "the pauses between a board's frames (radar.cfg)")


SPECTRA = OnlyMaps("st")  # of stft and fsst
