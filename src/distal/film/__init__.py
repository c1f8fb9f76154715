"""Film: finished pictures and how they reach a file or a notebook.

What flows in: arrays of pixels from a device. What flows out: ``Picture``, and PNG files. Knows
nothing about scenes, devices or compilation. Import the rooms by name: ``film.replacement`` needs
no third-party package, ``film.picture`` needs numpy.
"""
