"""Flat shapes: fields of a point in the plane."""
