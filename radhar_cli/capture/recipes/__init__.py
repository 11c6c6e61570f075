"""Recipes: how a published set of recordings lies in its folder, a file each.

A recipe is a function that lists takes by the names of files (`recipe.py`), what there is to say of
the set, and a line of `RECIPES` in `registry.py`. `radhar prepare` does all else.
"""
