"""Pictures and films: the commands that make them, one after the other, in processes of their own.

Input: requests of tabs. Output: progress and results. A render runs the command that the app shows,
on the texts of the app, in a folder that is removed; the tab's worker knows nothing of it. Needs
the standard library alone until something is rendered.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import secrets
import shutil
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import LoadError
from distal.editor.commands import file_stem, render_arguments, shown, video_arguments
from distal.editor.local.process import ChildProcess
from distal.editor.local.scratch import RENDER, ScratchFolder
from distal.editor.messages import (
    Answer,
    Dropped,
    Message,
    Mistake,
    Mistakes,
    PictureRequest,
    Progress,
    Rendered,
    RenderFormat,
    RenderRequest,
)
from distal.editor.scene_folder import check_name, encoded_text, link_beside
from distal.file_writer import SaveError, TakenError, replacement
from distal.forking import new_lock
from distal.lang.lazy_module import LazyModule
from distal.lang.progress_lines import KEY, LOADING, STAGES

render_choices: Any = LazyModule("distal.editor.local.render_choices")  # needs NumPy

# Seconds without any progress, until a picture and a film are ended: frames of paths take minutes.
PICTURE_S: Final = 120.0
FILM_S: Final = 600.0
CODE_S: Final = 30.0  # for the author's code and the imports before it
_START_S: Final = 60.0  # until the command has begun
_TICK_S: Final = 0.05
_WAITING: Final = "waiting"
_MOST_KEPT: Final = 4  # pictures of a tab that a browser may still fetch
_TEMPORARY: Final = "temporary"  # what the command's libraries put away for a while
_LONGEST_REASON: Final = 400  # characters
_SURE: Final = 0.02  # the share after which the remaining time is estimated


@dataclass(frozen=True, slots=True)
class RenderLimits:
    """The seconds that a render may take for parts of its work.

    Attributes:
        code: The author's code, while it is loaded.
        picture: Without progress, of a picture.
        film: Without progress, of a film.
    """

    code: float = CODE_S
    picture: float = PICTURE_S
    film: float = FILM_S


class RenderJob:
    """One picture or film.

    Args:
        owner: The tab that wants it.
        request: What it wants.
        beside: The folder of the scene.
        limits: The limits of time.
        tell: Sends a message to the tab.
    """

    def __init__(
        self,
        owner: object,
        request: RenderRequest,
        beside: Path,
        limits: RenderLimits,
        tell: Callable[[Message], None],
    ) -> None:
        self.owner, self.request = owner, request
        self._beside, self._limits, self._tell = beside, limits, tell
        self._lock = new_lock()
        self._process: ChildProcess | None = None
        self._over = threading.Event()
        self._is_cancelled = False
        self._is_done = False  # from now on it cannot be cancelled
        self.is_unwanted = False  # its tab is gone
        self._stage, self._begin, self._ends = "", 0.0, 0.0
        self._known = ("", 0.0)
        self._status: tuple[int, str] = (0, "")

    def waits(self) -> None:
        """Tell that others are first."""
        self._report(_WAITING, 0.0, "")

    def cancel(self) -> None:
        """End it, whether it waits or runs; one that is done stays done."""
        with self._lock:
            if self._is_done:
                return
            self._is_cancelled = True
            if self._process is not None:
                self._process.kill()
        self._over.set()

    def drop(self) -> None:
        """Tell that it is not made."""
        self._tell(Dropped(**self.request.numbers))

    def run(self, keep: Callable[[ScratchFolder], None]) -> None:
        """Render and tell the result; ``keep`` gets the folder of a picture that a tab takes."""
        number = self.request.numbers
        place: ScratchFolder | None = None
        result: Rendered | None = None
        try:
            place = ScratchFolder(RENDER)
            result = self._made(place.path)
            answer: Message = Dropped(**number)
            if result is not None:
                answer = Answer(**number, request="render", result=result)
        except (LoadError, SaveError, OSError) as error:
            text = error.reason if isinstance(error, LoadError) else str(error)
            answer = Mistakes(**number, mistakes=(Mistake(severity="error", message=text),))
        except Exception as error:  # the renders of the others go on
            text = f"this cannot be rendered ({type(error).__name__}: {error})"[:_LONGEST_REASON]
            answer = Mistakes(**number, mistakes=(Mistake(severity="error", message=text),))
        # Before the answer is sent: the browser asks for it at once.
        if place is not None and result is not None and result.address is not None:
            keep(place)
        elif place is not None:
            place.remove()
        self._tell(Dropped(**number) if self._is_cancelled else answer)

    def _made(self, place: Path) -> Rendered | None:
        """Return the result, None if it was cancelled; a picture stays in the folder.

        Raises:
            LoadError: It was not made; the reason is that of the command.
            SaveError: It cannot be written beside the scene.
        """
        format = render_choices.format_named(self.request.format)
        check_source(self.request)
        name = f"{file_stem(self.request)}.{format.name}"
        source, made = place / "scene", place / "made"
        for folder in (source, made, place / _TEMPORARY):
            folder.mkdir()
        for file, text in self.request.files.items():
            check_name(file)
            (source / file).write_bytes(encoded_text(file, text))
        link_beside(self._beside, source)
        self._run(arguments_of(self.request, format, str(made / name)), source, format)
        with self._lock:
            if self._is_cancelled:
                return None
            self._is_done = True
        code, report = self._status
        said = report.replace(f"{made}/", "").replace(f"{source}/", "").strip()
        if code != 0 or not (made / name).is_file():
            raise LoadError(_reason(code, said))
        size = (made / name).stat().st_size
        address = None if format.film else f"/results/{place.name}/{secrets.token_urlsafe(12)}"
        if address is None:
            name = placed(made / name, self._beside).name
        else:
            (made / name).rename(made / address.rpartition("/")[2])
        command = shown(arguments_of(self.request, format, name))
        return Rendered(name=name, bytes=size, address=address, command=command, said=said)

    def _run(self, arguments: Sequence[str], folder: Path, format: RenderFormat) -> None:
        """Run the command to its end.

        Raises:
            LoadError: It was ended, because the author's code or the picture came to no end.
        """
        command = [sys.executable, "-P", "-m", "distal.cli", *arguments, "--progress", "json"]
        idle = self._limits.film if format.film else self._limits.picture
        self._ends = time.monotonic() + _START_S

        def received(line: str) -> None:
            self._received(line, idle)

        with self._lock:
            if self._is_cancelled:
                return
            self._process = ChildProcess(
                command,
                received,
                self._ended,
                folder=folder,
                temporary=folder.with_name(_TEMPORARY),
                is_lowered=True,
            )
        while not self._over.wait(_TICK_S):
            if time.monotonic() > self._ends:
                self._process.kill()
                if self._stage == LOADING:
                    limit = self._limits.code
                    raise LoadError(f"the scene's code came to no end within {limit:g} s")
                raise LoadError(f"there was no progress for {idle:g} s: does a loop run for ever?")

    def _received(self, line: str, idle: float) -> None:
        """Read a line of the command; what the author's code prints is left out."""
        try:
            found = json.loads(line)
            stage, done, text = found[KEY], float(found["done"]), str(found["text"])
        except (ValueError, TypeError, KeyError):
            return
        if stage not in STAGES or not 0.0 <= done <= 1.0 or len(text) > _LONGEST_REASON:
            return
        if (stage, done) != self._known:  # a device reports the same share again and again
            self._known = (stage, done)
            self._ends = time.monotonic() + (self._limits.code if stage == LOADING else idle)
        self._report(stage, done, text)

    def _report(self, stage: str, done: float, text: str) -> None:
        now = time.monotonic()
        if stage != self._stage:
            self._stage, self._begin = stage, now
        remaining = (now - self._begin) * (1.0 - done) / done if done > _SURE else None
        self._tell(
            Progress(
                **self.request.numbers,
                done=done,
                label=stage,
                text=text,
                remaining_s=remaining,
            )
        )

    def _ended(self, code: int, report: str) -> None:
        self._status = (code, report)
        self._over.set()


def check_source(request: PictureRequest) -> None:
    """Check that a request names one of its own files, and an object as Python would.

    Raises:
        LoadError: It does not: its words would be a path.
    """
    if request.main not in request.files:
        raise LoadError(f"there is no file '{request.main[:80]}' among the texts")
    if request.object is not None and not request.object.isidentifier():
        raise LoadError(f"'{request.object[:80]}' is not the name of a scene")


def arguments_of(request: PictureRequest, format: RenderFormat, output: str) -> list[str]:
    """Return the arguments of the command that makes a file."""
    return (video_arguments if format.film else render_arguments)(request, output)


def command_of(request: PictureRequest) -> str:
    """Return the command of a request, as it is shown before anything is rendered.

    Raises:
        LoadError: There is no such format, or a package for it is missing.
    """
    format: RenderFormat = render_choices.format_named(request.format)
    return shown(arguments_of(request, format, f"{file_stem(request)}.{format.name}"))


def _reason(code: int, said: str) -> str:
    """Return why there is no file."""
    if code < 0:
        return f"the scene's code ended its process (signal {-code})"
    if said:
        return said.removeprefix("error: ")
    return f"the scene's code ended its process (exit status {code})"


def placed(file: Path, folder: Path) -> Path:
    """Copy a file into a folder under a name that is free there; return the new file.

    Raises:
        SaveError: It cannot be written.
    """
    for count in itertools.count(1):
        path = folder / (file.name if count == 1 else f"{file.stem}-{count}{file.suffix}")
        try:
            with replacement(path, new=True) as target, file.open("rb") as source:
                shutil.copyfileobj(source, target)
        except TakenError:  # the name is taken
            continue
        break
    return path


class RenderQueue:
    """Renders of all tabs, one after the other: each uses all processors.

    Args:
        beside: The folder of the scene.
        limits: The limits of time.
    """

    def __init__(self, beside: Path, limits: RenderLimits) -> None:
        self._beside, self._limits = beside, limits
        self._lock = threading.Condition()
        self._jobs: list[RenderJob] = []  # the first one runs
        self._kept: list[tuple[object, ScratchFolder]] = []
        self._thread: threading.Thread | None = None
        self._is_over = False

    def add(self, owner: object, request: RenderRequest, tell: Callable[[Message], None]) -> None:
        """Render what a tab wants, when it is its turn."""
        job = RenderJob(owner, request, self._beside, self._limits, tell)
        with self._lock:
            self._jobs.append(job)
            if len(self._jobs) > 1:
                job.waits()
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, daemon=True)
                self._thread.start()
            self._lock.notify_all()

    def cancel(self, owner: object, number: int | None = None) -> None:
        """End a tab's render, or all that it wants."""
        with self._lock:
            found = [j for j in self._jobs if j.owner is owner and number in (None, j.request.id)]
            waiting = [job for job in found if job is not self._jobs[0]]
            self._jobs = [job for job in self._jobs if job not in waiting]
        for job in found:
            job.cancel()
        for job in waiting:
            job.drop()

    def forget(self, owner: object) -> None:
        """End all that a tab wants, and remove its pictures: it is gone."""
        with self._lock:
            for job in self._jobs:
                job.is_unwanted |= job.owner is owner
        self.cancel(owner)
        with self._lock:
            for place in [place for tab, place in self._kept if tab is owner]:
                place.remove()
            self._kept = [kept for kept in self._kept if kept[0] is not owner]

    def close(self) -> None:
        """End everything."""
        with self._lock:
            self._is_over = True
            owners = {id(job.owner): job.owner for job in self._jobs}
            owners |= {id(tab): tab for tab, _ in self._kept}
            self._lock.notify_all()
        for owner in owners.values():
            self.forget(owner)
        if self._thread is not None:
            self._thread.join(5.0)

    def result(self, folder: str, token: str) -> bytes | None:
        """Return a picture by the parts of its address; None if there is none."""
        with self._lock:
            places = {place.path.name: place.path for _, place in self._kept}
        if folder not in places:
            return None
        with contextlib.suppress(OSError):  # removed in this moment
            files = {file.name: file for file in (places[folder] / "made").iterdir()}
            return files[token].read_bytes() if token in files else None
        return None

    def _work(self) -> None:
        while True:
            with self._lock:
                self._lock.wait_for(lambda: self._jobs or self._is_over)
                if not self._jobs:
                    return
                job = self._jobs[0]
            job.run(partial(self._keep, job))
            with self._lock:
                self._jobs.remove(job)

    def _keep(self, job: RenderJob, place: ScratchFolder) -> None:
        with self._lock:
            if job.is_unwanted:
                place.remove()
                return
            self._kept.append((job.owner, place))
            of_owner = [kept for kept in self._kept if kept[0] is job.owner]
            for kept in of_owner[:-_MOST_KEPT]:
                kept[1].remove()
                self._kept.remove(kept)
