"""What a setting costs and what it gives: radhar tradeoff."""
