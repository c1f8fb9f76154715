"""Checks of scenes: validation, warnings, measured bounds, and what one pixel saw."""
