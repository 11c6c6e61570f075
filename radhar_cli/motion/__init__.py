"""How people move: the `Motion` protocol, the paper's model, and the body that both share."""
