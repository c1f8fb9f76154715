"""Fold: constants computed, expressions simplified."""
