"""Pixels of pictures that others made, by one rule for each mode and type.

Input: a file, a picture of Pillow, an array or nested lists. Output: float32 (height, width, 4) and
whether they are encoded for display. Does not depend on scenes or devices.
"""
