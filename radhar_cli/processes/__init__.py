"""Processes: interruption, time limits, progress, settings of workers."""
