"""One interface to everything that can be viewed, and the movement of cameras by a person."""
