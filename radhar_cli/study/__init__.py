"""Studies of a config: settings are varied one after the other, run, compared and reported."""
