"""How far each number of a config may go, and what happens beyond: radhar limits."""
