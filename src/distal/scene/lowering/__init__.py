"""Lowering of scenes and of trees of shapes to functions of the IR."""
