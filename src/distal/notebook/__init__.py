"""Notebooks: a live picture in a cell, its parameters bound both ways to Python.

What flows in: a scene, a shape or an image. What flows out: a widget. The picture is drawn by the
player of exported pages; Python and the browser share its state only.
"""
