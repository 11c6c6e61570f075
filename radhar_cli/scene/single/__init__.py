"""One scene with everything there is to see of it, and its files."""
