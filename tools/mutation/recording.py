"""Which functions each test runs: recorded once, one process for each test.

Input: a project. Output: tests, each with its processor time and the functions
that it executed as Python or that the front end lowered for it. Scene code is never executed as
Python: the trace sees the front end take its source apart instead. Each test runs in a process
forked after collection, so that no cache hides what it needs.

The record is a file with a line for each test. A line is used as long as the test's file is
unchanged; an interrupted recording continues where it stopped.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
import tempfile
import threading
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, TextIO

import pytest
from _pytest.runner import runtestprotocol

from tools.mutation.project import MODULE_LEVEL, Project

LOWERED = "parse_definition"  # frontend/source.py: its argument says which function it takes apart


@dataclass(frozen=True)
class Test:
    """A test as recorded.

    Attributes:
        id: pytest's name for it.
        seconds: Processor time.
        functions: What it ran: "file:qualified name".
    """

    __test__ = False

    id: str
    seconds: float
    functions: frozenset[str]


def recorded(project: Project, path: Path, *, complete: bool = True) -> list[Test]:
    """The tests that pass, with what they run.

    Args:
        project: What is recorded.
        path: The record; what is missing in it is recorded and added.
        complete: Whether anything is to be recorded; else the tests that are there.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if complete:
        begin = time.monotonic()
        done = {row["id"] for row in _rows(project, path)}
        child = os.fork()
        if child == 0:
            _collect_and_run(project, path, done)
        os.waitpid(child, 0)
        count = len(_rows(project, path)) - len(done)
        if count:
            print(f"recorded {count} tests in {time.monotonic() - begin:.0f} s", flush=True)
    rows = _rows(project, path)
    failed = [row["id"] for row in rows if row["outcome"] == "failed"]
    if failed:
        print(f"left out, for they fail without any mutation: {', '.join(failed)}", flush=True)
    tests = [_test(row) for row in rows if row["outcome"] == "passed"]
    if not tests:
        raise SystemExit(f"no recorded test passes: {path}")
    return tests


def _test(row: dict[str, Any]) -> Test:
    names = (f"{file}:{name}" for file, found in row["functions"].items() for name in found)
    return Test(row["id"], row["seconds"], frozenset(names))


def _rows(project: Project, path: Path) -> list[dict[str, Any]]:
    """The lines of tests whose file is as it was; of several of one test, the last."""
    if not path.exists():
        return []
    rows = {row["id"]: row for row in map(json.loads, path.read_text("utf-8").splitlines())}
    digests: dict[str, str] = {}
    for row in rows.values():
        file = row["id"].partition("::")[0]
        if file not in digests:
            digests[file] = _digest(project.root / file)
    return [r for r in rows.values() if r["digest"] == digests[r["id"].partition("::")[0]]]


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16] if path.exists() else ""


def _collect_and_run(project: Project, path: Path, done: set[str]) -> None:
    os.chdir(project.root)
    said = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    words = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", *project.tests]
    pytest.main(words, plugins=[_Recorder(project, path, done, said)])
    os._exit(0)


class _Recorder:
    """A pytest plugin that runs each test in a process of its own."""

    def __init__(self, project: Project, path: Path, done: set[str], said: TextIO) -> None:
        self.project, self.path, self.said = project, path, said
        self.source = str(project.source) + os.sep
        self.done, self.count = done, 0

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave out what is recorded."""
        items[:] = [item for item in items if item.nodeid not in self.done]

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> bool:
        """Fork, run, write one line."""
        child = os.fork()
        if child == 0:
            try:
                row = self._row(item)
                with self.path.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
            finally:
                os._exit(0)
        os.waitpid(child, 0)
        self.count += 1
        if self.count % 50 == 0:
            of = len(item.session.items)
            print(f"recorded {self.count} of {of} tests", file=self.said, flush=True)
        return True

    def _row(self, item: pytest.Item) -> dict[str, Any]:
        codes: set[Any] = set()
        lowered: set[tuple[str, int]] = set()

        def trace(frame: FrameType, event: str, arg: object) -> None:
            codes.add(frame.f_code)
            if frame.f_code.co_name == LOWERED:
                source = frame.f_locals["source"]
                lowered.add((source.file, source.first_line))

        with tempfile.TemporaryDirectory(prefix="mutate-cache-") as cache:
            os.environ["DISTAL_CACHE_DIR"] = cache
            begin = time.process_time()
            threading.settrace(trace)
            sys.settrace(trace)
            reports = runtestprotocol(item, nextitem=None, log=False)
            sys.settrace(None)
            seconds = time.process_time() - begin
        outcomes = [report.outcome for report in reports]
        named = {(code.co_filename, code.co_qualname) for code in codes}
        return {
            "id": item.nodeid,
            "seconds": round(seconds, 3),
            "outcome": next((o for o in outcomes if o != "passed"), "passed"),
            "digest": _digest(self.project.root / item.nodeid.partition("::")[0]),
            "functions": self._named(named, lowered),
        }

    def _named(
        self, executed: set[tuple[str, str]], lowered: set[tuple[str, int]]
    ) -> dict[str, list[str]]:
        """Outermost functions by file."""
        found: dict[str, set[str]] = defaultdict(set)
        for path, qualified in executed:
            if path.startswith(self.source):
                name = self.project.name(Path(path))
                found[name].add(qualified.partition(".<locals>")[0])
        for path, line in lowered:
            if path.startswith(self.source):
                name = self.project.name(Path(path))
                owner = self.project.index(name).owner(line)
                if owner != MODULE_LEVEL:
                    found[name].add(owner)
        return {name: sorted(functions) for name, functions in sorted(found.items())}
