"""What every test runs under."""

import gc
import os
import signal
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

from tests.selection import (  # noqa: F401 (hooks)
    all_cases,
    pytest_collection_modifyitems,
    pytest_configure,
    pytest_sessionfinish,
    pytest_terminal_summary,
    pytest_testnodedown,
)

# What passes put out is held against the IR's rules: that of the last one for each module, that of
# every pass for a sample (`make sweep`: for each). Read when distal.compiler.driver is imported.
IS_EACH_VERIFIED = all_cases() or bool(os.environ.get("DISTAL_RANDOM_PROGRAMS"))
os.environ.setdefault("DISTAL_VERIFY", "1" if IS_EACH_VERIFIED else "sample")

# The own cache of the person stays untouched. That of the tests is kept: its keys are of contents,
# so that another run, checkout and environment find what an equal compiler has made.
if "DISTAL_CACHE_DIR" not in os.environ:
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    os.environ["DISTAL_CACHE_DIR"] = str(Path(base) / "distal-tests")
os.environ.setdefault("DISTAL_CACHE_MIB", "1024")
# So do the person's locks, drafts and versions; those of the tests go with the run.
if "PYTEST_XDIST_WORKER" not in os.environ:
    STATE = tempfile.TemporaryDirectory(prefix="distal-tests-state-")
    os.environ["XDG_STATE_HOME"] = STATE.name

# LLVM generates code in half of the time without optimization, with the same bits (decision 92).
# Tests of what compiles and compares machine code get that of the package; none waits for two.
IS_LEVEL_NAMED = "DISTAL_LLVM_LEVEL" in os.environ
OPTIMIZED = (
    "devices",
    "parity",
    "tape",
    "pictures",
    "originals",
    "cluster",
    "unit/devices",
    "unit/llvm",
)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Choose LLVM's level before any fixture compiles."""
    if not IS_LEVEL_NAMED:
        folder = os.path.relpath(item.path, Path(__file__).parent).replace(os.sep, "/")
        is_optimized = all_cases() or folder.startswith(OPTIMIZED)
        os.environ["DISTAL_LLVM_LEVEL"] = "2" if is_optimized else "0"


# Mesa's drivers in software translate each shader with LLVM. Without its optimizer the largest one
# is ready in half the time. ``make sweep`` and ``make parity`` keep the optimizer.
os.environ.setdefault("GALLIVM_PERF", "nopt")

# A shell's job in the background ignores ctrl-C, and so would the processes that tests interrupt.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The compiler allocates many small objects that live on: each collection finds almost nothing.
gc.set_threshold(100_000, 20, 50)


def pytest_unconfigure() -> None:
    """Keep what lives at the end from being looked through: pytest collects it five times."""
    gc.freeze()


# A change is judged by the same random examples today and tomorrow; ``make sweep`` draws others.
# None has a time limit: machines are shared.
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("others", derandomize=False, deadline=None)
settings.load_profile("others" if os.environ.get("DISTAL_RANDOM_PROGRAMS") else "same")
