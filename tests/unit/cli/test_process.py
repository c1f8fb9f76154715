"""The command as a process of its own: light to start, polite when interrupted."""

import os
import signal
import subprocess
import sys
import time

SLOW_SCENE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores it
import distal, time
from distal.cli import main

class Scene:
    def parameters(self):
        return []
    def render(self, **options):
        print("rendering", flush=True)
        time.sleep(60)

distal.load = lambda path, name=None: Scene()
main()
"""


def environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def test_ctrl_c_exits_130_without_traceback_or_partial_file(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW_SCENE, "render", "s.py", "-o", "a.png"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout.readline() == "rendering\n"
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=10)
    finally:
        process.kill()
    assert process.returncode == 130
    assert time.monotonic() - begin < 5
    assert errors == ""
    assert list(tmp_path.iterdir()) == []


def test_command_line_and_compile_import_nothing_heavy():
    heavy = ("numpy", "llvmlite", "wgpu", "PIL")
    code = (
        f"import sys, distal.cli.application as a; print([m for m in {heavy} if m in sys.modules])"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    assert answer.stdout == "[]\n"
