"""Gradient: forward-mode derivatives of functions."""
