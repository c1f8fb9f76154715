"""Sounds from files: reading, and what pictures read of them."""
