"""Figures of scenes, data sets and results: PNG and GIF files, and an HTML page."""
