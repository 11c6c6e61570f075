"""Scene -> maps: the physics objects of a scene, the stages a request needs, and their order."""
