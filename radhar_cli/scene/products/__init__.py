"""What is computed of a scene: the table of products, their plan and its run."""
