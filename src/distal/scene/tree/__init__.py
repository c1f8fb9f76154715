"""The tree of nodes behind a shape, and the checks of its arguments."""
