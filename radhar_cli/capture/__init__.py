"""Captures of real radars -> recordings -> maps, fitted configs and data sets.

settings      the header of a capture, from a file or by hand
formats       the formats of captures, a row each
dca1000       raw samples of TI's capture card
array_files   .npy, .npz, .mat, HDF5
findings      estimates from the samples: offset binary, sign of the beat, clipping, losses
content       what the samples of a recording are: beat signals, range profiles or slow time
recording     the recording file itself: docs/guide/measured.md
importing     converts a capture of any of these formats into a recording
chain         the maps of a recording; tracking: the torso's track; maps_file: maps.h5
fitting       a simulation config, estimated from recordings
windows       a data set of windows of recordings; images: of existing images
"""
