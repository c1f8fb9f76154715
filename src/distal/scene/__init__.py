"""Scenes as objects: shapes, materials, lights, cameras; they make IR of the library's functions."""
