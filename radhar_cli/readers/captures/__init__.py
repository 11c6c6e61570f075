"""Recordings of radars, and the headers that say what their samples are."""
