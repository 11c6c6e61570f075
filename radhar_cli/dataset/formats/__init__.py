"""Formats of `radhar convert`: functions of (data, folder, progress)."""
