"""Limits of the numbers of a config, and the consequences beyond them: radhar limits."""
