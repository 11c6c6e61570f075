"""How well the class of a sample can be told from what is not its movement."""
