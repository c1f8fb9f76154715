"""The typed intermediate representation: types, nodes, the table of built-ins, the rules."""
