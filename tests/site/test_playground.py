"""The playground in a browser: Python in its cell, links, loops, offline, sealed."""

from __future__ import annotations

import os
import re
import socket
import zipfile

import pytest

from distal.editor.links import link_of
from distal.editor.local.files import SceneFiles
from distal.editor.messages import LookRequest
from distal.editor.worker import StudioWorker
from distal.example_files import all_examples, gallery
from tests.site.served_playground import NAMES, SLOW_MS, context
from tools.site import playground

# They import NumPy.
WITH_NUMPY = frozenset(("beach", "bricks", "forest", "molecule", "ripples", "sdfray_glass"))
# Without NumPy their parts are in no table.
WITH_TABLES = frozenset(("catalogue",))
NO_NUMPY = "NumPy is not in the playground"
# The whole gallery, in `make sweep`.
COMPARED = sorted(gallery()) if os.environ.get("DISTAL_ALL_PICTURES") == "1" else NAMES

pytestmark = pytest.mark.skipif(
    not playground.PYODIDE.exists(), reason="pyodide is not installed: run `npm ci` in web/"
)

_PLAYER = "() => document.querySelector('.picture .host')?.distal"
_IDLE = "() => /\\d ms$/.test(document.querySelector('.work').textContent)"


def shown(made, address: str, *, wakes: bool = True):
    page = made.new_page()
    page.goto(address)
    page.wait_for_function(_PLAYER, timeout=SLOW_MS)
    if wakes:
        page.locator(".cm-content").first.click()
        page.wait_for_function(_IDLE, timeout=SLOW_MS)
    return page


@pytest.fixture(scope="module")
def awake(address):
    """A page whose cell has started Python, which takes five seconds; for several tests."""
    with context(address) as made:
        yield shown(made, address)


def show_again(page, name: str = "planet") -> None:
    """Show an example as a new page does."""
    text = gallery()[name].read_text(encoding="utf-8")
    page.evaluate("([file, text]) => studio.editor.replace(file, text)", [f"{name}.py", text])
    page.evaluate("() => studio.looking.run()")  # also after it was stopped
    page.wait_for_timeout(200)  # typing ends
    page.wait_for_function(_IDLE, timeout=SLOW_MS)


def ask(page, text: str, kind: str = "look", **more):
    """The answer of the worker in the cell to a request about a text."""
    fields = {"kind": kind, "revision": 1, "files": {"scene.py": text}, "main": "scene.py", **more}
    return page.evaluate("(request) => studio.client.ask(request)", fields)


def test_the_first_picture_needs_no_python(address):
    with context(address) as made:
        page = made.new_page()
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(address)
        page.wait_for_function(_PLAYER, timeout=SLOW_MS)
        page.evaluate("() => document.querySelector('.picture .host').distal.settled()")
        page.locator(".knobs input[type=range]").first.press("ArrowRight")
        page.get_by_role("button", name="Gallery").click()
        loaded = "() => document.querySelector('.posters img').naturalWidth === 320"
        page.wait_for_function(loaded, timeout=SLOW_MS)
        page.keyboard.press("Escape")
        assert not [url for url in asked if url.endswith((".wasm", "distal.zip"))]
        # Another view has no program yet: it needs the compiler.
        with page.expect_request("**/distal.zip", timeout=SLOW_MS):
            page.get_by_label("View", exact=True).select_option(index=1)


def test_a_picture_that_keeps_frames_needs_no_python(address):
    with context(address) as made:
        page = made.new_page()
        page.goto(f"{address}#example=coral")
        page.wait_for_function(_PLAYER, timeout=SLOW_MS)
        drawn = """async () => {
          const player = document.querySelector(".picture .host").distal;
          player.pause();
          const sizes = [];
          for (const time of [0, 0.1, 0.2, 0.3]) {
            player.setTime(time);
            await player.settled();
            sizes.push((await player.screenshot(1)).size);
          }
          return sizes;
        }"""
        assert len(set(page.evaluate(drawn))) > 1  # it grows


def test_a_sound_file_needs_what_the_playground_has_not(awake):
    text = all_examples()["spectrum"].read_text(encoding="utf-8")
    answer = ask(awake, text)
    assert answer["kind"] == "mistakes"
    assert NO_NUMPY in answer["mistakes"][0]["message"]


def test_texts_are_those_of_this_python(awake, tmp_path):
    worker = StudioWorker(tmp_path)
    refused, different = set(), set()
    for name in COMPARED:
        opened = SceneFiles(gallery()[name])
        texts = opened.all().files
        request = LookRequest(id=1, revision=1, files=texts, main=opened.main)
        ours = worker.answers(request)[-1].payload["programs"]["data"]
        answer = ask(awake, "", files=texts, main=opened.main)
        if answer["kind"] == "mistakes":
            assert NO_NUMPY in answer["mistakes"][0]["message"], name
            refused.add(name)
            continue
        theirs = answer["payload"]["programs"]["data"]
        if [p["fragment"] for p in theirs] != [p["fragment"] for p in ours]:
            different.add(name)
    assert refused == WITH_NUMPY.intersection(COMPARED)
    assert different == WITH_TABLES.intersection(COMPARED)


def test_archives_have_bytecode_and_the_sources_of_scene_code(folder):
    def names(archive: str) -> set[str]:
        with zipfile.ZipFile(folder / "python" / archive) as found:
            return set(found.namelist())

    stdlib, own = names("python_stdlib.zip"), names("distal.zip")
    assert "dataclasses.pyc" in stdlib and "dataclasses.py" not in stdlib
    for module in ("random", "colorsys", "statistics", "json/__init__"):
        assert stdlib & {f"{module}.py", f"{module}.pyc"}, module
    assert not [name for name in stdlib if name.startswith(("unittest/", "pdb"))]
    assert "distal/frontend/source.pyc" in own and "distal/frontend/source.py" not in own
    assert "distal/render/trace.py" in own
    assert any(name.startswith("distal/render/__pycache__/trace.") for name in own)


def test_typing_mistakes_and_a_dial(awake):
    page = awake
    show_again(page)
    page.locator(".literal", has_text=re.compile(r"^0\.84$")).click()
    page.locator(".dial").get_by_role("button", name="More").click()
    changed = "() => studio.editor.view.state.doc.toString().includes('Sphere(0.85)')"
    page.wait_for_function(changed, timeout=SLOW_MS)
    page.keyboard.press("Escape")
    page.evaluate("() => studio.editor.goTo(24)")
    page.keyboard.press("End")
    page.keyboard.type(" +")
    page.wait_for_function("() => document.querySelector('.mistakes').childElementCount")
    assert "line 24" in page.locator(".mistakes").inner_text()


def test_an_endless_loop_is_ended(awake):
    page = awake
    page.evaluate("() => studio.editor.replace('planet.py', 'while True: pass\\n')")
    page.wait_for_function("() => !document.querySelector('.notice').hidden", timeout=SLOW_MS)
    assert "gave no answer within 5 s" in page.locator(".notice").inner_text()
    show_again(page)


def test_a_link_has_the_code_values_and_camera(address):
    text = (
        "from distal import *\nfrom distal.lang import slider\n"
        'size = slider("Size", 0.5, 0.1, 1.0)\nscene = Scene(Sphere(size))\n'
    )
    with context(address) as made:
        page = shown(made, address)
        page.evaluate("(text) => studio.editor.replace('planet.py', text)", text)
        shows = "() => studio.picture.player.payload.parameters.some(({ name }) => name === 'size')"
        page.wait_for_function(shows, timeout=SLOW_MS)
        page.evaluate("() => studio.picture.player.setSteering({ yaw: 0.5 })")
        page.evaluate("() => studio.picture.player.change('size', 0.75)")
        page.get_by_role("button", name="Share").click()
        page.get_by_label("With the sliders' values").check()
        link = page.locator("dialog input[type=text]").input_value()
        assert link.startswith(f"{address}#c=")
        page.get_by_label("As a frame").check()
        frame = page.locator("dialog input[type=text]").input_value()
        assert f'src="{link.replace("#", "?embed#")}"' in frame
        other = shown(made, link)
        assert other.evaluate("() => studio.editor.view.state.doc.toString()") == text
        moved = "() => studio.picture.player.steering().yaw === 0.5"
        other.wait_for_function(moved, timeout=SLOW_MS)
        assert other.evaluate("() => studio.picture.player.parameters().size") == 0.75


def test_the_drawn_picture_is_saved_and_more_is_explained(address):
    with context(address) as made:
        page = shown(made, address)
        page.get_by_role("button", name="Export").click()
        sheet = page.get_by_role("region", name="Pictures and films")
        with page.expect_download(timeout=SLOW_MS) as found:
            sheet.get_by_role("button", name="PNG of the picture").click()
        assert found.value.path().read_bytes()[:4] == b"\x89PNG"
        assert "pip install 'distal[studio]'" in sheet.inner_text()
        assert not sheet.get_by_label("Format").is_visible()


def test_another_page_has_it_in_a_frame(address, folder):
    code = '<iframe src="playground/?embed#example=raymarcher" width=800 height=460></iframe>'
    (folder.parent / "other.html").write_text(f'<link rel="icon" href="data:,">{code}')
    root = address.removesuffix("playground/")
    with context(root) as made:
        page = made.new_page()
        page.goto(f"{root}other.html")
        page.wait_for_function("() => frames[0]?.studio?.picture?.player", timeout=SLOW_MS)
        frame = page.frames[1]
        assert frame.get_by_role("button", name="Open in the playground").is_visible()
        assert not frame.get_by_role("button", name="Gallery").is_visible()
        with page.expect_popup() as opened:
            frame.get_by_role("button", name="Open in the playground").click()
        opened.value.wait_for_function(_PLAYER, timeout=SLOW_MS)
        text = "() => studio.editor.view.state.doc.toString()"
        assert opened.value.evaluate(text) == gallery()["raymarcher"].read_text()


BROKEN = [
    *("#c=", "#c=AAAA", "#c=!!", "#example=none", "#example=constructor", "#x"),
    link_of({"files": {}, "main": "toString"}),
    link_of({"files": {"../a.py": ""}, "main": "../a.py"}),
    link_of({"files": {"a.py": "#" * 50_000_000}, "main": "a.py"}),
]


@pytest.fixture(scope="module")
def visited(address):
    """A page for one link after another, whose context keeps what they share."""
    with context(address) as made:
        yield made.new_page()


@pytest.mark.parametrize("fragment", BROKEN, ids=range(len(BROKEN)))
def test_a_broken_link_shows_the_start(address, visited, fragment):
    visited.goto("about:blank")  # a change of the fragment alone would load nothing
    visited.goto(address + fragment)
    visited.wait_for_function(_PLAYER, timeout=SLOW_MS)
    text = visited.evaluate("() => studio.editor.view.state.doc.toString()")
    assert "A planet cut open" in text
    assert (
        visited.evaluate("() => studio.scenes.shelf.all()") == []
    )  # which the next page would show


def test_a_scene_outlives_a_reload_and_it_works_offline(address):
    with context(address) as made:
        page = shown(made, address)
        page.evaluate("() => navigator.serviceWorker.ready.then(() => 1)")
        page.evaluate("() => studio.editor.goTo(6)")
        page.keyboard.type("# mine\n")
        page.wait_for_timeout(500)
        page.wait_for_function(_IDLE, timeout=SLOW_MS)
        made.set_offline(True)
        page.reload()
        page.wait_for_function(_PLAYER, timeout=SLOW_MS)
        page.wait_for_function(_IDLE, timeout=SLOW_MS)
        assert "# mine" in page.evaluate("() => studio.editor.view.state.doc.toString()")
        made.set_offline(False)


ATTEMPTS = """
found = []
def attempt(name, act):
    try:
        act()
    except BaseException as error:
        found.append(f"{name}: {type(error).__name__}")
    else:
        found.append(f"{name}: DONE")

def import_js():
    import js
    js.fetch
def post_parent():
    import js
    js.parent.postMessage("x", "*")
def storage():
    import js
    js.localStorage.setItem("a", "b")
def evaluate():
    from pyodide.code import run_js
    run_js("1 + 1")
def request():
    import urllib.request
    urllib.request.urlopen("https://example.com/", timeout=2)
def fetch():
    from pyodide.http import pyfetch
    pyfetch("https://example.com/").send(None)

for act in (import_js, post_parent, storage, evaluate, request, fetch):
    attempt(act.__name__, act)
try:  # what is sent goes nowhere; whether that is an error is the interpreter's affair
    import socket
    socket.create_connection(("127.0.0.1", PORT), timeout=2).send(b"hello")
except OSError:
    pass
print(found)
from distal import *
scene = Scene(Sphere(0.5))
"""


def test_the_cell_is_sealed(awake):
    page = awake
    page.evaluate(
        "() => { window.heard = []; addEventListener('message', (e) => heard.push(e.data)); }"
    )
    page.evaluate("() => { studio.client.events.printed = ({ text }) => { studio.told = text; }; }")
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(1.0)
        ask(page, ATTEMPTS.replace("PORT", str(listening.getsockname()[1])))
        with pytest.raises(TimeoutError):
            listening.accept()
    told = page.evaluate("() => studio.told")
    assert told.count(":") == 6, told
    assert "DONE" not in told, told
    assert page.evaluate("() => heard") == []
    assert page.evaluate("() => localStorage.getItem('a')") is None


MADE_UP = """
import __main__, json
def post(**message): __main__.post(json.dumps(message))
for number in (-7, 10**9):
    post(kind="answer", id=number, revision=1, request="command", result={"command": "x"})
    post(kind="dropped", id=number, revision=1)
from distal import *
scene = Scene(Sphere(0.5))
"""
STOLEN = """
import __main__
__main__.post('{"kind":"changed","files":{"planet.py":"stolen"},"digests":{}}')
"""
FLOOD = """
import __main__
while True:
    __main__.post('{"kind":"progress","id":1,"revision":1,"done":0,"label":"","text":""}')
"""


def test_what_the_code_in_the_cell_makes_up_is_left_out(awake):
    page = awake
    show_again(page)
    assert ask(page, MADE_UP)["kind"] == "scene"
    assert page.locator(".notice").inner_text() == ""


def test_what_no_worker_sends_ends_the_worker(awake):
    page = awake
    show_again(page)
    before = page.evaluate("() => studio.editor.view.state.doc.toString()")
    assert ask(page, STOLEN) is None
    assert "sent a broken answer (kind)" in page.locator(".notice").inner_text()
    assert page.evaluate("() => studio.editor.view.state.doc.toString()") == before
    show_again(page)


def test_a_flood_of_messages_ends_the_worker(awake):
    page = awake
    assert ask(page, FLOOD) is None
    notice = "() => document.querySelector('.notice').textContent.includes('too many messages')"
    page.wait_for_function(notice, timeout=SLOW_MS)
    show_again(page)


def test_an_answer_of_no_form_leaves_the_app_alive(awake):
    page = awake
    show_again(page)
    # The app's own next request, answered by a scene without a payload.
    page.evaluate(
        "() => { const { channel } = studio; const old = channel.post; channel.post = (asked) => {"
        " channel.post = old; setTimeout(() => channel.onMessage("
        "{ kind: 'scene', id: asked.id, objects: [] })); }; studio.looking.look(); }"
    )
    told = "() => document.querySelector('.notice').textContent.includes('a broken answer')"
    page.wait_for_function(told, timeout=SLOW_MS)
    show_again(page)
