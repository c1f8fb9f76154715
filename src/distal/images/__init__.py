"""Images: finished pictures, and the files they are saved in.

Takes arrays of pixels from a device; gives ``Picture``, PNG and OpenEXR files. Does not depend on
scenes, devices or the compiler. ``images.atomic_files`` needs no third-party package,
``images.picture`` needs NumPy.
"""
