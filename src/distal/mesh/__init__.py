"""Meshes: triangles of a shape's surface, closed, with sharp edges, in the shape's units."""
