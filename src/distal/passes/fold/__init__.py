"""Fold: compute constants and simplify expressions."""
