"""Objects of physics, assembled from the numbers of a scene."""
