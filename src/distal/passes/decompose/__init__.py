"""Decompose: built-ins and statements that a target lacks, expressed by those that it has."""
