"""What `radhar convert` writes: a module a format, each with `write(data, folder, progress)`."""
