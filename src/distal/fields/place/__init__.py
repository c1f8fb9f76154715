"""Operators that move, turn, scale, shear and mirror a shape."""
