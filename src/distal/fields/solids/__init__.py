"""Solid shapes: fields of a point in space."""
