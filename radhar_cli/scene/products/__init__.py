"""Products of a scene: their table, their plan and its run."""
