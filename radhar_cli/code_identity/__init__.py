"""What identifies code: the build of radhar, and extensions of the user's."""
