"""The typing rules of scene code: coercion, unification, operators, constructors."""
