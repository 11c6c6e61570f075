"""Captures of real radars -> recordings -> maps, fitted configs and data sets.

settings      what a capture's header should say, from a file or by hand
ti_header     the header of TI's mmWave Studio (JSON) and of its SDK demos (.cfg)
dca1000       raw samples of TI's capture card
array_files   .npy, .npz, .mat, HDF5
sigmf_file    SigMF, in and out
findings      what only the samples show: offset binary, sign of the beat, clipping, losses
recording     the recording file itself: docs/measured.md
importing     a capture of any of these formats becomes a recording
chain         the maps of a recording; tracking: the torso's track; maps_file: maps.h5
fitting       a config to simulate by, estimated from recordings
windows       a data set of the windows of recordings; images: of images that exist already
"""
