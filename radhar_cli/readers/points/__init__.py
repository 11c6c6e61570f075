"""Points that boards of TI have sent: bytes of the data port, and what the visualizer kept."""
