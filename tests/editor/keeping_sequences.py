"""Random sequences of typing, saves, other programs, choices, reloads and kills, without a browser.

Input: a seed. Output: nothing, or an assertion that names the seed and the steps. A page of the
studio is imitated by the rules of ``web/src/studio/file_state.ts`` and ``drafts.ts``; its server is
the real one, with a clock of the test. What must hold: every text that was on the disk while the
studio ran, or in a page for a second, is on the disk, in a draft or in a version; and nothing is
overwritten that the page's person has not seen. Run as a program it does many.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from distal.editor.local.drafts import Draft, Drafts
from distal.editor.local.files import SceneFiles
from distal.editor.local.tab import StudioTab
from distal.editor.messages import encoded
from distal.file_writer import writing

NAME = "scene.py"
KEY_S, POLL_S = 0.25, 0.3
STEPS = 24


class Clock:
    """Seconds that pass when the test says so."""

    def __init__(self) -> None:
        self.now = 1.8e9

    def __call__(self) -> float:
        return self.now


class SilentWorker:
    """A worker that answers nothing."""

    def __init__(self, *_: object) -> None: ...

    def send(self, _: str) -> None: ...

    def kill(self) -> None: ...


@dataclass
class Page:
    """A page of the studio: the state of its one file, and what its tab remembers."""

    text: str | None = None
    base: tuple[str, str | None] = ("", None)
    disk: tuple[str, str | None, int] = ("", None, -1)
    since: float = 0.0  # when its text came
    due: float | None = None  # when its draft is sent
    agreed: set[str] = field(default_factory=set)  # texts of the disk that may be overwritten
    tab: str = ""
    unsent: dict[str, str] | None = None  # what the tab's storage has for a reload
    session: StudioTab | None = None
    answers: dict[int, dict[str, Any]] = field(default_factory=dict)
    told: list[dict[str, Any]] = field(default_factory=list)
    is_greeted: bool = False
    number: int = 0

    @property
    def is_mine(self) -> bool:
        return not self.base[0] or self.text != self.base[1]

    @property
    def is_open(self) -> bool:
        return self.disk[0] != self.base[0]

    def same(self) -> None:
        self.base, self.text = self.disk[:2], self.disk[1]
        assert self.text is not None
        self.agreed.add(self.text)

    def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        """Ask the server; its answer comes at once."""
        self.number += 1
        assert self.session is not None
        message = {"kind": kind, "id": self.number, "revision": 0, **fields}
        self.session.received(json.dumps(message))
        return self.answers.pop(self.number)

    def sent(self, text: str) -> None:
        """Take a message of the server."""
        message = json.loads(text)
        if message["kind"] == "changed":
            if self.is_greeted:
                self.changed(message)
            else:
                self.told.append(message)
        elif "id" in message:
            self.answers[message["id"]] = message

    def changed(self, message: dict[str, Any]) -> None:
        text, digest = message["files"][NAME], message["digests"][NAME]
        problem = message["problems"].get(NAME)
        order = message["order"]
        if self.text is None:
            self.text, self.base = text, (digest, text)
            self.disk = (digest, text if digest else None, order)
            self.agreed.add(text)
        if problem:
            self.seen(problem["digest"], None, order)
        else:
            self.seen(digest, text if digest else None, order)

    def seen(self, digest: str, text: str | None, order: int) -> None:
        if order < self.disk[2]:
            return
        self.disk = (digest, text, order)
        if text is not None and (not self.is_mine or text == self.text):
            self.same()

    def typed(self, text: str) -> None:
        self.text = text
        if self.disk[1] == text:
            self.same()

    def restored(self, text: str, digest: str) -> None:
        if digest != self.base[0]:
            self.base = (digest, None)
        self.typed(text)

    def keep(self) -> None:
        """Send the unsaved text, as before a compilation."""
        self.due = None
        is_unsaved = self.is_mine or self.is_open
        self.unsent = {"text": str(self.text), "digest": self.base[0]} if is_unsaved else None
        if self.session is None or not self.is_greeted:
            return
        text = self.text if is_unsaved else None
        answer = self.ask("draft", file=NAME, text=text, digest=self.base[0])
        assert answer["result"]["unkept"] == "", answer
        self.unsent = None


class Studio:
    """A server and its pages on one file, and what they owe.

    Args:
        folder: An empty folder.
        seed: Of the random choices.
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self.random = random.Random(seed)
        self.clock = Clock()
        self.file = folder / "scenes" / NAME
        self.state = folder / "state"
        self.file.parent.mkdir()
        self.count = 0
        self.steps: list[str] = []
        self.owed: dict[str, str] = {}  # texts, and where they were
        self.pages: list[Page] = []
        self.outside()
        self.start()
        self.open()

    def new_text(self, who: str) -> str:
        self.count += 1
        return f"x = {self.count}  # {who}\n"

    # The server

    def start(self) -> None:
        unsaved = None if self.file.exists() else {NAME: self.new_text("starter")}
        self.files = SceneFiles(self.file, unsaved)
        self.drafts = Drafts(self.state, self.files.folder, self.clock)
        self.files.keep_in(self.drafts)
        self.owe_disk()

    def connect(self, page: Page) -> None:
        def saved(changed: Any) -> None:
            for other in self.pages:
                if other is not page and other.session is not None:
                    other.sent(encoded(changed))

        page.is_greeted, page.told = False, []
        page.disk = (*page.disk[:2], -1)
        page.sent(encoded(self.files.all()))
        page.session = StudioTab(
            self.files,
            page.sent,
            saved=saved,
            start=SilentWorker,  # type: ignore[arg-type]
        )
        is_new = page.text is None
        greeted = page.ask("hello", tab=page.tab, is_new=is_new)["result"]
        assert greeted["unkept"] == ""
        page.tab, page.is_greeted = greeted["tab"], True
        for message in page.told:
            page.changed(message)
        draft = {NAME: greeted["drafts"].get(NAME), **({NAME: page.unsent} if page.unsent else {})}
        if is_new and draft[NAME] is not None:
            page.restored(**draft[NAME])
        page.since = self.clock.now
        page.keep()

    def open(self) -> None:
        page = Page()
        self.pages.append(page)
        self.connect(page)

    def kill(self) -> None:
        """End the server without a word; what is on the disk stays."""
        for page in self.pages:
            if page.session is not None:
                page.session.end()
            page.session, page.is_greeted = None, False
        self.drafts.close()

    def pass_time(self, seconds: float) -> None:
        """Let time pass: drafts are sent, files are looked at."""
        end = self.clock.now + seconds
        while True:
            dues = [page.due for page in self.pages if page.due is not None]
            moment = min([end, *dues, self.clock.now + POLL_S])
            self.clock.now = max(self.clock.now, moment)
            for page in self.pages:
                if page.due is not None and page.due <= self.clock.now:
                    page.keep()
            changed = self.files.read() if any(p.session for p in self.pages) else None
            if changed is not None:
                for page in self.pages:
                    if page.session is not None:
                        page.sent(encoded(changed))
            self.owe_pages()
            if self.clock.now >= end:
                return

    # What is owed

    def owe_disk(self) -> None:
        if self.file.is_file():
            self.owed.setdefault(self.file.read_text(), "on the disk")

    def owe_pages(self) -> None:
        for page in self.pages:
            if page.text is not None and self.clock.now - page.since >= 1.0:
                self.owed.setdefault(page.text, "in a page")

    def check(self) -> None:
        """Every text that is owed is somewhere.

        Raises:
            AssertionError: One is not.
        """
        there = {path.read_text() for path in self.state.glob("*/*/versions/*.py")}
        for path in self.state.glob("*/*/*.json"):
            draft = Draft.of(path)
            assert draft is not None
            there.add(draft.text)
        there |= {path.read_text() for path in self.file.parent.glob("*.py") if path.is_file()}
        for text, where in self.owed.items():
            assert text in there, f"{text!r} was {where} and is lost; {self.steps}"

    # Steps

    def outside(self) -> None:
        """Another program saves: by a rename, or in place."""
        text = self.new_text("other")
        if self.file.is_dir():
            self.file.rmdir()
        if self.random.random() < 0.5 or not self.file.exists():
            beside = self.file.with_name("beside.tmp")
            beside.write_text(text)
            os.replace(beside, self.file)
        else:
            self.file.write_text(text)

    def step_outside(self) -> None:
        self.outside()
        self.pass_time(POLL_S)
        self.owe_disk()

    def step_gone(self) -> None:
        if self.file.is_file():
            self.random.choice([os.unlink, lambda p: os.replace(p, p.with_name("moved.py"))])(
                self.file
            )
        self.pass_time(POLL_S)

    def step_folder(self) -> None:
        if self.file.is_file():
            self.file.unlink()
        if not self.file.exists():
            self.file.mkdir()
        self.pass_time(POLL_S)

    def step_type(self) -> None:
        page = self.random.choice(self.pages)
        assert page.text is not None
        if page.disk[1] is not None and self.random.random() < 0.1:
            page.typed(page.disk[1])
        else:
            page.typed(self.new_text("typed"))
        page.since = self.clock.now
        page.due = page.due or self.clock.now + KEY_S
        self.pass_time(self.random.choice([0.01, 0.2, 1.1, 3.0]))

    def step_save(self) -> None:
        page = self.random.choice(self.pages)
        page.keep()
        if page.is_open:
            return self.choose(page)
        self.save(page)
        page.keep()

    def save(self, page: Page) -> None:
        """Save; now and then another program saves before it, or while it is written."""
        chance = self.random.random()
        if chance < 0.15 and self.file.is_file():
            self.outside()  # which nobody has told the page
            self.owed.setdefault(self.file.read_text(), "on the disk")
        before = self.file.read_text() if self.file.is_file() else None
        moment = "before" if chance > 0.85 else "after" if chance > 0.7 else ""
        with raced(self.outside, moment) as others:
            text = page.text
            answer = page.ask("save", file=NAME, text=text, digest=page.base[0] or None)
        for other in others:
            self.owed.setdefault(other, "on the disk while it was replaced")
        if answer["kind"] == "mistakes":  # a folder, as is said
            assert not self.file.is_file(), answer
            return
        result = answer["result"]
        if not result["is_saved"]:
            page.seen(result["digest"], result["conflict"], result["order"])
            self.owe_disk()
            return
        assert before is None or before in page.agreed, f"{before!r} was overwritten; {self.steps}"
        assert not others or result["other"] == others[0], "the page is not told of the other text"
        assert self.file.read_text() == text
        page.base = (result["digest"], text)
        if result["order"] >= page.disk[2]:
            page.disk = (result["digest"], text, result["order"])
        page.agreed.add(str(text))
        self.owe_disk()

    def step_choose(self) -> None:
        self.choose(self.random.choice(self.pages))

    def choose(self, page: Page) -> None:
        """Press a button of the conflict, if there is one."""
        if not page.is_open or page.disk[0] == "?":
            return
        page.keep()
        choice = self.random.choice(["mine", "theirs", "none"])
        if choice == "mine":
            page.base = page.disk[:2]
            if page.disk[1] is not None:
                page.agreed.add(page.disk[1])
            self.save(page) if self.random.random() < 0.5 else None
        elif choice == "theirs" and page.disk[1] is not None:
            page.same()
            page.since = self.clock.now
        page.keep()

    def step_reload(self) -> None:
        page = self.random.choice(self.pages)
        page.keep()
        if page.session is not None:
            page.session.end()
        self.pages[self.pages.index(page)] = fresh = Page(tab=page.tab, unsent=page.unsent)
        self.connect(fresh)

    def step_tab(self) -> None:
        if len(self.pages) < 3:
            self.open()

    def step_close(self) -> None:
        if len(self.pages) > 1:
            page = self.pages.pop(self.random.randrange(len(self.pages)))
            page.keep()
            assert page.session is not None
            page.session.end()

    def step_kill(self) -> None:
        """Kill the server; the pages type on, and connect again or are left at the old port."""
        self.kill()
        for page in self.pages:
            if self.random.random() < 0.3:
                page.typed(self.new_text("while away"))
                page.since = self.clock.now
                page.keep()
        if self.file.is_dir():
            self.file.rmdir()
        if self.random.random() < 0.3:
            self.outside()
        self.clock.now += 0.5
        self.start()
        if self.random.random() < 0.5:
            for page in self.pages:
                self.connect(page)
        else:
            self.pages = []
            self.open()

    def run(self, steps: int = STEPS) -> None:
        """Do some steps; what is owed is checked after each."""
        names = [name for name in dir(self) if name.startswith("step_")]
        weights = [{"step_type": 6, "step_save": 4, "step_choose": 2}.get(n, 1) for n in names]
        for _ in range(steps):
            (name,) = self.random.choices(names, weights)
            self.steps.append(name.removeprefix("step_"))
            getattr(self, name)()
            self.pass_time(0.05)
            self.check()
        self.kill()
        self.check()


class raced:  # noqa: N801 (a context)
    """Lets another program save at a moment of the writer: before or after its last look."""

    def __init__(self, act: Callable[[], None], moment: str) -> None:
        self.act, self.moment, self.others = act, moment, list[str]()

    def __enter__(self) -> list[str]:
        self.checked = checked = writing._checked

        def look(path: Path, target: Path, expected: Any) -> None:
            if self.moment == "before" and expected:
                self.save(target)
            checked(path, target, expected)
            if self.moment == "after" and expected:
                self.save(target)

        writing._checked = look  # type: ignore[assignment]
        return self.others

    def save(self, target: Path) -> None:
        self.moment = ""
        self.act()
        self.others.append(target.read_text())

    def __exit__(self, *_: object) -> None:
        writing._checked = self.checked


def run(seed: int) -> None:
    """Run a sequence in a folder of its own."""
    folder = Path(tempfile.mkdtemp(prefix="distal_keeping_"))
    try:
        studio = Studio(folder, seed)
        try:
            studio.run()
        except BaseException as error:
            error.add_note(f"seed {seed}: {studio.steps}")
            raise
        finally:
            studio.kill()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def main(run: Callable[[int], None] = run, what: str = f"sequences of {STEPS} steps") -> None:
    """Run as many sequences as the first argument says, from the seed that is the second."""
    count, first = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    for seed in range(first, first + count):
        run(seed)
    sys.stdout.write(f"{count} {what}: nothing was lost\n")


if __name__ == "__main__":
    main()
