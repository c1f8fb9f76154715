"""Answers that a stranger's code makes up end no drawing in the playground.

The cell of these tests is no Python: it answers with the texts that a test gives it, in place of
the worker's. Each message of a worker, with a field that is missing, of another type, huge or
nested, is sent as the answer to a request; then the worker's own answer must be drawn.
"""

from __future__ import annotations

import copy
import functools
import http.server
import json
import random
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from distal.editor import messages
from distal.editor.messages import encoded
from distal.editor.worker import StudioWorker
from distal.example_files import all_examples, gallery
from tests.browser import BrowserUnavailableError, browser
from tests.kept_page import is_of_the_driver
from tests.selection import all_cases
from tools.site import playground

SLOW_MS = 120_000
ID, REVISION = -12345, -12346
TEXT = """from distal import *
from distal.lang import color, point, slider

size = slider("Size", 0.5, 0.1, 1.0)
tint = color("Tint", "#d97757")
place = point("Place", (0.0, 0.0, 0.0))
ball = Sphere(size).translate(0.25, 0, 0)
scene = Scene(ball | Box(0.3).translate(place).paint(tint), background="BACKGROUND")
"""
RED, BLUE = "#ff0000", "#0000ff"

CELL = """<!doctype html><meta charset="utf-8"><script>
let port, queue = [];
const tell = (text) => port.postMessage(text);
onmessage = ({ data, ports }) => {
  if (data.queue) return (queue = data.queue), parent.postMessage("queued", "*");
  [port] = ports;
  port.onmessage = ({ data }) => {
    if (data === "restart") return tell(READY);
    const { id, revision } = JSON.parse(data);
    for (const text of queue.shift() ?? ['{"kind":"dropped","id":@ID,"revision":@REVISION}']) {
      tell(text.replaceAll("@ID", id).replaceAll("@REVISION", revision));
    }
  };
  tell(READY);
};
</script>"""

# The answers to the next requests; resolves when they are shown, or refused.
PLAY = """async (queue) => {
  const end = performance.now() + 20_000;
  const until = async (isDone) => {
    while (!isDone()) {
      if (performance.now() > end) throw new Error(`never: ${isDone}`);
      await new Promise((resolve) => setTimeout(resolve));
    }
  };
  const queued = new Promise((resolve) => addEventListener("message", resolve, { once: true }));
  document.querySelector("iframe").contentWindow.postMessage({ queue }, "*");
  await queued;
  await until(() => studio.looking.ready);
  studio.looking.isStopped = false;
  studio.looking.look();
  await until(() => studio.looking.isFree);
}"""
# The color of the first pixel, which is the background's.
COLOR = """async () => {
  const { player } = studio.picture;
  player.pause();
  if (!(await player.settled())) return "none";
  const image = await createImageBitmap(await player.screenshot(1));
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  const [r, g, b] = context.getImageData(0, 0, 1, 1).data;
  return `${r > 128 ? "red" : ""}${b > 128 ? "blue" : ""}`;
}"""
NOTICE = "() => document.querySelector('.notice').textContent"


def wire(message: messages.Message) -> str:
    """A message as the cell has it, with names for the numbers of the request."""
    return encoded(message).replace(str(ID), "@ID").replace(str(REVISION), "@REVISION")


@pytest.fixture(scope="module")
def worker(tmp_path_factory) -> StudioWorker:
    return StudioWorker(tmp_path_factory.mktemp("worker"))


def answers(worker: StudioWorker, kind: str, text: str, **more: Any) -> messages.Message:
    made = messages.parsed(
        json.dumps(
            {
                **dict(kind=kind, id=ID, revision=REVISION, main="scene.py", **more),
                "files": {"scene.py": text},
            }
        )
    )
    return worker.answers(made)[-1]


@pytest.fixture(scope="module")
def samples(worker) -> dict[str, dict[str, Any]]:
    """A message of each kind that a worker answers a look with."""
    red = TEXT.replace("BACKGROUND", RED)
    scene = answers(worker, "look", red, guided=False)
    assert isinstance(scene, messages.SceneFound)
    numbers = answers(
        worker, "look", red.replace("0.25", "0.26"), known=scene.key, lean=True, guided=False
    )
    assert isinstance(numbers, messages.NumbersFound)
    mistakes = answers(worker, "look", red + "x = (\n")
    printed = messages.Printed(id=ID, revision=REVISION, text="x")
    progress = messages.Progress(id=ID, revision=REVISION, done=0.5)
    ready = worker.ready()
    made = (scene, numbers, mistakes, printed, progress, ready)
    return {message.kind: json.loads(encoded(message)) for message in made}


@pytest.fixture(scope="module")
def page(tmp_path_factory, worker):
    folder = tmp_path_factory.mktemp("crafted")
    (folder / "python").mkdir()
    (folder / "gallery").mkdir()
    for name in ("studio.js", "studio.css"):
        (folder / name).write_bytes((playground.APP / name).read_bytes())
    for name in (*playground.PYTHON, "distal.zip"):
        (folder / "python" / name).write_bytes(b"")
    cell = folder / "python" / "cell.html"
    ready = json.dumps(encoded(worker.ready()))
    cell.write_text(CELL.replace("READY", ready), encoding="utf-8")
    opened = {"main": "scene.py", "files": {"scene.py": TEXT.replace("BACKGROUND", RED)}}
    start = folder / "gallery" / f"{playground.START}.json"
    start.write_text(json.dumps(opened), encoding="utf-8")
    text = playground._page(folder)
    digests = [playground._digest_of_script(path) for path in (playground.APP / cell.name, cell)]
    (folder / "index.html").write_text(text.replace(*digests), encoding="utf-8")
    yield from shown(folder)


def shown(folder: Path) -> Iterator[Any]:
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Say nothing."""

    handler = functools.partial(Quiet, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/"
    try:
        view = {"width": 400, "height": 300}
        made = browser().new_context(
            reduced_motion="reduce", viewport=view, service_workers="block"
        )
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    thrown: list[str] = []
    made.on("weberror", lambda error: thrown.append(str(error.error)))
    page = made.new_page()
    page.on(
        "console",
        lambda said: (
            said.type == "error"
            and not is_of_the_driver(f"error: {said.text}")
            and thrown.append(said.text)
        ),
    )
    page.set_default_timeout(SLOW_MS)
    page.goto(address)
    page.wait_for_function("() => window.studio?.picture")
    page.evaluate("() => studio.channel.start()")
    page.wait_for_function("() => studio.looking.ready")
    # Only what a test asks for.
    page.evaluate("() => { studio.looking.guide = async () => {}; }")
    yield page
    made.close()
    server.shutdown()
    server.server_close()
    assert [text for text in thrown if "Service Worker" not in text] == []


HUGE = "x" * 100_000
DEEP: Any = functools.reduce(lambda inner, _: [inner], range(500), 0)
VALUES: tuple[Any, ...] = (
    *(None, True, -1, 0, 1.5, 1e308, "", "x", "__proto__", "constructor", HUGE),
    *([], {}, [None], [[]], DEEP, {"__proto__": 1}, {"a": {"b": {}}}, [-1, -1], [1e9, 1e9]),
)
INFINITE = 1.2345e300  # becomes 1e999, which JSON reads as infinite


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where a value has other values; of a list the first and the last."""
    keys: list[Any] = []
    if isinstance(value, dict):
        keys = list(value)
    elif isinstance(value, list):
        keys = sorted({0, len(value) - 1} & set(range(len(value))))
    for key in keys:
        yield (*path, key)
        yield from places(value[key], (*path, key))


def mutated(message: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Each change of one place of a message, with its name, as the text that the cell sends."""
    for path in places(message):
        # Another number is no answer to the request: it is left out, as it was asked before.
        values = [v for v in VALUES if path[-1] not in ("id", "revision") or type(v) is not int]
        for value in [..., INFINITE, *values]:
            made = copy.deepcopy(message)
            inner = functools.reduce(lambda one, key: one[key], path[:-1], made)
            if value is ...:
                del inner[path[-1]]
            else:
                inner[path[-1]] = value
            text = json.dumps(made).replace(str(INFINITE), "1e999")
            name = (
                f"{'.'.join(map(str, path))} = {json.dumps(value)[:40] if value is not ... else ''}"
            )
            yield name, text.replace(str(ID), "@ID").replace(str(REVISION), "@REVISION")


COUNT, MOST = 16, 1000  # in `make test` and in `make sweep`


@pytest.mark.parametrize("kind", ["scene", "numbers", "mistakes", "printed", "progress", "ready"])
def test_after_a_crafted_answer_the_next_one_is_drawn(page, worker, samples, kind):
    red, blue = (
        wire(answers(worker, "look", TEXT.replace("BACKGROUND", color), guided=False))
        for color in (RED, BLUE)
    )
    dropped = wire(messages.Dropped(id=ID, revision=REVISION))
    cases = list(mutated(samples[kind]))
    cases = random.Random(kind).sample(cases, min(MOST if all_cases() else COUNT, len(cases)))
    page.evaluate(PLAY, [[red]])
    assert page.evaluate(COLOR) == "red"
    color = "red"
    for number, (name, text) in enumerate(cases):
        page.evaluate(PLAY, [[text, dropped]])
        if "broken answer" in page.evaluate(NOTICE):
            if number % 8:
                continue  # what is refused reaches nothing that draws
            assert page.evaluate(COLOR) == color, name  # the last picture stays
        color, good = ("blue", blue) if color == "red" else ("red", red)
        page.evaluate(PLAY, [[good]])
        assert page.evaluate(COLOR) == color, name


def test_crafted_texts_that_are_no_messages_end_the_worker(page, worker):
    red = wire(answers(worker, "look", TEXT.replace("BACKGROUND", RED), guided=False))
    before = page.evaluate("() => studio.editor.view.state.doc.toString()")
    texts = ["{", "null", "[1]", '"x"', "{}", '{"kind":"__proto__"}', '{"kind":["scene"]}']
    texts += ["[" * 100_000, '{"kind":"changed","files":{"scene.py":"stolen"},"digests":{}}']
    texts += ['{"kind":"restarted","id":null,"reason":"made up"}', wire(worker.ready())]
    for text in texts:
        page.evaluate(PLAY, [[text]])
        said = page.evaluate(NOTICE)
        assert said.startswith("Stopped: the scene's code sent a broken answer ("), (text, said)
        page.evaluate(PLAY, [[red]])
        assert page.evaluate(COLOR) == "red"
        assert page.evaluate(NOTICE) == ""
    assert page.evaluate("() => studio.editor.view.state.doc.toString()") == before


CRAFTED = {
    "many parameters": ("parameters", lambda p: p * 10_000, "parameters"),
    "many views": ("views", lambda v: v * 20_000, "scene.payload.views"),
    "a negative size": ("size", lambda _: [-4, 3], "scene.payload.size"),
    "no side": ("size", lambda _: [0, 3], "scene.payload.size"),
    "a program that is not there": (
        "views",
        lambda v: [{**v[0], "program": 99}],
        "scene.payload.views",
    ),
    "packed programs": (
        "programs",
        lambda _: {"encoding": "deflate-raw", "data": ""},
        "scene.payload.programs",
    ),
    "a texture without data": (
        "resources",
        lambda _: {
            "a": dict(type="Texture2D", size=[9999, 9999], components=4, format="rgba8", data="")
        },
        "scene.payload.resources.a",
    ),
    "a parameter of no range": (
        "parameters",
        lambda p: [{**p[0], "low": 1.0, "high": 0.0}],
        "parameters[0]",
    ),
    "a parameter named like a prototype": (
        "parameters",
        lambda p: [{**p[0], "name": "__proto__"}],
        "parameters[0]",
    ),
}


@pytest.mark.parametrize("case", CRAFTED)
def test_a_payload_that_no_player_can_show_is_named(page, worker, samples, case):
    field, change, expected = CRAFTED[case]
    red = wire(answers(worker, "look", TEXT.replace("BACKGROUND", RED), guided=False))
    made = copy.deepcopy(samples["scene"])
    made["payload"][field] = change(made["payload"][field])
    text = json.dumps(made).replace(str(ID), "@ID").replace(str(REVISION), "@REVISION")
    page.evaluate(PLAY, [[red]])
    page.evaluate(PLAY, [[text]])
    assert f"broken answer ({expected})" in page.evaluate(NOTICE)
    assert page.evaluate(COLOR) == "red"


def test_a_shader_that_the_driver_refuses_is_told_and_the_next_is_drawn(page, worker, samples):
    blue = wire(answers(worker, "look", TEXT.replace("BACKGROUND", BLUE), guided=False))
    made = copy.deepcopy(samples["scene"])
    for program in made["payload"]["programs"]["data"]:
        program["fragment"] = "nonsense"
    text = json.dumps(made).replace(str(ID), "@ID").replace(str(REVISION), "@REVISION")
    page.evaluate(PLAY, [[text]])
    assert page.evaluate(COLOR) == "none"
    page.evaluate(PLAY, [[blue]])
    assert page.evaluate(COLOR) == "blue"


NAMES = sorted(gallery()) if all_cases() else ["melting", "coral", "planet", "raymarcher", "lamps"]


def test_what_workers_send_is_never_refused(page, worker):
    """Of the whole gallery in ``make sweep``."""
    for name in NAMES:
        text = all_examples()[name].read_text(encoding="utf-8")
        for kind, more in (("look", {}), ("map", {}), ("count", {}), ("text", {}), ("check", {})):
            page.evaluate(PLAY, [[wire(answers(worker, kind, text, **more))]])
            assert "broken answer" not in page.evaluate(NOTICE), (name, kind)
