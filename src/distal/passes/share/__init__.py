"""Share: compute common subexpressions once, and split deep expressions."""
