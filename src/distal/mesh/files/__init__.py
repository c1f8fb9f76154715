"""Files of meshes and outlines: one module per format, declared in ``formats``.

Input: arrays of points and triangles, or of polylines. Output: a file, replaced in one step. Needs
NumPy and the standard library. Does not depend on how a mesh was made.
"""
