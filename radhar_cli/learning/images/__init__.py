"""Labelled images, whoever stored them."""
