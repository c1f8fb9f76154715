"""Operators that repeat a shape: on a grid, along a line, around an axis."""
