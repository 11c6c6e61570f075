"""Labelled images from dataset.h5, from a tree of class folders, or synthesised when read."""
