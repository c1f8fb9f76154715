"""The field library: shapes and operators, each written once as scene code.

A field is a function of a point that returns the distance to the nearest surface, negative inside.
Each field is declared with its guarantees (``guarantees``); the object model, the documentation and
the tests read these declarations.
"""
