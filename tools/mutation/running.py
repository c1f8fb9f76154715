"""One mutation, one process: forked where pytest and the heavy packages are imported already.

Input: a mutation and its tests. Output: whether a test failed, and which. The child and the
processes that it starts import a copy of the source with the mutated text; the source itself stays
as it is.

The kernel cache is a folder of the child's own: nothing that another compiler made is found.

A test that fails under these conditions without a mutation says nothing: who kills is tried so,
once, and what it killed is given to the other tests.
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
# Of what is written: a mutated size must not take the machine with it. Addresses are not limited:
# WebAssembly reserves more than there is memory.
MEMORY_BYTES = 16 * 2**30
# No test is left if a mutation of a test's parameters changes the names of all.
_PASSED = (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
_COLLECTION = " (collection)"
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


class Runner:
    """Runs tests with mutations of a project."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._sound: dict[str, bool] = {}

    def run(self, mutation: Mutation, tests: Mapping[str, float]) -> Outcome:
        """Run tests with a mutation in place, until one fails that passes without it.

        Args:
            mutation: The mutation.
            tests: Names in order, each with the processor time that it takes.
        """
        if not tests:
            return Outcome(mutation, UNTESTED)
        verdict, by, seconds = _run(self._project, mutation, tests)
        # A file that cannot be imported is told in place of a test.
        file = by.removesuffix(_COLLECTION)
        test = next((n for n in tests if n == by or n.partition("::")[0] == file), "")
        if verdict == KILLED and test and not self._is_sound(test, tests[test]):
            return self.run(mutation, {n: s for n, s in tests.items() if n != test})
        return Outcome(mutation, verdict, by, len(tests), seconds)

    def _is_sound(self, test: str, seconds: float) -> bool:
        """Whether a test passes without a mutation."""
        if test not in self._sound:
            verdict, _, _ = _run(self._project, None, {test: seconds})
            self._sound[test] = verdict == SURVIVED
            if not self._sound[test]:
                print(f"     {test} fails without a mutation: it is left out", flush=True)
        return self._sound[test]


def _run(
    project: Project, mutation: Mutation | None, tests: Mapping[str, float]
) -> tuple[str, str, float]:
    """Run tests; return the verdict, the test that failed, and how long it took."""
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
        return TIMED_OUT, by, seconds
    return SURVIVED if code in _PASSED else KILLED, by or f"exit {code}", seconds


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


def _child(
    project: Project, mutation: Mutation | None, tests: Mapping[str, float], folder: Path
) -> None:
    code = 3
    try:
        os.setpgid(0, 0)
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BYTES, MEMORY_BYTES))
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
        """Keep what was chosen. A mutation of a test's parameters may give it another name."""
        found = {item.nodeid: item for item in items if item.nodeid in self.tests}
        items[:] = [found[name] for name in self.tests if name in found]

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
            self.said.write_text(f"{report.nodeid}{_COLLECTION}", encoding="utf-8")


def mutated_copy(project: Project, mutation: Mutation | None, folder: Path) -> Path:
    """Copy the source into a folder, with a mutation, beside all else; return where it is."""
    tree = folder / "tree"
    tree.mkdir()
    for path in project.root.iterdir():  # the source finds the examples beside itself
        if path != project.source:
            (tree / path.name).symlink_to(path)
    made = tree / project.source.name
    shutil.copytree(
        project.source, made, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
    )
    if mutation is not None:
        text = mutation.applied(project.index(mutation.file).text)
        (made / mutation.file).write_text(text, "utf-8")
    return made
