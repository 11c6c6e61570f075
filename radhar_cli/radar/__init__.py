"""The radar and the space between it and the scatterers."""
