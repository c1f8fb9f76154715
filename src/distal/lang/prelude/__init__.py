"""The prelude: built-ins written in scene code, for targets that lack them or for all targets.

The intrinsics in ``distal.ir.intrinsics`` name these ``@func`` functions as ``module.function``;
the decompose pass replaces calls of the intrinsics by calls of them. They are compiled by the same
front end as an author's code and do not depend on a target. The pass applies a function for
scalars to each component of a vector.
"""
