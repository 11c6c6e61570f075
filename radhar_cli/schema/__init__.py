"""Keys of a config: a number or its law, a section, and their annotations."""
