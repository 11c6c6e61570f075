"""Conditions under which a key acts that several sections share."""

from radhar_cli.config.annotations import GIVEN, ActsIf, OnlyMaps, Unless

BOARD, NO_BOARD = ActsIf("radar.cfg", GIVEN), ActsIf("radar.cfg", None)


NO_IMPULSE = ActsIf("radar.waveform", "fmcw", "sfcw", "cw")


EVEN = Unless("radar.frames_apart", "the pauses between a board's frames (radar.cfg)")


SPECTRA = OnlyMaps("st")  # of stft and fsst
