"""Finished pictures, and the files in which they are saved.

Input: arrays of pixels from a device. Output: ``Picture``, PNG and OpenEXR files. Does not depend
on scenes, devices or the compiler. ``images.picture`` needs NumPy.
"""
