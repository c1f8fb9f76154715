"""Interned nodes and types through pickle, copy and deepcopy: the same objects again."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

from distal.ir.build import builtin, compose, multiply, number
from distal.ir.nodes import Read
from distal.ir.types import FLOAT, VEC3, tuple_type

NODE = multiply(builtin("sin", Read("x", FLOAT)), number(0.0))
NODES = (NODE, compose(VEC3, NODE, number(-0.0), number(1.0)), VEC3, tuple_type((FLOAT, VEC3)))


def test_nodes_come_back_as_themselves():
    for node in NODES:
        assert pickle.loads(pickle.dumps(node)) is node
        assert copy.copy(node) is node
        assert copy.deepcopy(node) is node


def test_nodes_are_interned_in_another_process():
    text = (
        "import pickle, sys; from distal.ir.build import number; from distal.ir.types import VEC3\n"
        f"nodes = pickle.loads({pickle.dumps(NODES)!r})\n"
        "print(nodes[2] is VEC3, nodes[1].parts[1] is number(-0.0), nodes[1].parts[0] is nodes[0])"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True"] * 3
