"""The objects that an author creates: shapes, materials, patterns, lights, cameras, backgrounds."""

# Import the whole field library first: shapes and operators are listed in the order of their
# declaration, so its modules must not be imported one by one before.
import distal.fields.library  # noqa: F401
