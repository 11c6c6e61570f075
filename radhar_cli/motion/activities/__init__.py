"""The activities, their movements, and other words for them."""
