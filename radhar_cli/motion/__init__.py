"""Where joints are at any time: people who move like people, and whoever else is added."""
