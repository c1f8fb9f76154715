"""Meshes and volumes of others: reading their files, and distances to them on a grid.

Input: files of triangles (STL, OBJ, PLY, GLB, 3MF) and of volumes (NRRD, NIfTI, NumPy), or arrays.
Output: arrays, and grids of signed distances. The geometry is scene code, compiled for the CPU.
Needs NumPy. Does not depend on shapes or scenes.
"""
