"""Tests of which ``make test`` runs a sample of the cases, and ``make test-all`` each case.

``@pytest.mark.sample(3)`` runs one of three cases of a parametrized test; with ``each="name"``, one
of three for each value of the parameter ``name``, and at least one. Which cases run depends on
their names only, so that a change is judged by the same cases today and tomorrow. pytest's summary
says how many cases were left out. ``DISTAL_ALL_CASES=1`` runs them all, and so does a case that is
named on the command line. Knows nothing of what the tests are about.
"""

from __future__ import annotations

import os
import zlib
from collections import defaultdict
from collections.abc import Hashable, Iterable
from typing import Any, Final

import pytest

VARIABLE: Final = "DISTAL_ALL_CASES"
MARK: Final = "sample(of, each=None): run one of so many cases; for each value of a parameter"
_LEFT_OUT: Final = pytest.StashKey[int]()
_WORKER_KEY: Final = "distal_cases_left_out"


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARK)
    config.stash[_LEFT_OUT] = 0


@pytest.hookimpl(tryfirst=True)  # before -k: the sample must not depend on it
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the cases that are not in the samples."""
    is_named = any("[" in word for word in config.invocation_params.args)
    if is_named or all_cases():
        return
    out = left_out(items)
    if out:
        items[:] = [item for item in items if item.nodeid not in out]
        config.stash[_LEFT_OUT] = len(out)


def all_cases() -> bool:
    """Whether each case is to run."""
    return os.environ.get(VARIABLE) == "1"


def left_out(items: Iterable[pytest.Item]) -> set[str]:
    """The cases that are in no sample."""
    groups: dict[Hashable, list[pytest.Item]] = defaultdict(list)
    for item in items:
        mark = item.get_closest_marker("sample")
        if mark is not None:
            groups[_group(item, **mark.kwargs)].append(item)
    out: set[str] = set()
    for cases in groups.values():
        (of,) = cases[0].get_closest_marker("sample").args
        out.update(drawn_last([case.nodeid for case in cases], of))
    return out


def drawn_last(names: list[str], of: int) -> list[str]:
    """All names except one of ``of``, and at least one, as if they were drawn by lot."""
    assert of >= 1, "a sample is one of so many"
    order = sorted(names, key=lambda name: (zlib.crc32(name.encode()), name))
    return order[-(-len(names) // of) :]


def _group(item: Any, each: str | None = None) -> Hashable:
    function = (str(item.path), item.cls, item.originalname)
    # A value of a parameter is one object in all of its cases.
    return function if each is None else (*function, id(item.callspec.params[each]))


def pytest_sessionfinish(session: pytest.Session) -> None:
    output = getattr(session.config, "workeroutput", None)
    if output is not None:  # a worker of xdist
        output[_WORKER_KEY] = session.config.stash[_LEFT_OUT]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Every worker of xdist collects the same cases."""
    found = getattr(node, "workeroutput", {}).get(_WORKER_KEY, 0)
    node.config.stash[_LEFT_OUT] = max(node.config.stash[_LEFT_OUT], found)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if count := config.stash[_LEFT_OUT]:
        terminalreporter.write_line(
            f"{count} cases of sampled tests were left out: `make test-all` runs each case"
        )
