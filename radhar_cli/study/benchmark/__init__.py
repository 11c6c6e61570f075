"""Benchmark of simulators on public measured sets: radhar benchmark.

A protocol (`protocols.py`) names a recipe of `radhar prepare`, the simulation that stands beside it
and the network. `sets.py` finds, prepares and simulates, `engine.py` trains and tests, row by row.
"""
