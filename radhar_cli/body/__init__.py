"""Thirteen scatterers that move: skeleton, angles over time, positions."""
