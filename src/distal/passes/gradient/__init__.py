"""Gradient: forward-mode differentiation of functions."""
