"""Specialise: bind function, texture and constant arguments to the functions that take them."""
