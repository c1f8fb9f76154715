"""The field library: shapes and operators, written once as scene code.

A field is a function of a point that answers how far the nearest surface is. Each is declared with
what it guarantees (``guarantees``); the object model, the documentation and the tests read that.
"""
