"""The reference backend: interprets the IR on NumPy arrays."""
