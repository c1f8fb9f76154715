"""The tree behind shapes, and the checked arguments of its nodes."""
