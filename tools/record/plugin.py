"""A pytest plugin that records which functions each test runs: ``-p tools.record.plugin``.

``DISTAL_RECORD`` names the folder for what is recorded. Each test begins without what earlier ones
have computed, so that no cache hides what it needs; ``DISTAL_CACHE_DIR`` must be ``off``. What a
fixture of a wider scope runs counts for all tests that use it.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import json
import os
import sys
from collections.abc import Iterator
from typing import Any, Final

import psutil
import pytest

from distal.session import SESSION
from tools.record import monitor

OUT: Final = os.environ[monitor.FOLDER]
# Answers of the machine, and libraries that are loaded once.
_KEPT: Final = {
    "listed_in_subprocess",
    "_handles",
    "llvm_binding",
    "wgpu_module",
    "machine",
    "host_levels",
}


class _Recorder:
    """Holds the monitor, what fixtures have run, and the caches of the source."""

    def __init__(self) -> None:
        self.monitor = monitor.Monitor(os.environ[monitor.SOURCE])
        self.of_fixture: dict[int, set[str]] = {}
        self.before_fixtures: set[str] = set()
        self._modules, self._caches = 0, list[Any]()

    def forget(self) -> None:
        """Forget what earlier tests have computed."""
        if self._modules != len(sys.modules):
            wrapper = type(functools.lru_cache(lambda: None))
            self._modules = len(sys.modules)
            self._caches = [
                each
                for each in gc.get_objects()  # also those inside closures
                if type(each) is wrapper
                and getattr(each, "__module__", "").startswith("distal")
                and each.__name__ not in _KEPT
            ]
        for each in self._caches:
            each.cache_clear()
        SESSION.fresh()


_RECORDER: Final = _Recorder()


def pytest_configure(config: pytest.Config) -> None:
    """Begin to record, in forks of this process too."""
    _RECORDER.monitor.start()
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=lambda: _RECORDER.monitor.write_to(OUT))


@pytest.hookimpl(hookwrapper=True)
def pytest_fixture_setup(fixturedef: Any, request: Any) -> Iterator[None]:
    """Record what a fixture runs that several tests share."""
    if fixturedef.scope == "function":
        yield
        return
    _RECORDER.before_fixtures |= _RECORDER.monitor.names()
    _RECORDER.monitor.begin()
    yield
    _RECORDER.of_fixture[id(fixturedef)] = _RECORDER.monitor.names()


@pytest.hookimpl(hookwrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: Any, nextitem: Any) -> Iterator[None]:
    """Write a row for a test."""
    os.environ[monitor.TEST] = item.nodeid
    _RECORDER.forget()
    _RECORDER.before_fixtures = set()
    _RECORDER.monitor.begin()
    below = _seconds_below()  # to look at processes takes time, which is not the test's
    begin = _seconds()
    yield
    seconds = _seconds() - begin + _seconds_below() - below
    names = _RECORDER.monitor.names() | _RECORDER.before_fixtures
    for definitions in item._fixtureinfo.name2fixturedefs.values():
        for each in definitions:
            names |= _RECORDER.of_fixture.get(id(each), set())
    row = {"id": item.nodeid, "seconds": round(seconds, 3), "functions": sorted(names)}
    with open(f"{OUT}/rows-{os.getpid()}.jsonl", "a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
    del os.environ[monitor.TEST]


def _seconds() -> float:
    """Return the processor time of this process and of its children that have ended."""
    return sum(os.times()[:4])


def _seconds_below() -> float:
    """Return that of the children that still run, of their children, and so on.

    Browsers and notebooks outlive the tests that use them.
    """
    seconds = 0.0
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):  # it has ended: its parent counts it
            seconds += sum(child.cpu_times()[:4])
    return seconds
