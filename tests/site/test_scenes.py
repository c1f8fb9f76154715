"""The scenes of the playground: nothing that a person typed is lost, and nothing overwrites it.

The pages here never get Python's files nor a canvas to draw on: texts and storage need neither.
"""

from __future__ import annotations

import contextlib
import io
import re
import zipfile
from collections.abc import Iterator

import pytest
from playwright.sync_api import Error

from distal.editor.links import link_of
from distal.example_files import gallery
from tests.accessibility import needs_axe, violations
from tests.site.served_playground import context
from tools.site import playground

pytestmark = pytest.mark.skipif(
    not playground.PYODIDE.exists(), reason="pyodide is not installed: run `npm ci` in web/"
)

PACES_MS = (60, 180, 120, 40, 260)
QUICK = """
  const ask = window.fetch;
  window.fetch = (url, ...more) => (
    String(url).startsWith("python/") ? new Promise(() => {}) : ask(url, ...more)
  );
  HTMLCanvasElement.prototype.getContext = () => null;
"""
BLOCKED = "indexedDB.open = () => { throw new DOMException('no', 'SecurityError'); };"
FULL = """
  window.isFull = true;
  const put = IDBObjectStore.prototype.put;
  IDBObjectStore.prototype.put = function (...given) {
    if (window.isFull) throw new DOMException("full", "QuotaExceededError");
    return put.apply(this, given);
  };
"""
LINK = link_of({"files": {"ball.py": '"""A red ball."""\nscene = 1\n'}, "main": "ball.py"})
TEXT = "() => studio.editor.view.state.doc.toString()"
ALL = "() => studio.scenes.shelf.all()"


@contextlib.contextmanager
def visits(address: str, script: str = "", **options) -> Iterator:
    with context(address, **options) as made:
        made.add_init_script(QUICK + script)
        yield made


def visit(made, address: str):
    """A page whose texts are there."""
    page = made.new_page()
    page.goto(address)
    page.wait_for_function("() => window.studio?.scenes.id && studio.editor.name")
    return page


def type_like_a_person(page, text: str) -> None:
    page.locator(".cm-content").first.focus()
    for number, key in enumerate(text):
        page.keyboard.type(key)
        page.wait_for_timeout(PACES_MS[number % len(PACES_MS)])


def kept(page) -> None:
    """Wait until what is typed is stored."""
    page.wait_for_function(
        "() => studio.scenes.record.files[studio.settings.main] === "
        "studio.editor.view.state.doc.toString() && studio.scenes.isKept"
    )


def edited(page, text: str) -> None:
    """Type at the start of the text, at once, and wait until it is stored."""
    page.locator(".cm-content").first.focus()
    page.keyboard.press("Control+Home")
    page.keyboard.type(text)
    kept(page)


def texts(page) -> dict[str, str]:
    """The main texts of all scenes, by name."""
    return {one["name"]: one["files"][one["main"]] for one in page.evaluate(ALL)}


def versions(page) -> list[tuple[str, str]]:
    found = page.evaluate("() => studio.scenes.store.versions(studio.scenes.id)")
    return [(one["why"], one["files"][one["main"]]) for one in found]


def bar(page, name: str):
    return page.locator(f"[data-key={name}]")


def test_the_tab_is_closed_half_a_second_after_the_last_key(address):
    with visits(address) as made:
        page = visit(made, address)
        assert page.evaluate(ALL) == []  # who only looks leaves nothing
        assert page.title() == "planet · distal"
        type_like_a_person(page, "# mine")
        page.wait_for_timeout(500)
        assert re.search(r"#scene=[0-9a-f-]{36}$", page.url)
        page.close()
        page = visit(made, address)
        assert page.evaluate(TEXT).startswith('# mine"""A planet')
        assert page.title() == "planet · distal"
        assert list(texts(page)) == ["planet"]


def test_a_tab_that_crashes_had_stored_what_is_older_than_300_ms(address):
    with visits(address) as made:
        page = visit(made, address)
        type_like_a_person(page, "# a")
        page.keyboard.type("b")
        page.wait_for_timeout(300)
        with page.expect_event("crash"), contextlib.suppress(Error):
            page.goto("chrome://crash")  # neither `unload` nor `pagehide` comes
        assert visit(made, address).evaluate(TEXT).startswith("# ab")


def test_a_text_that_the_database_did_not_take_in_time_is_merged(address):
    with visits(address) as made:
        page = visit(made, address)
        edited(page, "# one\n")
        page.evaluate(
            "() => { IDBObjectStore.prototype.put = () => { throw new Error('late'); }; }"
        )
        page.keyboard.type("# two\n")
        page.on("dialog", lambda dialog: dialog.accept())  # it asks, if it has seen that already
        page.goto("about:blank")
        page.close()
        page = visit(made, address)
        assert page.evaluate(TEXT).startswith("# one\n# two\n")
        assert (
            page.evaluate("() => Object.keys(localStorage).filter((k) => k.includes('last'))") == []
        )
        assert versions(page)[-1] == ("opened", gallery_text("planet"))


def gallery_text(name: str) -> str:
    return gallery()[name].read_text(encoding="utf-8")


def test_a_strangers_link_overwrites_nothing(address):
    with visits(address) as made:
        mine = visit(made, address)
        edited(mine, "# mine\n")
        other = visit(made, address + LINK)
        assert other.title() == "A red ball · distal"
        assert list(texts(other)) == ["planet"]
        edited(other, "# theirs\n")
        mine.keyboard.type("# more\n")
        kept(mine)
        assert sorted(texts(mine)) == ["A red ball", "planet"]
        assert texts(mine)["planet"].startswith("# mine\n# more\n")
        other.close()
        # The same link again: the scene is there, and so is the original.
        other = visit(made, address + LINK)
        assert not other.evaluate(TEXT).startswith("# theirs")
        assert (
            bar(other, "earlier")
            .inner_text()
            .startswith("You changed this today: it is your scene “A red ball”.")
        )
        other.get_by_role("button", name="Go on with the original").click()
        edited(other, "# again\n")
        assert sorted(texts(other)) == ["A red ball", "A red ball 2", "planet"]
        other.goto("about:blank")
        other.goto(address + LINK)
        bar(other, "earlier").get_by_role("button", name="Open it").click()
        other.wait_for_function(f"() => ({TEXT})().startsWith('# again')")
        # In the address line of a tab, a link is a change of the fragment alone.
        mine.evaluate("(link) => { location.hash = link; }", LINK)
        mine.wait_for_function("() => document.title === 'A red ball · distal'")
        mine.go_back()
        mine.wait_for_function("() => document.title === 'planet · distal'")


def test_an_example_is_a_scene_of_its_own_with_its_own_history(address):
    with visits(address) as made:
        page = visit(made, address)
        edited(page, "# mine ")
        page.get_by_role("button", name="Gallery").click()
        page.locator(".posters button", has_text="melting").click()
        page.wait_for_function("() => document.title === 'melting · distal'")
        assert page.evaluate(TEXT) == gallery_text("melting")
        assert page.url.endswith("#example=melting")
        edited(page, "# warm ")
        page.keyboard.press("Control+z")
        page.wait_for_function(f"() => !({TEXT})().includes('# warm')")
        page.keyboard.press("Control+z")  # there is nothing before
        assert page.evaluate(TEXT) == gallery_text("melting")
        page.go_back()
        page.wait_for_function("() => document.title === 'planet · distal'")
        assert page.evaluate(TEXT).startswith("# mine ")
        page.locator(".cm-content").first.focus()
        page.keyboard.press("Control+z")
        page.wait_for_function(f"() => !({TEXT})().includes('# mine')")


def test_a_second_tab_reads_copies_or_takes_over(address):
    with visits(address) as made:
        first = visit(made, address)
        edited(first, "# one\n")
        second = visit(made, first.url)
        assert "is open in another tab" in bar(second, "reader").inner_text()
        second.locator(".cm-content").first.focus()
        second.keyboard.type("lost?")
        second.evaluate(
            "() => studio.editor.apply([{ file: 'planet.py', start: 0, end: 0, text: 'x' }])"
        )
        assert second.evaluate(TEXT) == first.evaluate(TEXT)
        first.bring_to_front()
        first.keyboard.type("# live\n")
        second.wait_for_function(f"() => ({TEXT})().includes('# live')")
        # What is typed right before is kept first.
        first.keyboard.type("# last\n")
        second.get_by_role("button", name="Edit it here").click()
        second.wait_for_function("() => !studio.editor.isReadOnly")
        assert second.evaluate(TEXT).startswith("# one\n# live\n# last\n")
        first.wait_for_function("() => studio.editor.isReadOnly")
        assert "Another tab edits “planet” now" in bar(first, "reader").inner_text()
        edited(second, "# two\n")
        first.wait_for_function(f"() => ({TEXT})().includes('# two')")
        # A scene that is deleted elsewhere is said, and the next change brings it back.
        first.evaluate("() => studio.scenes.remove(studio.scenes.id)")
        assert "was deleted in another tab" in bar(second, "deleted").inner_text()
        edited(second, "# three\n")
        assert texts(second)["planet"].startswith("# three\n# two\n")
        bar(second, "deleted").wait_for(state="detached")
        first.evaluate("(hash) => studio.opening.goTo(hash)", second.url[second.url.index("#") :])
        first.get_by_role("button", name="Edit a copy").click()
        first.wait_for_function("() => document.title === 'planet 2 · distal'")
        edited(first, "# copy\n")
        assert texts(second)["planet"].startswith("# three\n# two\n")
        assert texts(second)["planet 2"].startswith("# copy\n# three\n")


def test_a_frozen_tab_loses_the_scene_but_not_its_text(address):
    with visits(address) as made:
        first = visit(made, address)
        edited(first, "# one\n")
        second = visit(made, first.url)
        # It hears nothing, and writes nothing any more.
        first.evaluate(
            "() => { const { scenes } = studio; scenes.turns.locks.onNews = () => {};"
            " scenes.writeNow = scenes.write = async () => {}; }"
        )
        first.bring_to_front()
        first.keyboard.type("# unheard\n")
        second.bring_to_front()
        second.get_by_role("button", name="Edit it here").click()
        second.wait_for_function("() => !studio.editor.isReadOnly")
        first.wait_for_function("() => studio.editor.isReadOnly")
        edited(second, "# two\n")
        second.wait_for_function(
            "async () => (await studio.scenes.store.versions(studio.scenes.id))"
            ".some(({ files }) => files['planet.py'].startsWith('# one\\n# unheard\\n'))"
        )
        assert texts(second)["planet"].startswith("# two\n# one\n")


def test_a_reader_edits_once_the_other_tab_is_closed(address):
    with visits(address) as made:
        first = visit(made, address)
        edited(first, "# one\n")
        second = visit(made, first.url)
        assert bar(second, "reader").is_visible()
        first.close()
        second.wait_for_function("() => !studio.editor.isReadOnly")
        assert not bar(second, "reader").is_visible()


def test_without_storage_the_text_stays_while_the_page_is_open(address):
    with visits(address, BLOCKED) as made:
        page = visit(made, address)
        assert not bar(page, "storage").is_visible()  # nothing to lose yet
        edited(page, "# mine\n")
        said = bar(page, "storage").inner_text()
        assert "stores nothing" in said and "blocked" in said
        with page.expect_download() as found:
            bar(page, "storage").get_by_role("button", name="Save a copy").click()
        assert found.value.suggested_filename == "planet.py"
        assert found.value.path().read_text().startswith("# mine\n")
        page.evaluate("() => studio.opening.open('melting')")
        page.wait_for_function("() => document.title === 'melting · distal'")
        page.get_by_role("button", name="Scenes").click()
        page.get_by_role("button", name="Open “planet”").click()
        page.wait_for_function(f"() => ({TEXT})().startsWith('# mine')")
        asked: list[str] = []
        page.on("dialog", lambda dialog: (asked.append(dialog.type), dialog.accept()))
        page.close(run_before_unload=True)
        visit(made, address)
        assert asked == ["beforeunload"]


def test_a_full_storage_is_said_and_tried_again(address):
    with visits(address, FULL) as made:
        page = visit(made, address)
        edited(page, "# one\n")
        assert "storage is full" in bar(page, "storage").inner_text()
        # What the page left elsewhere comes into the database once that takes it.
        page.on("dialog", lambda dialog: dialog.accept())
        page.goto("about:blank")
        page = visit(made, address)
        assert page.evaluate(TEXT).startswith("# one\n")
        page.locator(".cm-content").first.focus()
        page.keyboard.press("Control+Home")
        page.evaluate("() => { window.isFull = false; }")
        page.keyboard.type("# two\n")
        bar(page, "storage").wait_for(state="detached")
        assert page.evaluate("() => studio.scenes.store.isMissing") is False
        page.close()
        assert visit(made, address).evaluate(TEXT).startswith("# two\n# one\n")


def test_a_text_that_was_refused_survives_the_next_write_of_something_else(address):
    with visits(address, FULL) as made:
        page = visit(made, address)
        page.evaluate("() => { window.isFull = false; }")
        edited(page, "# zero\n")
        page.wait_for_timeout(1300)  # it rests
        page.evaluate("() => { window.isFull = true; }")
        edited(page, "# one\n")
        page.wait_for_timeout(1300)
        assert page.evaluate("() => studio.scenes.store.isMissing")
        page.evaluate("() => { window.isFull = false; }")
        page.evaluate("() => studio.scenes.rename(studio.scenes.id, 'other')")
        assert page.evaluate("() => studio.scenes.store.isMissing") is False
        page.close()
        page = visit(made, address)
        ((name, text),) = texts(page).items()
        assert (name, text.startswith("# one\n# zero\n")) == ("other", True)
        assert any(text.startswith("# one\n") for _, text in versions(page))
        # Of several scenes that are refused each one is left for the next page.
        edited(page, "# two\n")
        page.evaluate("() => studio.opening.goTo('#new')")
        page.wait_for_function("() => !studio.scenes.isKept")
        edited(page, "# three\n")
        page.on("dialog", lambda dialog: dialog.accept())
        page.goto("about:blank")
        page = visit(made, address)
        first, second = sorted(text.split("\n")[0] for text in texts(page).values())
        assert (first, second) == ("# three", "# two")


def test_drafts_of_earlier_versions_become_scenes_once(address):
    with visits(address) as made:
        page = visit(made, address)
        page.evaluate(
            "() => Object.assign(localStorage, { 'distal:x/bad.py': '{', 'distal:colors': 'x',"
            ' \'distal:playground/planet.py\': \'{"text":"# old","digest":"#c=x"}\' })'
        )
        for _ in range(2):
            page.reload()
            page.wait_for_function("() => window.studio?.scenes.id && studio.editor.name")
            assert texts(page) == {"old draft planet": "# old"}
        assert page.evaluate("() => 'distal:playground/planet.py' in localStorage")


def test_a_frame_stores_nothing(address):
    with visits(address) as made:
        page = visit(made, f"{address}?embed#example=melting")
        page.locator(".cm-content").first.focus()
        page.keyboard.type("# framed\n")
        page.wait_for_timeout(600)
        assert page.url.endswith("?embed#example=melting")
        assert page.evaluate("() => indexedDB.databases().then((all) => all.length)") == 0
        assert page.evaluate("() => Object.keys(localStorage)") == []


def test_the_sheet_of_scenes(address):
    with visits(address, accept_downloads=True) as made:
        page = visit(made, address)
        edited(page, "# mine\n")
        page.get_by_role("button", name="Scenes").click()
        sheet = page.get_by_role("dialog", name="Your scenes")

        def choose(name: str, action: str) -> None:
            sheet.get_by_label(f"More for “{name}”").click()
            sheet.get_by_role("button", name=action, exact=True).click()

        def names() -> list[str]:
            page.wait_for_timeout(150)
            return sheet.locator(".scenes strong").all_inner_texts()

        choose("planet", "Duplicate")
        assert names() == ["planet 2", "planet"]
        choose("planet", "Rename")
        page.keyboard.type("Größe: a/b")
        page.keyboard.press("Enter")
        assert names() == ["planet 2", "Größe: a/b"]
        # Escape closes the menu alone.
        page.keyboard.press("Enter")
        assert sheet.locator(".menu[open]").count() == 1
        page.keyboard.press("Escape")
        assert sheet.locator(".menu[open]").count() == 0
        assert sheet.is_visible()
        assert page.title() == "Größe: a/b · distal"
        choose("planet 2", "Delete")
        assert names() == ["Größe: a/b"]
        page.keyboard.press("Enter")  # the focus is at Undo
        assert names() == ["planet 2", "Größe: a/b"]
        # All of them are saved, and come back where they are not.
        with page.expect_download() as found:
            sheet.get_by_role("button", name="Save all (.zip)").click()
        archive = found.value.path().read_bytes()
        inside = zipfile.ZipFile(io.BytesIO(archive)).namelist()
        assert "Größe-a-b/planet.py" in inside and "planet-2/scene.json" in inside
        choose("Größe: a/b", "Delete")  # the one that is open: the page shows the start
        page.wait_for_function("() => document.title === 'planet · distal'")
        files = [
            {"name": "all.zip", "mimeType": "application/zip", "buffer": archive},
            {"name": "my_part.py", "mimeType": "text/x-python", "buffer": b"x = 1\n"},
        ]
        sheet.locator("input[type=file]").set_input_files(files)
        page.wait_for_function(
            "() => document.querySelector('.told').textContent.includes('opened')"
        )
        assert sheet.locator(".told").inner_text() == "2 scenes opened. 1 scene was here already."
        assert sorted(names()) == ["Größe: a/b", "my part", "planet 2"]
        for scene in page.evaluate(ALL):
            page.evaluate("(id) => studio.scenes.duplicate(id)", scene["id"])
        sheet.get_by_role("searchbox").fill("größ")
        assert sheet.locator(".scenes li:visible").count() == 3  # of 7
        page.keyboard.press("Escape")
        # After thirty days, what was deleted is gone.
        count = len(page.evaluate(ALL))
        page.evaluate("() => studio.scenes.store.tidy(Date.now() + 31 * 86_400_000)")
        assert len(page.evaluate(ALL)) == count - 1


def test_versions_are_looked_at_and_restored(address):
    with visits(address) as made:
        page = visit(made, address)
        edited(page, "# one\n")
        page.wait_for_timeout(1100)
        page.keyboard.press("Control+a")
        page.keyboard.press("Delete")
        kept(page)
        assert [why for why, _ in versions(page)] == ["typed", "opened"]
        page.evaluate("() => studio.commands.all.find(({ id }) => id === 'versions').act()")
        sheet = page.get_by_role("dialog", name="Versions of “planet”")
        sheet.get_by_role("button", name="as it was opened").click()
        assert sheet.locator("pre").inner_text().startswith('"""A planet')
        sheet.get_by_role("button", name="Restore").click()
        page.wait_for_function(f'() => ({TEXT})().startsWith(\'"""A planet\')')
        page.locator(".cm-content").first.focus()
        page.keyboard.press("Control+z")
        page.wait_for_function(f"() => ({TEXT})() === ''")
        assert "" in [text for _, text in versions(page)]


def test_a_scene_is_renamed_in_the_header_and_its_copies_follow(address):
    with visits(address) as made:
        page = visit(made, f"{address}#new")
        assert page.title() == "scene · distal"
        page.get_by_role("button", name="scene", exact=True).click()
        page.keyboard.type("Red lamp")
        page.keyboard.press("Enter")
        page.wait_for_function("() => studio.scenes.isKept")
        assert page.title() == "Red lamp · distal"
        with page.expect_download() as found:
            page.evaluate("() => studio.sharing.saveSource()")
        assert found.value.suggested_filename == "Red-lamp.py"
        page.reload()
        page.wait_for_function("() => document.title === 'Red lamp · distal'")


def test_an_address_of_a_scene_that_is_not_here_says_so(address):
    with visits(address) as made:
        page = visit(made, f"{address}#scene=0b0e7f6e-0000-4000-8000-000000000000")
        assert "not in this browser" in page.locator(".notice[role=alert]").inner_text()
        page = visit(made, f"{address}#c=AAAA")
        assert "damaged" in page.locator(".notice[role=alert]").inner_text()


@needs_axe
def test_sheets_and_bars_are_accessible(address):
    with visits(address, bypass_csp=True) as made:
        first = visit(made, address)
        edited(first, "# one\n")
        page = visit(made, first.url)
        for width in (1280, 390):
            page.set_viewport_size({"width": width, "height": 800})
            assert bar(page, "reader").is_visible()
            assert violations(page) == []
            wide = "() => document.documentElement.scrollWidth <= innerWidth"
            assert page.evaluate(wide), "something stands out of the page"
            page.get_by_role("button", name="Scenes").click()
            page.get_by_label("More for “planet”").click()
            assert violations(page) == []
            page.keyboard.press("Escape")
            page.keyboard.press("Escape")
