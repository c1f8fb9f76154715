"""Random sequences as in ``keeping_sequences.py``, in two tabs of a browser, with a real server.

Input: how many, and the first seed. Output: a line, or an assertion that names the seed and the
steps. The server is a process that is killed; another one, at another port, takes its place.
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from distal.editor.local.drafts import Draft
from tests.browser import kept_page
from tests.editor.keeping_sequences import main
from tests.editor.studio_page import DESK, SLOW_MS, TEXT

STEPS = 14
SCENE = "from distal import *\nscene = Scene(Sphere(0.5))\n"
STARTED = "() => window.studio?.editor?.name"
SERVER = """
import sys
from pathlib import Path
from distal.editor.local.files import SceneFiles
from distal.editor.local.server import StudioServer
server = StudioServer(SceneFiles(Path(sys.argv[1])), limit=60.0)
print(server.address, flush=True)
server.serve()
"""


def start(file: Path, **more: str) -> tuple[subprocess.Popen[str], str]:
    """Start a server on a file; return its process and its address."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **more}
    command = [sys.executable, "-c", SERVER, str(file)]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert server.stdout is not None
    return server, server.stdout.readline().strip()


def end(server: subprocess.Popen[str]) -> None:
    """Kill a server."""
    server.kill()
    server.wait()
    assert server.stdout is not None
    server.stdout.close()


class Sequence:
    """One sequence."""

    def __init__(self, folder: Path, seed: int, kept: Any) -> None:
        self.random, self.kept, self.count = random.Random(seed), kept, 0
        self.state, self.file = folder / "state", folder / "scene.py"
        self.file.write_text(SCENE)
        self.owed: dict[str, str] = {}
        self.steps: list[str] = []
        self.server, self.pages = self.started()

    def started(self) -> tuple[subprocess.Popen[str], list[Any]]:
        """Start a server; open it in two tabs, of which the second may have been open before."""
        server, address = start(self.file, XDG_STATE_HOME=str(self.state))
        pages = [self.kept.page, self.kept.context.new_page()]
        for page, where in zip(
            pages, (address, address.split("/#")[0].split("/?")[0]), strict=True
        ):
            page.goto(where)
            page.wait_for_function(STARTED, timeout=SLOW_MS)
        self.owed.setdefault(self.file.read_text(), "on the disk")
        return server, pages

    def step_type(self) -> None:
        page = self.random.choice(self.pages)
        self.count += 1
        page.evaluate("() => studio.editor.goTo(1)")
        page.keyboard.insert_text(f"# typed {self.count}\n")
        text = page.evaluate(TEXT)
        if self.random.random() < 0.6:
            page.wait_for_timeout(1300)
            if page.evaluate(TEXT) == text:
                self.owed.setdefault(text, "in a page")
        else:
            page.wait_for_timeout(self.random.choice([0, 100, 300]))

    def step_other(self) -> None:
        self.count += 1
        self.file.write_text(f"# other {self.count}\n{SCENE}")
        self.pages[0].wait_for_timeout(900)
        self.owed.setdefault(self.file.read_text(), "on the disk")

    def step_save(self) -> None:
        page = self.random.choice(self.pages)
        page.keyboard.press("Control+s")
        page.wait_for_timeout(600)
        if page.locator("dialog[open]").count():
            buttons = page.locator("dialog .choices button")
            buttons.nth(self.random.randrange(buttons.count())).click()
            page.wait_for_timeout(500)
        self.owed.setdefault(self.file.read_text(), "on the disk")

    def step_choose(self) -> None:
        page = self.random.choice(self.pages)
        buttons = page.locator(".state-bar button", has_text="mine")
        others = page.locator(".state-bar button", has_text="Take")
        chosen = self.random.choice([buttons, others])
        if chosen.count():
            chosen.first.click()
            page.wait_for_timeout(300)

    def step_reload(self) -> None:
        page = self.random.choice(self.pages)
        page.reload()
        page.wait_for_function(STARTED, timeout=SLOW_MS)

    def step_kill(self) -> None:
        end(self.server)
        self.pages[1].close()
        if self.random.random() < 0.4:
            self.count += 1
            self.file.write_text(f"# away {self.count}\n{SCENE}")
        self.server, self.pages = self.started()

    def check(self) -> None:
        """Every text that is owed is somewhere.

        Raises:
            AssertionError: One is not.
        """
        drafts = self.state / "distal" / "drafts"
        there = {path.read_text() for path in drafts.glob("*/*/versions/*.py")}
        there |= {draft.text for path in drafts.glob("*/*/*.json") if (draft := Draft.of(path))}
        there.add(self.file.read_text())
        for text, where in self.owed.items():
            assert text in there, f"{text!r} was {where} and is lost"

    def run(self) -> None:
        """Do the steps."""
        steps = {"type": 5, "save": 3, "choose": 2, "other": 2, "reload": 1, "kill": 1}
        for _ in range(STEPS):
            (name,) = self.random.choices(list(steps), list(steps.values()))
            self.steps.append(name)
            getattr(self, f"step_{name}")()
            self.check()


def run(seed: int) -> None:
    """Run a sequence in a folder of its own."""
    folder = Path(tempfile.mkdtemp(prefix="distal_keeping_"))
    with kept_page(reduced_motion="reduce", **DESK) as kept:
        sequence = Sequence(folder, seed, kept)
        try:
            sequence.run()
        except BaseException as error:
            error.add_note(f"seed {seed}: {sequence.steps}")
            raise
        finally:
            end(sequence.server)
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(run, f"sequences of {STEPS} steps in a browser")
