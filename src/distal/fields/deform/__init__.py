"""Operators that change a shape: bending, folding, offsets, shells."""
