"""A screen without a monitor, and ``distal view`` on it, with hands.

In: arguments of the command. Out: what is on the screen, as pixels; what the window tells of itself
through ``DISTAL_VIEW_LOG``. Gestures are those of xdotool: the window cannot tell them from a
person's.
"""

from __future__ import annotations

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

SCREEN = (1024, 768)
PATIENCE_S = 180.0  # a first window compiles: 10 s of a processor that others use too


class DisplayUnavailableError(RuntimeError):
    """No screen can be made here; tests skip aloud on it."""


@contextmanager
def screen() -> Iterator[str]:
    """A running Xvfb; the name of its display."""
    for program in ("Xvfb", "xdotool", "import"):
        if shutil.which(program) is None:
            raise DisplayUnavailableError(f"{program} is not installed")
    read, write = os.pipe()
    size = f"{SCREEN[0]}x{SCREEN[1]}x24"
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-nolisten", "tcp"],
        pass_fds=[write],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as answer:
            number = answer.readline().strip()  # empty if the server ends without a display
        if not number:
            raise DisplayUnavailableError("Xvfb does not start")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(10)


class Window:
    """``distal view`` as a process."""

    def __init__(
        self, display: str, arguments: Sequence[str], folder: Path, **environment: str
    ) -> None:
        self._log = folder / "view.log"
        self._log.unlink(missing_ok=True)
        self._environment = {**os.environ, "DISPLAY": display, "DISTAL_VIEW_LOG": str(self._log)}
        self._environment |= environment
        self._errors = (folder / "stderr.txt").open("w+")
        self.process = subprocess.Popen(
            [sys.executable, "-m", "distal.cli", "view", *arguments],
            cwd=folder,
            env=self._environment,
            stdout=subprocess.DEVNULL,
            stderr=self._errors,
        )

    @property
    def errors(self) -> str:
        """What it said on the terminal."""
        self._errors.seek(0)
        return self._errors.read()

    @property
    def events(self) -> list[dict[str, Any]]:
        """What it logged, whole lines only."""
        if not self._log.exists():
            return []
        lines = self._log.read_text().split("\n")[:-1]
        return [json.loads(line) for line in lines]

    def wait(self, holds: Callable[[dict[str, Any]], bool], since: int = 0) -> dict[str, Any]:
        """The first event from number ``since`` on of which something holds, waited for."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            for event in self.events[since:]:
                if holds(event):
                    return event
            if self.process.poll() is not None:
                raise AssertionError(f"the window closed: {self.errors}")
            time.sleep(0.05)
        raise AssertionError(f"it did not happen; last: {self.events[-3:]}; {self.errors}")

    def sharp(self, since: int = 0, **facts: Any) -> dict[str, Any]:
        """What is on the screen once it is sharp, with these facts."""

        def holds(event: dict[str, Any]) -> bool:
            shown = event.get("shown", {})
            return (
                event["event"] == "drawn"
                and shown["is_final"]
                and all(shown[name] == value for name, value in facts.items())
            )

        shown: dict[str, Any] = self.wait(holds, since)["shown"]
        if shown["steering"] is not None:  # from now on gestures move the camera at once
            self.wait(lambda event: event["event"] == "guided")
        return shown

    def settled(self) -> dict[str, Any]:
        """What is on the screen once it is sharp and nothing was drawn for a while."""
        end = time.monotonic() + PATIENCE_S
        before: list[dict[str, Any]] = []
        while time.monotonic() < end:
            time.sleep(0.5)
            assert self.process.poll() is None, self.errors
            events = self.events
            told = [event for event in events if event["event"] in ("frame", "drawn")]
            # A frame that is not drawn yet: a busy machine.
            is_drawn = bool(told) and told[-1]["event"] == "drawn"
            if is_drawn and told[-1]["shown"]["is_final"] and events == before:
                shown: dict[str, Any] = told[-1]["shown"]
                return shown
            before = events
        raise AssertionError(f"it does not come to rest; {self.errors}")

    def appears(self) -> None:
        """Wait until it is on the screen: its file is read, and it looks for changes."""
        command = ["xdotool", "search", "--sync", "--name", "distal"]
        subprocess.run(
            command, env=self._environment, check=True, timeout=PATIENCE_S, capture_output=True
        )

    def hands(self, *words: str | int) -> None:
        """Move the pointer, press buttons and keys."""
        subprocess.run(["xdotool", *map(str, words)], env=self._environment, check=True, timeout=20)

    def drag(
        self, start: tuple[int, int], end: tuple[int, int], button: int = 1, hold: str = ""
    ) -> None:
        """Drag from a place on the screen to another."""
        self.hands("mousemove", *start)
        time.sleep(0.15)
        if hold:
            self.hands("keydown", hold)
        self.hands("mousedown", button)
        middle = [(s + e) // 2 for s, e in zip(start, end, strict=True)]
        self.hands("mousemove", *middle, "sleep", "0.1", "mousemove", *end, "sleep", "0.1")
        self.hands("mouseup", button)
        if hold:
            self.hands("keyup", hold)

    def screenshot(self, size: tuple[int, int]) -> NDArray[np.float32]:
        """The window as it is on the screen, 0 to 1, (height, width, 3)."""
        found = subprocess.run(
            ["import", "-window", "root", "png:-"],
            env=self._environment,
            check=True,
            capture_output=True,
            timeout=20,
        )
        image = Image.open(io.BytesIO(found.stdout)).convert("RGB")
        return np.asarray(image, np.float32)[: size[1], : size[0]] / np.float32(255)

    def end(self) -> int:
        """End it as ctrl-C does; its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.process.wait(15)

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._errors.close()
