"""Notebooks: a live picture in a cell, whose parameters are bound both ways to Python.

Input: a scene, a shape or an image. Output: a widget. The player of exported pages draws the
picture; Python and the browser share only its state.
"""
