"""Readers of files that anyone may have written: one file a format, each bounded in size and time.

A reader knows what the maker of a format documents. The rest it refuses in one line, which names
the key to give. `motion` has movements (BVH, AMC, C3D, TRC, tables, JSON, arrays), `captures`
signals of radars (arrays, text, sound, what makers' software writes), `points` what boards have
sent, `ti` TI's .cfg and the headers of mmWave Studio, and `untrusted_hdf5` HDF5 of any kind.
"""
