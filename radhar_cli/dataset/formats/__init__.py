"""Formats of `radhar convert`: a module each, with `write(data, folder, progress)`."""
