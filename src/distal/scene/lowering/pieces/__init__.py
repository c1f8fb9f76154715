"""Any tree of shapes as pieces: boxes, each with a short program of the shapes within it."""
