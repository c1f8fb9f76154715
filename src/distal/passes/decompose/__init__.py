"""Decompose: replace built-ins and statements that a target lacks by ones that it has."""
