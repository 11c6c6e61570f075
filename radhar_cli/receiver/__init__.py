"""What a receiver does to an echo: noise and other impairments."""
