"""Interrupt every command at random moments, as ctrl-C on a terminal does, and report faults.

Input: names of commands, how many moments of each, a seed. Output: a line for each command; the
exit code is 1 if one has a fault. A run must end within 3 s, by exit code 130, or 0 where it had
finished; with one more line on stderr than an undisturbed run at most, and no traceback; without a
process, a temporary file or a part of a file. What ends before the first line of ``main``, or in
Python's own last milliseconds, is counted, and is no fault.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import psutil

ROOT: Final = Path(__file__).resolve().parents[1]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from tests.window.display import DisplayUnavailableError, screen  # noqa: E402

SCENE: Final = """\
from distal import Box, Scene, Sphere

part = Box((40, 20, 12)).round(2) - Sphere(8).translate(0, 6, 0)
scene = Scene(part, look="studio")
"""
_START: Final = "import sys, re\nfrom distal.cli import main\nsys.exit(main())"  # as pip's script
_LEFT_S: Final = 3.0  # from ctrl-C to the end of a process
_TO_DIE_S: Final = 0.5  # until a process that was ended is gone from the table
_MARK: Final = "DISTAL_SWEPT"
_OUTSIDE: Final = "outside of main"
_IN_MAIN: Final = re.compile(r'cli.__init__\.py", line \d+, in main')


@dataclass(frozen=True, slots=True)
class Command:
    """A command of the sweep.

    Attributes:
        words: Its command line.
        seconds: When it is interrupted at the latest; None for its own time.
        kept: What it may leave, as patterns: what the next run goes on with.
        lines: How many lines it may add on stderr.
        before: A command line that makes what it needs.
        needs_screen: Whether it opens a window.
    """

    words: str
    seconds: float | None = None
    kept: tuple[str, ...] = ()
    lines: int = 1
    before: str = ""
    needs_screen: bool = False


_FILM: Final = "video example:raymarcher --duration 4 --fps 10 --size 96x64 -o film.mp4"
COMMANDS: Final[Mapping[str, Command]] = {
    "render": Command("render part.py:scene --size 160x120 -o out.png"),
    "preview": Command(
        "render part.py:scene --mode path --samples 64 --size 160x120 -o out.png",
        kept=("out.png", "out.png.film"),
        lines=2,  # what is kept, and how to go on
    ),
    "video": Command(_FILM, kept=(".film.mp4.distal/*",)),
    "cluster": Command(f"{_FILM} --cluster local:2", kept=(".film.mp4.distal/*",)),
    "sweep": Command(
        "sweep part.py:scene --set time=0,1,2 --size 80x60 -o out.png", kept=("out.csv",)
    ),
    "mesh": Command("mesh part.py:part -o out.3mf"),
    "slice": Command("slice part.py:part -o layers --height 1", kept=("layers/*.svg",)),
    "measure": Command("measure part.py:part"),
    "check": Command("check part.py:scene"),
    "probe": Command("probe part.py:scene --at 20,20 --size 80x60"),
    "compile": Command("compile part.py:scene --target glsl-es300 -o out.glsl"),
    "export": Command("export part.py:scene -o out.html"),
    "rerender": Command("rerender in.png -o out.png", before="render part.py:scene -o in.png"),
    "new": Command("new new.py"),
    "examples": Command("examples"),
    "doctor": Command("doctor"),
    "studio": Command("studio part.py --no-browser", seconds=3.0),
    "view": Command("view part.py:scene --size 320x240", seconds=3.0, needs_screen=True),
}


@dataclass(frozen=True, slots=True)
class End:
    """How a run ended.

    Attributes:
        code: Its exit code.
        errors: The lines on stderr.
        seconds: From ctrl-C, or from its start, to its end; infinite if it was killed.
        processes: What is left of its processes.
        temporary: What is left in its folder for temporary files.
        files: The bytes of each file beside the scene, by name.
    """

    code: int
    errors: tuple[str, ...]
    seconds: float
    processes: tuple[str, ...]
    temporary: tuple[str, ...]
    files: Mapping[str, bytes]


class Bench:
    """A folder in which a command runs again and again.

    Args:
        command: The command.
        folder: An empty folder.
        environment: Variables beside those of this process.
    """

    def __init__(self, command: Command, folder: Path, environment: Mapping[str, str]) -> None:
        self.command, self._folder = command, folder
        self._before = {"part.py": SCENE.encode()}
        self._environment = {
            **os.environ,
            **environment,
            "PYTHONPATH": str(ROOT / "src"),
            "TMPDIR": str(folder / "temporary"),
            "DISTAL_CACHE_DIR": str(folder / "cache"),
        }
        self._clear()
        if command.before:
            self.run(command.before.split())
            self._before = dict(self._files())
        self.whole: End | None = None
        self.seconds = command.seconds or 0.0

    def measure(self) -> None:
        """Run the command undisturbed: how long it takes, and what it writes."""
        words = self.command.words.split()
        self.run(words, self.command.seconds)  # what it compiles is kept
        begin = time.monotonic()
        self.whole = self.run(words, self.command.seconds)
        self.seconds = self.command.seconds or time.monotonic() - begin
        if self.whole.code not in ((0,) if self.command.seconds is None else (0, 130)):
            raise SystemExit("\n".join((self.command.words, *self.whole.errors)))

    def interrupted(self, moment: float, *, cold: bool = False) -> End:
        """Run the command, and interrupt it.

        Args:
            moment: Seconds after its start.
            cold: Whether nothing is kept of what earlier runs have compiled.
        """
        if cold:
            shutil.rmtree(self._folder / "cache", ignore_errors=True)
        return self.run(self.command.words.split(), moment)

    def run(self, words: Sequence[str], moment: float | None = None) -> End:
        """Run a command line; interrupt it at a moment, if there is one."""
        self._clear()
        mark = secrets.token_hex(8)
        process = subprocess.Popen(
            [sys.executable, "-c", _START, *words],
            cwd=self._folder / "work",
            env={**self._environment, _MARK: mark},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,  # a group of its own, as a shell gives to each command
            restore_signals=True,
        )
        begin, patience = time.monotonic(), 300.0
        if moment is not None:
            with suppress(subprocess.TimeoutExpired):
                process.wait(moment)
            begin, patience = time.monotonic(), 2 * _LEFT_S
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGINT)
        errors, seconds = "", float("inf")
        try:
            errors = process.communicate(timeout=patience)[1]
            seconds = time.monotonic() - begin
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        left = _processes(mark)
        return End(
            process.returncode,
            tuple(errors.splitlines()),
            seconds,
            left,
            tuple(str(path) for path in (self._folder / "temporary").rglob("*")),
            self._files(),
        )

    def _files(self) -> dict[str, bytes]:
        work = self._folder / "work"
        return {
            str(path.relative_to(work)): path.read_bytes()
            for path in sorted(work.rglob("*"))
            if path.is_file() and "__pycache__" not in path.parts
        }

    def _clear(self) -> None:
        for name in ("work", "temporary"):
            shutil.rmtree(self._folder / name, ignore_errors=True)
            (self._folder / name).mkdir()
        for name, content in self._before.items():
            (self._folder / "work" / name).write_bytes(content)

    def is_outside(self, end: End) -> bool:
        """Return whether a run ended before ``main``, or after it, by the signal."""
        said = "\n".join(end.errors)
        if end.code == -signal.SIGINT and (not said or self._is_whole(end)):
            return True
        return "KeyboardInterrupt" in said and not _IN_MAIN.search(said)

    def _is_whole(self, end: End) -> bool:
        whole = self.whole
        return whole is not None and (_said(end), end.files) == (_said(whole), whole.files)

    def faults(self, end: End) -> list[str]:
        """Return what is wrong with a run that was interrupted."""
        found = []
        if end.seconds > _LEFT_S:
            found.append(f"ended after {end.seconds:.1f} s")
        if end.code not in (0, 130):
            found.append(f"exit code {end.code}")
        usual = Counter[str]() if self.whole is None else _said(self.whole)
        more = list((_said(end) - usual).elements())
        if len(more) > self.command.lines or "Traceback" in "".join(more):
            found.append(f"{len(more)} lines on stderr")
        if end.processes:
            found.append(f"processes left: {', '.join(end.processes)}")
        if end.temporary:
            found.append(f"temporary files left: {', '.join(end.temporary)}")
        for name, content in end.files.items():
            whole = self._before.get(name) if self.whole is None else self.whole.files.get(name)
            if content != whole and not any(Path(name).match(each) for each in self.command.kept):
                found.append(f"{'a part of' if whole is not None else 'left'} {name}")
        return found


def _said(end: End) -> Counter[str]:
    """Return the lines of a run, without the numbers, which are times."""
    return Counter(re.sub(r"[\d.]+", "#", line) for line in end.errors)


def _processes(mark: str) -> tuple[str, ...]:
    """Return the processes of a run that are left after a while; they are ended."""
    deadline = time.monotonic() + _TO_DIE_S
    while True:
        left = list(_marked(mark))
        if not left or time.monotonic() > deadline:
            break
        time.sleep(0.05)
    found = []
    for process in left:
        with suppress(psutil.Error):
            found.append(" ".join(process.cmdline())[:80])
            process.kill()
    return tuple(found)


def _marked(mark: str) -> list[Any]:
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            is_dead = process.status() == psutil.STATUS_ZOMBIE
            if not is_dead and process.environ().get(_MARK) == mark:
                found.append(process)
    return found


def moments(rng: random.Random, seconds: float, count: int) -> list[float]:
    """Return moments of a run: half of them anywhere, the others near its start and its end."""
    places = ((0.0, seconds), (0.0, 0.25), (0.0, seconds), (max(0.0, seconds - 0.2), seconds))
    return [rng.uniform(*places[i % len(places)]) for i in range(count)]


def swept(name: str, count: int, rng: random.Random, environment: Mapping[str, str]) -> int:
    """Interrupt a command at some moments, print what happened; return the number of faults."""
    faults, ends, slowest = 0, Counter[str](), 0.0
    with tempfile.TemporaryDirectory(prefix="distal-interrupts-") as folder:
        bench = Bench(COMMANDS[name], Path(folder), environment)
        bench.measure()
        for moment in moments(rng, bench.seconds, count):
            end = bench.interrupted(moment, cold=rng.random() < 0.2)
            if bench.is_outside(end):
                ends[_OUTSIDE] += 1
                continue
            ends[str(end.code)] += 1
            slowest = max(slowest, end.seconds)
            for fault in bench.faults(end):
                faults += 1
                print(f"  {name} at {moment:.3f} s: {fault}")
                print("".join(f"    | {line}\n" for line in end.errors[-30:]), end="", flush=True)
    listed = ", ".join(f"{end}: {number}" for end, number in sorted(ends.items()))
    print(f"{name}: {bench.seconds:.2f} s; {listed}; slowest {slowest:.2f} s; {faults} faults")
    sys.stdout.flush()
    return faults


def main() -> None:
    """Sweep the commands of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=", ".join(COMMANDS))
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=secrets.randbelow(10**6))
    options = parser.parse_args()
    unknown = set(options.commands) - set(COMMANDS)
    if unknown:
        parser.error(f"there is no command {', '.join(sorted(unknown))}")
    # A shell's job in the background ignores ctrl-C, and so would what it starts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    print(f"seed {options.seed}")
    faults = 0
    with ExitStack() as stack:
        for name in options.commands or COMMANDS:
            environment = {}
            if COMMANDS[name].needs_screen:
                try:
                    environment["DISPLAY"] = stack.enter_context(screen())
                except DisplayUnavailableError as error:
                    print(f"{name}: skipped, {error}")
                    continue
            rng = random.Random(f"{options.seed} {name}")
            faults += swept(name, options.count, rng, environment)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
