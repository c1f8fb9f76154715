"""The prelude: scene code that stands for built-ins a target lacks, or defines them everywhere.

Input: nothing. Output: ``@func`` functions that the rows of
``distal.ir.intrinsics`` name as ``module.function``; the decompose pass calls them. They are
scene code like an author's, compiled by the same front end, and know no target. A function written
for scalars is applied component by component by the pass.
"""
