"""Frequency: work that is the same in every pixel, computed once per frame."""
