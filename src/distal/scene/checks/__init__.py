"""Checks of scenes: validation, warnings, measured bounds, and a report about one pixel."""
