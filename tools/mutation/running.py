"""One mutation, one process: forked where pytest and the heavy packages are imported already.

Input: a mutation and its tests. Output: whether a test failed, and which. The child and the
processes that it starts import a copy of the source with the mutated text; the source itself stays
as it is.

The kernel cache is a folder of the child's own. Its key names the compiler's files, and so a
mutated compiler makes its own kernels; a mutation of scene code changes the module that is hashed.
"""

from __future__ import annotations

import os
import resource
import shutil
import signal
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from tools.mutation.operators import Mutation
from tools.mutation.project import Project

KILLED, SURVIVED, TIMED_OUT, UNTESTED = "killed", "survived", "timed out", "no test"
MEMORY_BYTES = 16 * 2**30  # of addresses: a mutated size must not take the machine with it
_WAITING_S = 300.0  # for a process that waits for ever, and so uses no time


@dataclass(frozen=True)
class Outcome:
    """What became of a mutation.

    Attributes:
        mutation: The mutation.
        verdict: Killed, survived, timed out, or no test ran the function.
        by: The test that failed.
        tests: How many were chosen.
        seconds: How long it took.
    """

    mutation: Mutation
    verdict: str
    by: str = ""
    tests: int = 0
    seconds: float = 0.0


def run(project: Project, mutation: Mutation, tests: Mapping[str, float]) -> Outcome:
    """Run tests with a mutation in place, until one fails.

    Args:
        project: What is mutated.
        mutation: The mutation.
        tests: Names in order, each with the processor time that it takes.
    """
    if not tests:
        return Outcome(mutation, UNTESTED)
    begin = time.monotonic()
    folder = Path(tempfile.mkdtemp(prefix="mutate-"))
    try:
        child = os.fork()
        if child == 0:
            _child(project, mutation, tests, folder)
        limit = _WAITING_S + 10.0 * sum(tests.values())
        in_time, code = _wait(child, begin + limit)
        said = folder / "failed"
        by = said.read_text("utf-8") if said.exists() else ""
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    seconds = time.monotonic() - begin
    if not in_time or code == -signal.SIGPROF:
        return Outcome(mutation, TIMED_OUT, by, len(tests), seconds)
    verdict = SURVIVED if code == 0 else KILLED
    return Outcome(mutation, verdict, by or f"exit {code}", len(tests), seconds)


def _wait(child: int, until: float) -> tuple[bool, int]:
    while time.monotonic() < until:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return True, os.waitstatus_to_exitcode(status)
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False, 0


def _limit(seconds: float) -> float:
    return 5.0 + 10.0 * seconds


def _child(project: Project, mutation: Mutation, tests: Mapping[str, float], folder: Path) -> None:
    code = 3
    try:
        os.setpgid(0, 0)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        os.chdir(project.root)
        log = os.open(folder / "log", os.O_WRONLY | os.O_CREAT)
        os.dup2(log, 1)
        os.dup2(log, 2)
        os.environ["DISTAL_CACHE_DIR"] = str(folder / "kernels")
        os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(folder / "hypothesis")
        source = str(mutated_copy(project, mutation, folder))
        os.environ["PYTHONPATH"] = os.pathsep.join([source, *project.paths])
        files = list(dict.fromkeys(name.partition("::")[0] for name in tests))
        first = f"pythonpath={' '.join([source, *project.paths])}"
        words = ["-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "-o", first, *files]
        code = int(pytest.main(words, plugins=[_Chooser(tests, folder / "failed")]))
    finally:
        os._exit(code)


class _Chooser:
    """A pytest plugin: the chosen tests in their order, each with a time limit."""

    def __init__(self, tests: Mapping[str, float], said: Path) -> None:
        self.tests = tests
        self.said = said

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep what was chosen. A test that is no longer there was changed by the mutation."""
        found = {item.nodeid: item for item in items if item.nodeid in self.tests}
        if len(found) < len(self.tests):
            missing = next(name for name in self.tests if name not in found)
            self.said.write_text(f"{missing} (not collected)", encoding="utf-8")
            os._exit(1)
        items[:] = [found[name] for name in self.tests]

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """A signal that nothing catches ends the process, wherever it is.

        Processor time is counted: on a busy machine a test may wait long.
        """
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, _limit(self.tests[item.nodeid]))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Name the first that fails."""
        if report.failed and not self.said.exists():
            self.said.write_text(report.nodeid, encoding="utf-8")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Or that could not be collected."""
        if report.failed and not self.said.exists():
            self.said.write_text(f"{report.nodeid} (collection)", encoding="utf-8")


def mutated_copy(project: Project, mutation: Mutation, folder: Path) -> Path:
    """Copy the source into a folder, with the mutation, beside all else; return where it is."""
    tree = folder / "tree"
    tree.mkdir()
    for path in project.root.iterdir():  # the source finds the examples beside itself
        if path != project.source:
            (tree / path.name).symlink_to(path)
    made = tree / project.source.name
    shutil.copytree(
        project.source, made, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
    )
    text = mutation.applied(project.index(mutation.file).text)
    (made / mutation.file).write_text(text, "utf-8")
    return made
