"""Captures of real radars (`readers.captures`) -> recordings -> maps, fitted configs and data sets.

subframes     the header of a capture, from a file (ti_header, config_header) or by hand
findings      estimates from the samples: offset binary, sign of the beat, clipping, losses
content       content of the samples of a recording: beat signals, range profiles or slow time
recording     the recording file itself: docs/guide/measured.md
importing     converts a capture of any format into a recording
chain         the maps of a recording; tracking: the torso's track; maps_file: maps.h5
fitting       a simulation config, estimated from recordings
importing_points  converts points of a board (`readers.points`) into a recording of points
point_recording  the file of points: docs/guide/points.md
windows       a data set of windows of recordings; images: of existing images
"""
