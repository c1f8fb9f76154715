"""What expressions contain, against a plain walk; and the work that long ones cost."""

import random

import pytest

from distal.ir import contents as module
from distal.ir.contents import calls_in, contents, nodes_of, nodes_outside, size_of
from distal.ir.nodes import Binary, BinaryOp, Call, Const, PerFrame, Read
from distal.ir.types import FLOAT
from distal.ir.walk import children
from distal.passes.cost import Costs, expression_cost


def random_chain(seed, length):
    """Return expressions, each with some of the earlier ones in it."""
    rng = random.Random(seed)
    made = [Read(f"x{seed}_{i}", FLOAT) for i in range(3)] + [PerFrame(f"f{seed}", FLOAT)]
    for i in range(length):
        a, b = made[-1], rng.choice(made)
        if rng.random() < 0.2:
            made.append(Call(f"function{rng.randrange(4)}", (a, b), FLOAT))
        else:
            op = rng.choice((BinaryOp.ADD, BinaryOp.MUL))
            made.append(Binary(op, a, rng.choice((b, Const(float(i), FLOAT))), FLOAT))
    return made


def plain_walk(root):
    seen, stack = {root: None}, [root]
    while stack:
        for child in children(stack.pop()):
            if child not in seen:
                seen[child] = None
                stack.append(child)
    return list(seen)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("order", ["short first", "long first", "mixed"])
def test_contents_are_those_of_a_plain_walk(seed, order, monkeypatch):
    monkeypatch.setattr(module, "_LONGEST", 12)
    made = random_chain(f"{seed}{order}", 150)
    asked = made if order == "short first" else made[::-1]
    if order == "mixed":
        asked = random.Random(seed).sample(made, len(made))
    for e in asked:
        contents(e)
    for e in made:
        nodes = plain_walk(e)
        found = contents(e)
        assert found.kinds == {type(n) for n in nodes}
        assert found.reads == {n.name for n in nodes if isinstance(n, Read)}
        assert found.frames == {n.name for n in nodes if isinstance(n, PerFrame)}
        calls = [n.function for n in nodes if isinstance(n, Call)]
        assert set(found.callees) == set(calls) and len(found.callees) == len(set(calls))
        assert sorted(calls_in(e)) == sorted(calls)
        assert size_of(e) == sum(not isinstance(n, Const | Read) for n in nodes)
        listed = nodes_of(e)
        assert set(listed) == set(nodes) and len(listed) == len(nodes)
        place = {n: i for i, n in enumerate(listed)}
        assert all(place[c] < place[n] for n in nodes for c in children(n))


def test_nodes_outside_of_what_is_there():
    a, b = Read("outside_a", FLOAT), Read("outside_b", FLOAT)
    inner = Binary(BinaryOp.ADD, a, b, FLOAT)
    outer = Binary(BinaryOp.MUL, inner, b, FLOAT)
    assert nodes_outside(outer, ()) == list(nodes_of(outer))
    assert nodes_outside(outer, {inner, b}) == [outer]
    assert nodes_outside(outer, {outer}) == []


def test_the_work_of_a_chain_is_in_proportion_to_its_length(monkeypatch):
    count = 0
    walked = module._walked

    def counted(*args, **given):
        nonlocal count
        found = walked(*args, **given)
        count += len(found)
        return found

    monkeypatch.setattr(module, "_walked", counted)
    work = []
    for length in (2000, 4000):
        e = Read(f"chain{length}", FLOAT)
        count, costs = 0, Costs({})
        for i in range(length):
            e = Binary(BinaryOp.ADD, e, Const(float(i), FLOAT), FLOAT)
            contents(e)
            costs.of(e)
        assert costs.of(e) == length
        work.append(count)
    # Short ones are walked each; from then on each adds its own nodes.
    assert work[1] - work[0] <= 4 * 2000


def test_costs_of_short_expressions_are_exact_and_of_long_ones_at_least_that():
    made = random_chain("costs", 700)
    costs = Costs({"function0": 7})
    for e in made:
        exact = expression_cost(e, {"function0": 7})
        assert costs.of(e) >= exact
        if not contents(e).parts:
            assert costs.of(e) == exact
