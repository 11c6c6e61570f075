"""Paths of bodies: delay and amplitude of every echo of points, ellipsoids and surfaces."""
