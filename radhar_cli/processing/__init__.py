"""From a simulated or recorded beat matrix or slow-time signal to maps and images."""
