"""The native window: a scene shown live, steered by hand, and loaded again when its file is saved.

Input: a loaded scene and where it came from. Output: a window, until it is closed.
``session`` is what a person has done so far, and knows no display; ``app`` joins it to one.
"""
