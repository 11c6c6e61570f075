"""Recordings of movements: joints over frames in units and axes of their file."""
