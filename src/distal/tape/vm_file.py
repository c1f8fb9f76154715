"""Read ``.vm`` files, in which Fidget and its models write functions of a point.

Input: a text, one operation in each line: a name for the result, the operation, names of earlier
results or a number. Lines that begin with ``#`` are comments; the last line is the result.

Source: M. Keeter, Fidget, ``fidget_core::context::Context::from_text``.
"""

from __future__ import annotations
