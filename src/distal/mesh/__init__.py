"""Meshes of shapes, and the files in which they are saved.

Input: shapes, and arrays of points and triangles. Output: meshes, files for printers, viewers and
CAD programs. Needs NumPy; imports nothing by itself.
"""
