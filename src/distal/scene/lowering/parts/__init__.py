"""Tables of parts: a union of many shapes as a few kinds of shapes with rows of numbers."""
