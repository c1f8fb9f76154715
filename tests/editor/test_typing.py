"""What is typed stands in the editor: lines of Python at a person's pace, the keys of the list.

The list of names opens some time after a key. A test that types at a machine's pace never sees
it: here each key has its time, on a clock that the test moves, and for some lines on the real one.
"""

from __future__ import annotations

import re

import pytest

from tests.editor.studio_page import studio

pytest.importorskip("websockets")

LINES = (
    *("import math", "import numpy as np", "from math import sin", "from distal import *"),
    *("from distal import Sphere", "x = 1", "for i in range(3):", "def f(a, b):", "return a"),
    *("print(x)", "class A:", "if a and b:", "else:", "elif x:", "f = lambda x: x"),
    *("with open(p) as f:", "a.b", "s = Sphere(1)", "s.union(b)", "# a comment in", 'word = "for"'),
    *("x += 1", "while True:", "pass", "x in y", "a is b", "not a", "None", "True", "@func"),
    *("from math import (sin, co)", "try:", "except E as e:", "x = 1.", "y = 0xff", "x = [1, 2]"),
    *("box = Box(0.5).translate(1, 0, 0)", "scene = Scene(box, lights=sun)", "ab", "f(size=ab)"),
    *("def sp(bo):", "case = 3", "int", "x = y if z else w", '"""A ball."""', "x: float = in_"),
    *("x = pri", "y = Sphe", "a and no", "x = ma", "s.uni", "from distal import Bo"),
)
WORDS = sorted({word for line in LINES for word in re.findall(r"[a-z_]\w+", line)})
# Each word that is typed is the beginning of a name, and of another one with a capital letter.
BEFORE = "".join(f"{word}_longer = {word.title()}_longer = 0\n" for word in WORDS)
PACES_MS = (60, 120, 180, 260)
PAUSE_MS = 700
TEXT = "() => studio.editor.view.state.doc.toString()"
LIST = ".cm-tooltip-autocomplete li"


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    with studio(tmp_path_factory.mktemp("typing")) as made:
        # Half a line is no scene: the code is not run.
        made.page.evaluate("() => { studio.looking.lookSoon = () => {}; }")
        yield made


@pytest.fixture(scope="module")
def clock(app):
    """The page's clock, which stands from now on."""
    clock = app.page.clock
    clock.install()
    clock.pause_at(app.page.evaluate("() => Date.now()") + 1000)
    return clock


def begin(app, text: str = BEFORE) -> None:
    """A text, with the caret at its end."""
    app.page.evaluate(
        """(text) => {
          const { view } = studio.editor;
          const changes = { from: 0, to: view.state.doc.length, insert: text };
          view.dispatch({ changes, selection: { anchor: text.length } });
          view.focus();
        }""",
        text,
    )


def typed(app) -> str:
    text = app.page.evaluate(TEXT)
    assert text.startswith(BEFORE)
    return text.removeprefix(BEFORE)


@pytest.mark.parametrize("line", ["import math", "def f(a, b):", "x in y", "s = sphere"])
def test_enter_on_the_real_clock(app, line):
    pace = PACES_MS[len(line) % 4]
    begin(app)
    app.page.keyboard.type(line, delay=pace)
    app.page.wait_for_timeout(PAUSE_MS)
    app.page.keyboard.press("Enter")
    assert re.fullmatch(f"{re.escape(line)}\n *", typed(app))


@pytest.mark.sample(8)
@pytest.mark.parametrize("part", [0, 1])
@pytest.mark.parametrize("pace", PACES_MS)
def test_enter_begins_a_line_and_changes_nothing_before_it(app, clock, pace, part):
    wrong, lists = {}, 0
    for line in LINES[part::2]:
        begin(app)
        # A list opens at two letters and stays: the last three of a word have their time.
        for keys in re.findall(r"\w+(?=\w{3})|\w|\W+", line):
            app.page.keyboard.type(keys)
            clock.run_for(pace)
        clock.run_for(PAUSE_MS)
        lists += app.page.locator(LIST).count() > 0
        app.page.keyboard.press("Enter")
        clock.run_for(PAUSE_MS)
        if not re.fullmatch(f"{re.escape(line)}\n *", typed(app)):
            wrong[line] = typed(app)
        assert app.page.locator(LIST).count() == 0
    assert wrong == {}
    assert lists > 4  # else nothing was tested


# Texts with the keys that write them, where these are others.
PAIRS = {
    '"""A ball."""': None,
    '"""A\nball.\n"""\nx': None,
    "'''A ball.'''": None,
    'r"""A ball."""': None,
    'x = "a" + "b"': None,
    'x = ""': None,
    "x = {'a': (1, [2])}": None,
    "# it's 'so' (": None,
    '"it\'s" "a (b"': None,
    "if a:\n    x = 1\nelse:\n    y = 2": "if a:\nx = 1\nelse:\ny = 2",
    "def f():\n    case = 1\n    cases = 2": "def f():\ncase = 1\ncases = 2",
}


@pytest.mark.parametrize("text", PAIRS)
def test_pairs_and_indentation_change_nothing_that_is_typed(app, text):
    begin(app)
    for key in PAIRS[text] or text:
        app.page.keyboard.press("Enter") if key == "\n" else app.page.keyboard.type(key)
    assert typed(app) == text


@pytest.mark.parametrize("after", ["(1)", ".union(b)", ": int = 2", " = 3", ", b", "[0]", " ", ")"])
def test_no_other_key_takes_an_entry(app, clock, after):
    begin(app)
    app.page.keyboard.type("sphe")
    clock.run_for(PAUSE_MS)
    assert app.page.locator(LIST).count() > 0
    for key in after:
        app.page.keyboard.type(key)
        clock.run_for(PAUSE_MS)
    assert typed(app) == f"sphe{after}"


# Text, keys, what stands there then.
KEYS = {
    "an arrow and Enter": ("x = Sphe", ["ArrowDown", "Enter"], "x = Sphere"),
    "two arrows and Enter": ("x = Bo", ["ArrowDown", "ArrowDown", "Enter"], "x = Box"),
    "an arrow and Tab": ("x = Bo", ["ArrowDown", "ArrowDown", "Tab"], "x = Box"),
    "an arrow, a letter and Enter": ("x = Sp", ["ArrowDown", "h", "Enter"], "x = Sph\n"),
    "Tab": ("x = Sphe", ["Tab"], "x = Sphere"),
    "Tab for one letter": ("S", ["Tab"], "    S"),
    "Tab for a word without a list": ("zzz", ["Tab"], "    zzz"),
    "Tab after Backspace": ("Sp", ["Backspace", "Tab"], "    S"),
    "Escape and Enter": ("x = Sphe", ["Escape", "Enter"], "x = Sphe\n"),
    "an arrow, Escape and Enter": ("x = Sphe", ["ArrowDown", "Escape", "Enter"], "x = Sphe\n"),
    "asked for, an arrow and Enter": ("Sphe", ["Control+Space", "ArrowDown", "Enter"], "Sphere"),
    "asked for and Enter": ("x = S", ["Control+Space", "Enter"], "x = S\n"),
    "asked for and Tab": ("S", ["Control+Space", "Tab"], "    S"),
    "a method": ("x.twi", ["Tab"], "x.twist"),
}


@pytest.mark.parametrize("case", KEYS)
def test_keys_of_the_list(app, clock, case):
    text, keys, expected = KEYS[case]
    begin(app)
    app.page.keyboard.type(text)
    clock.run_for(PAUSE_MS)
    for key in keys:
        app.page.keyboard.press(key)
        clock.run_for(PAUSE_MS)
    assert typed(app) == expected
    app.page.keyboard.press("Control+z")
    app.page.keyboard.press("Escape")


@pytest.mark.parametrize("wait", [0, PAUSE_MS], ids=["at once", "with a list"])
def test_escape_and_tab_leave_the_editor(app, clock, wait):
    begin(app)
    app.page.keyboard.type("x = Sphe")
    clock.run_for(wait)
    for _ in range(2 if wait else 1):
        app.page.keyboard.press("Escape")
    app.page.keyboard.press("Tab")
    assert typed(app) == "x = Sphe"
    assert not app.page.evaluate("() => studio.editor.view.hasFocus")


def test_a_click_takes_an_entry(app, clock):
    begin(app)
    app.page.keyboard.type("x = pri")
    clock.run_for(PAUSE_MS)
    app.page.locator(LIST, has_text="Prism").click()
    assert typed(app) == "x = Prism"
