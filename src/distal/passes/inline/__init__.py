"""Inline: replace calls by the callee's statements."""
