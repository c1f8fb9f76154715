"""Notebooks: a live picture in a cell, its parameters bound both ways to Python.

Input: a scene, a shape or an image. Output: a widget. The picture is drawn by the
player of exported pages; Python and the browser share its state only.
"""
