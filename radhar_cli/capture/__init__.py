"""Captures of real radars -> recordings -> maps, fitted configs and data sets.

settings      the header of a capture, from a file or by hand
formats       the formats of captures, a row each
dca1000       raw samples of TI's capture card
array_files   .npy, .npz, .mat, HDF5; wav_files, text_files; packed_files: .xz, .gz, .bz2
named_parts   names by which I, Q and times are found
findings      estimates from the samples: offset binary, sign of the beat, clipping, losses
content       what the samples of a recording are: beat signals, range profiles or slow time
recording     the recording file itself: docs/guide/measured.md
importing     converts a capture of any of these formats into a recording
chain         the maps of a recording; tracking: the torso's track; maps_file: maps.h5
fitting       a simulation config, estimated from recordings
importing_points  converts a dump of points, or JSON of TI's visualizer, into a recording of points
uart_packets  packets of a dump; point_messages: points of their messages; visualizer_json: of JSON
point_recording  the file of points, of frames as point_frames has them: docs/guide/points.md
windows       a data set of windows of recordings; images: of existing images
"""
