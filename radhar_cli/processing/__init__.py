"""Maps and images of a beat matrix or slow-time signal, simulated or recorded."""
