"""What every test runs under."""

import atexit
import gc
import os
import shutil
import signal
import tempfile

from hypothesis import settings

from tests.case_samples import (  # noqa: F401 (hooks)
    all_cases,
    pytest_collection_modifyitems,
    pytest_configure,
    pytest_sessionfinish,
    pytest_terminal_summary,
    pytest_testnodedown,
)

# What passes put out is held against the IR's rules: that of the last one for each module, that of
# every pass for a sample (`make test-all`: for each). Read when distal.compiler.driver is imported.
IS_EACH_VERIFIED = all_cases() or bool(os.environ.get("DISTAL_RANDOM_PROGRAMS"))
os.environ.setdefault("DISTAL_VERIFY", "1" if IS_EACH_VERIFIED else "sample")

# The person's own cache stays untouched; workers inherit the folder of the process that made it.
if "DISTAL_CACHE_DIR" not in os.environ:
    os.environ["DISTAL_CACHE_DIR"] = tempfile.mkdtemp(prefix="distal-tests-")
    atexit.register(shutil.rmtree, os.environ["DISTAL_CACHE_DIR"], ignore_errors=True)

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
settings.register_profile("same", derandomize=True)
settings.register_profile("others", derandomize=False)
settings.load_profile("others" if os.environ.get("DISTAL_RANDOM_PROGRAMS") else "same")
