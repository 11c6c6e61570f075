"""Checks that span several sections of a config."""
