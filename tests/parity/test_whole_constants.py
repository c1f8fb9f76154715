"""Ints of constants are those of values: operators that are folded wrap as they do at run time.

A generator writes expressions of ints twice: with literals, and with the same numbers as
parameters. Python's own ints, wrapped after each operation, are a third opinion.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import numpy as np
import pytest

from distal.compiler.constant_evaluation import evaluate
from distal.ir.build import binary, integer, read
from distal.ir.constant_arithmetic import wrap
from distal.ir.nodes import BinaryOp, Expr, Unary, UnaryOp
from distal.ir.types import INT, Kind
