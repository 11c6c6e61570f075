"""Limits of a scene: where models end, what noise hides, which keys do nothing."""
