"""Which tests run: all of them, those of ``make test``, or a list; and one of several cases.

``DISTAL_TESTS=chosen`` leaves out the tests that the record (``tools/record``) knows and has not
chosen; the path of a file, those that it names, one a line. A test that the record does not know is
new, and runs.

``@pytest.mark.sample(3)`` runs one of three cases of a parametrized test; with ``each="name"``, one
of three for each value of the parameter ``name``, and at least one. Which cases run depends on
their names only, so that a change is judged by the same cases today and tomorrow.
``DISTAL_ALL_CASES=1`` runs each case, and so does a case that is named on the command line.

pytest's summary says how many were left out. Knows nothing of what the tests are about.
"""

from __future__ import annotations

import os
import zlib
from collections import defaultdict
from collections.abc import Hashable, Iterable, Mapping
from collections.abc import Set as AbstractSet
from pathlib import Path
from typing import Any, Final

import pytest

from tools.record import rows

VARIABLE: Final = "DISTAL_ALL_CASES"
TESTS: Final = "DISTAL_TESTS"
CHOSEN: Final = "chosen"
MARK: Final = "sample(of, each=None): run one of so many cases; for each value of a parameter"
_LEFT_OUT: Final = pytest.StashKey[dict[str, int]]()
_WORKER_KEY: Final = "distal_tests_left_out"


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARK)
    config.stash[_LEFT_OUT] = {}


@pytest.hookimpl(tryfirst=True)  # before -k: the sample must not depend on it
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the cases that are not in the samples, and the tests that are not chosen."""
    is_named = any("[" in word for word in config.invocation_params.args)
    if not (is_named or all_cases()):
        _leave_out(config, items, "cases", left_out(items))
    plan = rows.plan()
    if choice := os.environ.get(TESTS):
        names = Path(choice).read_text("utf-8").splitlines() if choice != CHOSEN else plan.left_out
        _leave_out(config, items, "tests", frozenset(names))
    if workers := int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "0")):
        items[:] = in_order(items, plan.seconds, workers)


def _leave_out(
    config: pytest.Config, items: list[pytest.Item], what: str, out: AbstractSet[str]
) -> None:
    before = len(items)
    items[:] = [item for item in items if item.nodeid not in out]
    config.stash[_LEFT_OUT][what] = before - len(items)


def in_order(
    items: Iterable[pytest.Item], seconds: Mapping[str, float], workers: int
) -> list[pytest.Item]:
    """The tests in the order of as many parts as there are workers, each with long files first.

    A worker begins with a part, and takes of others' ends when it is through: the last tests of a
    run are short.
    """
    files: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        files[str(item.path)].append(item)

    def mean(tests: list[pytest.Item]) -> float:
        return sum(seconds.get(test.nodeid, 0.0) for test in tests) / len(tests)

    order = sorted(files.values(), key=mean, reverse=True)
    return [test for k in range(workers) for tests in order[k::workers] for test in tests]


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
    """Every worker of xdist collects the same tests."""
    found = getattr(node, "workeroutput", {}).get(_WORKER_KEY)
    if found:
        node.config.stash[_LEFT_OUT] = found


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    out = config.stash[_LEFT_OUT]
    if count := out.get("tests"):
        terminalreporter.write_line(
            f"{count} tests were left out: `make test-all` runs all, `make test-for` those that a"
            " change can reach"
        )
    if count := out.get("cases"):
        terminalreporter.write_line(
            f"{count} cases of sampled tests were left out: `make sweep` runs each case"
        )
