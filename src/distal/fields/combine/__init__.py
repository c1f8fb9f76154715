"""Operators of two shapes: unions, intersections, differences, blends, transitions."""
