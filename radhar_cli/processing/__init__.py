"""From a beat matrix or a slow-time signal, whoever recorded it, to maps and images."""
