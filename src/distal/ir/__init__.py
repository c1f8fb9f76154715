"""The typed intermediate representation (IR): types, nodes, intrinsics and the verifier."""
