"""Two scatterers whose samples programs of other authors computed, for several boards."""

P, V, A = [(2, 0.3, -0.1), (1.5, -0.4, 0.6)], [(-1, 0.2, 0), (0.5, 0, 0.3)], [1, 0.5]
