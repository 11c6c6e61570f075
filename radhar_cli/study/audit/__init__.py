"""Audit of a data set: evidence beside the movement that tells the class of a sample."""
