"""Read signatures: annotations, and the parameters and results that ``def`` lines declare."""
