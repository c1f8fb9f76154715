"""The optimized code of a kernel, compiled beside the first code: it takes over; failures."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest

from distal.devices import background, cpu, object_files
from distal.devices.base import Cancelled
from distal.devices.cache import Cache
from distal.devices.kernel_key import LEVEL_VARIABLE
from distal.devices.threads import usable_threads
from distal.frontend import lower
from distal.lang import Frame, image, length, slider, vec2, vec4

SIZE = (256, 256)
rounds = slider("Rounds", 9.0, low=1.0, high=1e6)


@image
def scene(frame: Frame) -> vec4:
    """As slow as the parameter says."""
    p = frame.coord * 0.01
    for _ in range(int(rounds)):
        p = vec2(p.x * p.x - p.y, 2.0 * p.x * p.y) / (1.0 + length(p))
    return vec4(p, length(p), rounds)


@pytest.fixture(autouse=True)
def several_processors(monkeypatch):
    monkeypatch.delenv(LEVEL_VARIABLE, raising=False)
    monkeypatch.setattr("distal.devices.threads.usable_threads", lambda: 2)
    monkeypatch.setattr(cpu, "_DELAY_S", 0.0)


@pytest.fixture
def held():
    """Nothing is optimized until the test frees the lock, or ends."""

    class Held:
        def __init__(self):
            self.count = 1
            background.ONE_AT_A_TIME.acquire()

        def free(self):
            if self.count:
                self.count = 0
                background.ONE_AT_A_TIME.release()

    lock = Held()
    yield lock
    lock.free()


def prepared(cache=None, **options):
    return cpu.prepare(lower(scene), cache=cache or Cache(None), **options)


def prepared_at_once():
    with pytest.MonkeyPatch.context() as one:
        one.setenv(LEVEL_VARIABLE, "2")
        return prepared()


def drawn(kernel, size=(70, 40), count=9.0, **options):
    return kernel.render(*size, {"rounds": count}, {}, **options).copy()


def ended(kernel):
    kernel._optimizing.wait(60)
    return kernel


def test_optimized_code_takes_over_and_draws_the_same(held):
    kernel = prepared()
    plain = drawn(kernel)
    assert kernel.stats["optimization"] == 0
    held.free()
    optimized = drawn(ended(kernel))
    assert kernel.stats["optimization"] == 2
    assert np.array_equal(plain, optimized)
    assert len(np.unique(plain)) > 100


def test_it_takes_over_between_two_tiles(held):
    kernel, optimized = prepared(), prepared_at_once()
    count, used = 500.0, []

    def progress(done):
        if not used and 0.0 < done < 0.5:
            used.append(kernel._code.llvm_level)
            kernel.take(optimized._code)

    while not used:  # longer, until there is time to interrupt it
        count *= 4.0
        picture = drawn(kernel, SIZE, count, progress=progress)
    assert used == [0]
    assert kernel.stats["optimization"] == 2
    assert not kernel._running
    assert np.array_equal(picture, drawn(optimized, SIZE, count))


def test_a_run_can_be_stopped_after_the_code_has_changed(held):
    kernel, optimized = prepared(), prepared_at_once()
    begun = time.monotonic()

    def cancel():
        if kernel._code is not optimized._code:
            kernel.take(optimized._code)
        return time.monotonic() - begun > 1.0

    with pytest.raises(Cancelled):
        drawn(kernel, (4096, 4096), 4000.0, cancel=cancel)
    assert time.monotonic() - begun < 5.0


def test_the_cache_keeps_the_optimized_code_alone(tmp_path):
    cache = Cache(tmp_path)
    first = ended(prepared(cache))
    picture = drawn(first)
    again = prepared(cache, passes=None)
    assert (again.stats["cache_hit"], again.stats["optimization"]) == (True, 2)
    assert again._optimizing is None
    assert np.array_equal(drawn(again), picture)
    assert cache.size()[0] == 2  # the kernel and its object file


def no_passes(*_):
    raise AssertionError("the kernel is in the cache")


def fail_to_optimize(monkeypatch, error):
    def compiled(*_, **__):
        raise error

    monkeypatch.setattr(object_files, "compile_apart", compiled)


def test_a_process_that_ended_early_left_its_first_code(tmp_path, monkeypatch):
    cache = Cache(tmp_path)
    with monkeypatch.context() as broken:
        fail_to_optimize(broken, SystemExit("the process ends"))
        ended(prepared(cache))
    kernel = prepared(cache, passes=no_passes)
    assert (kernel.stats["cache_hit"], kernel.stats["optimization"]) == (True, 0)
    drawn(ended(kernel))
    assert kernel.stats["optimization"] == 2
    assert prepared(cache, passes=no_passes).stats["optimization"] == 2


def test_optimized_modules_of_another_kernel_are_used_at_once(tmp_path, monkeypatch):
    """A changed compiler may write the same LLVM text."""
    cache = Cache(tmp_path)
    ended(prepared(cache))
    monkeypatch.setattr("distal.devices.kernel_key.compiler_sources", lambda: "another")
    kernel = prepared(cache)
    assert (kernel.stats["cache_hit"], kernel.stats["optimization"]) == (False, 2)
    assert kernel._optimizing is None


@pytest.mark.parametrize("error", [RuntimeError("out of luck"), MemoryError()])
def test_a_failure_is_reported_once_and_the_first_code_goes_on(error, monkeypatch):
    fail_to_optimize(monkeypatch, error)
    kernel = ended(prepared())
    with pytest.warns(RuntimeWarning, match=str(error) or "MemoryError"):
        first = drawn(kernel)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.array_equal(drawn(kernel), first)
    assert kernel.stats["optimization"] == 0


def test_a_thread_that_does_not_start_is_reported(monkeypatch):
    def fails(*_):
        raise MemoryError("the system starts no thread")

    monkeypatch.setattr(background, "start_threads", fails)
    kernel = prepared()
    with pytest.warns(RuntimeWarning, match="the system starts no thread"):
        drawn(kernel)


def test_one_processor_compiles_once(monkeypatch):
    monkeypatch.setattr("distal.devices.threads.usable_threads", lambda: 1)
    kernel = prepared()
    assert kernel.stats["optimization"] == 2
    assert kernel._optimizing is None


def test_limited_memory_compiles_once(monkeypatch):
    monkeypatch.setattr(cpu, "is_limited", lambda: True)
    assert prepared().stats["optimization"] == 2


@pytest.mark.parametrize("level", [0, 1, 2])
def test_a_level_that_is_named_is_the_only_one(level, monkeypatch):
    monkeypatch.setenv(LEVEL_VARIABLE, str(level))
    kernel = prepared()
    drawn(kernel)
    assert kernel.stats["optimization"] == level
    assert kernel._optimizing is None


def test_code_of_a_named_level_can_be_optimized_later(tmp_path, monkeypatch):
    cache = Cache(tmp_path)
    monkeypatch.setenv(LEVEL_VARIABLE, "0")
    plain = drawn(prepared(cache))
    monkeypatch.delenv(LEVEL_VARIABLE)
    kernel = ended(prepared(cache))  # the stored code has no modules: they are made again
    assert np.array_equal(drawn(kernel), plain)
    assert kernel.stats["optimization"] == 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_child_optimizes_for_itself(held):
    kernel = prepared()
    plain = drawn(kernel)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            # The lock of the parent's test is held by this thread, which is the child's.
            held.free()
            first = drawn(kernel)
            drawn(ended(kernel))
            equal = np.array_equal(first, plain)
            code = 0 if equal and kernel.stats["optimization"] == 2 else 2
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


EXITS = """
import distal, sys, time
from distal.devices import cpu, object_files
from distal.devices.cache import Cache
from distal.frontend import lower
if sys.argv[1] == "waiting":
    object_files.compile_apart = lambda *_, **__: time.sleep(60.0)
kernel = cpu.prepare(lower(distal.load("example:raymarcher")), cache=Cache(None))
assert kernel.stats["optimization"] == 0
assert kernel._optimizing._thread.is_alive()
print("end")
"""


@pytest.mark.skipif(usable_threads() < 2, reason="one processor compiles once")
@pytest.mark.parametrize("how", ["waiting", "compiling"])
def test_an_exit_does_not_wait(how):
    environment = {**os.environ, "DISTAL_CACHE_DIR": "off"}
    environment.pop(LEVEL_VARIABLE, None)
    command = [sys.executable, "-c", EXITS, how]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=50)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")
