"""Frequency: move work that is the same in every pixel to once per frame."""
