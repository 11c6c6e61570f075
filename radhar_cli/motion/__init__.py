"""Motion of people: the `Motion` protocol, the paper's model, the human one, and their skeleton."""
