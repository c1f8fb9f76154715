"""The objects that an author creates: shapes, materials, patterns, lights, cameras, backgrounds."""
