"""One scene: drawn, built of objects of physics, computed, checked and written."""
