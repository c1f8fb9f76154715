"""Scenes as objects: shapes, materials, lights, cameras; they make IR of library functions."""
