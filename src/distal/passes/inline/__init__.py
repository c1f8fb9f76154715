"""Inline: calls replaced by the callee's statements."""
