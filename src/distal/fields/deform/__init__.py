"""Operators that deform a shape: bending, folding, offsets, shells."""
