"""Costs and savings of settings: radhar tradeoff."""
