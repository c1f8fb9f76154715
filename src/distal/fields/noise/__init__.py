"""Noise functions, and shapes made of noise."""
