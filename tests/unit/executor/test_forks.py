"""Forked and spawned processes render: no lock of a thread that they do not have stops them."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from distal import Box, Scene
from distal.at_once import AtOnce, ReentranceError
from distal.forking import new_lock
from distal.ir.collection import paused_collection

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
LIMIT_S = 60

# Threads render new scenes without end while the main one forks; a child that hangs is killed.
FORKS = """
import os, signal, sys, threading, warnings
warnings.simplefilter("ignore")
sys.setswitchinterval(1e-5)
from distal import Box, Scene, Sphere
over = threading.Event()
def render(k):
    while not over.is_set():
        k += 2
        Scene(Sphere(0.5).union(Box(0.3 + 1e-4 * k), smooth=0.1)).render((8, 6), samples=1)
threads = [threading.Thread(target=render, args=(k,)) for k in range(2)]
for thread in threads:
    thread.start()
ended = []
for k in range(6):
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        Scene(Sphere(0.6).twist(0.1 * k)).render((8, 6), samples=1)
        os._exit(0)
    ended.append(os.waitpid(child, 0)[1])
over.set()
for thread in threads:
    thread.join()
print(ended)
"""

POOLS = """
import hashlib, os, sys
from concurrent.futures import ThreadPoolExecutor
from distal import Box, Scene, Sphere
PICTURES = int(sys.argv[1])
scenes = [Scene(Sphere(0.5) | Box(0.1 * k + 0.6).twist(0.2 * k)) for k in range(5)]
def digest(k):
    picture = scenes[k % 5].render((16, 12), samples=1)
    return hashlib.sha256(picture.array.tobytes()).hexdigest()
def digests(of):
    with ThreadPoolExecutor(8) as pool:
        return list(pool.map(digest, of))
alone = [digest(k) for k in range(5)]
assert len(set(alone)) == 5
children = []
for _ in range(4):
    child = os.fork()
    if child == 0:
        found = digests(range(PICTURES))
        os._exit(int(any(f != alone[k % 5] for k, f in enumerate(found))))
    children.append(child)
found = digests(range(PICTURES))
assert all(f == alone[k % 5] for k, f in enumerate(found))
print([os.waitpid(child, 0)[1] for child in children])
"""


def run(code: str, *args: str) -> str:
    """Return what a fresh process prints."""
    made = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code, *args],
        capture_output=True,
        text=True,
        timeout=10 * LIMIT_S,
    )
    assert made.returncode == 0, made.stderr
    return made.stdout.strip()


@needs_fork
def test_forks_of_a_process_whose_threads_compile_end_with_a_picture():
    assert run(FORKS) == str([0] * 6)


@needs_fork
def test_eight_threads_and_four_forks_render_equal_pictures():
    assert run(POOLS, "100") == str([0] * 4)  # 500 pictures


def rendered(size: float) -> bytes:
    """Return the bytes of a picture, for other processes."""
    return Scene(Box(size)).render(size=(8, 6), samples=1).array.tobytes()


def test_spawned_processes_render_the_same_picture():
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(rendered, [0.5, 0.5, 0.6]) == [rendered(s) for s in (0.5, 0.5, 0.6)]


def child_ends_with(action) -> int:
    """Return the exit status of a fork that calls a function; one that hangs is killed."""
    child = os.fork()
    if child == 0:
        signal.alarm(LIMIT_S)
        try:
            action()
        except BaseException:
            os._exit(2)
        os._exit(0)
    return os.waitpid(child, 0)[1]


@needs_fork
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_lock_of_another_thread_is_free_in_a_fork():
    lock, locked, over = new_lock(), threading.Event(), threading.Event()

    def hold() -> None:
        with lock:
            locked.set()
            over.wait(LIMIT_S)

    thread = threading.Thread(target=hold)
    thread.start()
    locked.wait(LIMIT_S)
    assert child_ends_with(lambda: lock.acquire(timeout=LIMIT_S / 2) or os._exit(3)) == 0
    assert not lock.acquire(blocking=False)  # in this process it is still taken
    over.set()
    thread.join()


@needs_fork
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_does_not_wait_for_what_a_thread_of_its_parent_computes():
    at_once, begun, over = AtOnce(), threading.Event(), threading.Event()

    def slow() -> int:
        begun.set()
        over.wait(LIMIT_S)
        return 1

    thread = threading.Thread(target=lambda: at_once.result("key", lambda: None, slow))
    thread.start()
    begun.wait(LIMIT_S)
    assert child_ends_with(lambda: at_once.result("key", lambda: None, lambda: 2)) == 0
    over.set()
    thread.join()


@needs_fork
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_garbage_is_collected_in_a_fork_while_a_thread_of_its_parent_had_paused_it():
    begun, over = threading.Event(), threading.Event()

    def pause() -> None:
        with paused_collection():
            begun.set()
            over.wait(LIMIT_S)

    thread = threading.Thread(target=pause)
    thread.start()
    begun.wait(LIMIT_S)

    def collects() -> None:
        os._exit(0 if gc.isenabled() else 4)

    assert child_ends_with(collects) == 0
    over.set()
    thread.join()


# Computations at once


def test_what_asks_for_its_own_result_is_told():
    at_once = AtOnce()

    def again() -> int:
        return at_once.result("a", lambda: None, lambda: 1)

    with pytest.raises(ReentranceError, match="'a' asks for its own result"):
        at_once.result("a", lambda: None, again)
    assert at_once.result("a", lambda: None, lambda: 2) == 2  # nothing is left behind


def test_one_thread_computes_and_the_others_wait():
    at_once, table, made = AtOnce(), {}, []

    def compute() -> int:
        made.append(1)
        time.sleep(0.05)
        table["a"] = 5
        return 5

    found: list[int] = []
    threads = [
        threading.Thread(
            target=lambda: found.append(at_once.result("a", lambda: table.get("a"), compute))
        )
        for _ in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [5] * 6
    assert made == [1]


def test_two_computations_that_need_each_other_do_not_wait_for_ever():
    at_once, table, both = AtOnce(), {}, threading.Barrier(2)

    def result(mine: str, other: str, depth: int) -> str:
        def compute() -> str:
            if depth == 0:
                both.wait(LIMIT_S)
                result(other, mine, 1)
            table[mine] = mine
            return mine

        return at_once.result(mine, lambda: table.get(mine), compute)

    threads = [threading.Thread(target=result, args=(*names, 0)) for names in ("ab", "ba")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(LIMIT_S)
    assert table == {"a": "a", "b": "b"}
