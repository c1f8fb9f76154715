"""The native window: shows a scene live, moves its camera, and reloads its file when it is saved.

Input: a loaded scene and its file. Output: a window, until it is closed. ``session`` is the state
of the interaction, without a display; ``app`` connects it to a display.
"""
