"""The worker that starts before the browser: taken once, with all its lines, or ended in time."""

from __future__ import annotations

import json
import queue
import time

from distal.editor.local.early import EARLY_ID, EarlyWorker
from distal.editor.local.files import SceneFiles
from distal.editor.local.process import WorkerProcess
from distal.editor.local.tab import StudioTab

SCENE = "from distal import Scene, Sphere\nscene = Scene(Sphere(0.5))\n"
WAIT_S = 60.0


class Kept:
    """Starts workers, and keeps them."""

    def __init__(self) -> None:
        self.made: list[WorkerProcess] = []

    def __call__(self, *args) -> WorkerProcess:
        self.made.append(WorkerProcess(*args))
        return self.made[-1]


def files(tmp_path, text=SCENE) -> SceneFiles:
    (tmp_path / "scene.py").write_text(text)
    return SceneFiles(tmp_path / "scene.py")


def look(number: int, text: str = SCENE) -> str:
    request = {"kind": "look", "id": number, "revision": 1, "files": {"scene.py": text}}
    return json.dumps({**request, "main": "scene.py", "guided": False})


def test_the_first_tab_takes_it_and_its_own_request_finds_the_program(tmp_path):
    start = Kept()
    early = EarlyWorker(files(tmp_path), WAIT_S, start)
    told: queue.Queue[dict] = queue.Queue()
    tab = StudioTab(
        files(tmp_path), lambda text: told.put(json.loads(text)), early=early, start=start
    )
    tab.received(look(1))
    try:
        kinds = []
        while "scene" not in kinds:
            message = told.get(timeout=WAIT_S)
            assert message.get("id") != EARLY_ID
            kinds.append(message["kind"])
        assert kinds[0] == "ready"
        assert kinds.count("ready") == 1
        assert len(start.made) == 1
        assert early.taken(told.put, told.put) is None  # only once
    finally:
        tab.end()


def test_a_scene_that_loops_ends_the_tab_s_wait_too(tmp_path):
    text = "while True:\n    pass\n"
    start = Kept()
    early = EarlyWorker(files(tmp_path, text), WAIT_S, start)
    told: queue.Queue[dict] = queue.Queue()
    tab = StudioTab(
        files(tmp_path, text),
        lambda text: told.put(json.loads(text)),
        limit=4.0,
        early=early,
        start=start,
    )
    tab.received(look(1, text))
    try:
        kinds = set()
        # The tab's own request takes the place of the early one where that still waits.
        while "restarted" not in kinds:
            kinds.add(told.get(timeout=WAIT_S)["kind"])
        while "ready" not in kinds or len(start.made) < 2:  # another worker
            kinds.add(told.get(timeout=WAIT_S)["kind"])
    finally:
        tab.end()


def test_one_that_nobody_takes_is_ended(tmp_path):
    early = EarlyWorker(files(tmp_path, "while True:\n    pass\n"), 1.0)
    time.sleep(2.0)
    assert early._process._process.poll() is not None
    assert early.taken(lambda _: None, lambda _: None) is None
