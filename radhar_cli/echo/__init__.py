"""Paths -> echo. An engine sums paths, a delay and an amplitude each; it knows no people."""
