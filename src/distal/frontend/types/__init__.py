"""The typing rules of scene code: Python values, coercion, unification, operators, constructors."""
