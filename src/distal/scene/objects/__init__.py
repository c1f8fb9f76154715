"""The objects that an author creates: shapes, materials, patterns, lights, cameras, backgrounds."""

# Loaded before modules of the field library that are imported by name: shapes and operators are
# listed in the order of their declaration.
import distal.fields.library  # noqa: F401
