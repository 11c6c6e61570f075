"""What a key of a config is: a number or its law, a section, and what is said of it."""
