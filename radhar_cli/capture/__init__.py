"""Recordings of a real radar: captures of others come in, one kind of file comes out.

settings      what a capture's header should say, from a file or by hand
ti_header     the header of TI's mmWave Studio (JSON) and of its SDK demos (.cfg)
dca1000       raw samples of TI's capture card
array_files   .npy, .npz, .mat, HDF5
sigmf_file    SigMF, in and out
findings      what only the samples tell: offset binary, sign of the beat, clipping, losses
recording     the recording file itself: docs/measured.md
importing     all of it together
"""
