"""Lowering: trees of shapes, and scenes, to functions of the IR."""
