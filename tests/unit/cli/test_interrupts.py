"""Ctrl-C on a terminal at some moments of some commands; ``make sweep-interrupts`` takes many."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tools.sweep_interrupts import COMMANDS, Bench

# Ctrl-C as soon as the command imports anything of its own.
EARLY = """
import builtins, signal, sys
signal.signal(signal.SIGINT, signal.{handler})
import distal.cli
plain = builtins.__import__
def interrupted(name, *more):
    if name == "distal.cli.running":
        signal.raise_signal(signal.SIGINT)
    return plain(name, *more)
builtins.__import__ = interrupted
sys.argv[1:] = ["examples"]
distal.cli.main()
"""


# Ctrl-C in the middle of a call of C code that takes minutes, as LLVM takes seconds.
IN_LLVM = """
import hashlib, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)
from distal.devices import jit
from distal.interrupting import interrupt_main
def compiled(*_):
    threading.Timer(0.2, interrupt_main).start()
    hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)
jit._compiled = compiled
sys.argv[1:] = ["render", "example:raymarcher", "--device", "cpu", "--size", "8x8", "-o", "a.png"]
from distal.cli import main
main()
"""


def run(code, **more):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "DISTAL_CACHE_DIR": "off"}
    return subprocess.run(
        [sys.executable, "-c", code],
        **{"env": environment, "capture_output": True, "text": True, "timeout": 60, **more},
    )


@pytest.mark.parametrize(("handler", "code"), [("default_int_handler", 130), ("SIG_IGN", 0)])
def test_while_a_command_is_imported(handler, code):
    """It ends without a word; a shell's job in the background goes on."""
    done = run(EARLY.format(handler=handler))
    assert (done.returncode, done.stderr) == (code, "")
    assert ("example:" in done.stdout) == (code == 0)


def test_while_llvm_compiles(tmp_path):
    done = run(IN_LLVM, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (130, "")
    assert not list(tmp_path.iterdir())


def test_a_library_leaves_signals_alone():
    code = (
        "import signal; before = signal.getsignal(signal.SIGINT)\n"
        "import distal, distal.cli.running, distal.cli.render\n"
        "assert signal.getsignal(signal.SIGINT) is before"
    )
    assert run(code).returncode == 0


def test_the_first_lines_of_the_command_import_next_to_nothing():
    """What is imported before them is interrupted with a traceback."""
    code = "import re, sys; before = set(sys.modules); import distal.cli; {}"
    loaded = eval(run(code.format("print(sorted(set(sys.modules) - before))")).stdout)
    assert set(loaded) <= {
        *("distal", "distal.public_names", "distal.version", "distal.cli", "distal.interrupting"),
        *("importlib", "importlib._bootstrap", "importlib._bootstrap_external", "warnings"),
        *("signal", "_signal", "__future__"),
    }


@pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are those of POSIX")
@pytest.mark.parametrize(
    ("name", "moment"),
    [("new", 0.08), ("render", 0.5), ("mesh", 1.0), ("cluster", 0.9), ("cluster", 2.0)],
)
def test_a_group_of_processes(name, moment, tmp_path):
    bench = Bench(COMMANDS[name], tmp_path, {})
    end = bench.interrupted(moment)
    if bench.is_outside(end):
        pytest.skip("Python had not started yet")
    assert not bench.faults(end), end.errors
    assert end.code == 130
