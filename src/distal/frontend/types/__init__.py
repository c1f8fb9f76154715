"""The typing rules of scene code: Python objects, coercion, unification, operators, constructors."""
