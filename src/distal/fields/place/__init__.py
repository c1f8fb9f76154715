"""Operators that translate, rotate, scale, shear and mirror a shape."""
