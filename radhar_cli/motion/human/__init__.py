"""People who move like people."""
