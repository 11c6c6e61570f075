"""Noise and other impairments by which a receiver changes an echo."""
