"""Signatures, scopes and overloads of scene functions."""
