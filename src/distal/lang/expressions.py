"""Expressions of parameters and time, made in Python."""

from __future__ import annotations

from dataclasses import dataclass

from distal.ir.nodes import Expr
from distal.lang.parameters import Parameter


@dataclass(frozen=True, slots=True, eq=False)
class Expression:
    """A value that depends on parameters and time."""

    node: Expr
    parameters: tuple[Parameter, ...] = ()
