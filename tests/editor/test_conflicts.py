"""Conflicts and drafts of the studio in a browser: what is asked, what stays, what comes back."""

from __future__ import annotations

import os
import signal

import pytest

from tests.accessibility import needs_axe, violations
from tests.browser import kept_page
from tests.editor.keeping_in_browser import end, start
from tests.editor.studio_page import DESK, IDLE, SCENE, SLOW_MS, studio

pytest.importorskip("websockets")

BAR = "() => document.querySelector('.state-bar')"
NO_BAR = "() => !document.querySelector('.state-bar')"
STARTED = "() => window.studio?.editor.name"
UNSENT = "() => Object.keys(sessionStorage).some((key) => key.startsWith('distal:unsent:'))"
KEPT = f"() => !({UNSENT})()"


def press(app, name):
    app.page.get_by_role("button", name=name, exact=True).click()


@needs_axe
def test_a_conflict_stays_until_a_person_has_chosen(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("() => studio.editor.goTo(1)")
        app.page.keyboard.type("# mine\n")
        app.idle()
        theirs = f"# theirs\n{SCENE}"
        app.file.write_text(theirs)
        app.wait(BAR)
        assert (
            "scene.py was changed by another program" in app.page.locator(".state-bar").inner_text()
        )

        # A save asks, and Cancel and Escape are no choice.
        for key in ("Cancel", "Escape"):
            app.page.keyboard.press("Control+s")
            dialog = app.page.locator("dialog.conflict")
            dialog.wait_for()
            assert "# theirs" in dialog.inner_text()
            assert violations(app.page) == []
            assert "# mine" in dialog.inner_text()
            app.page.keyboard.press("Escape") if key == "Escape" else press(app, key)
            assert app.file.read_text() == theirs
            assert app.page.locator(".state-bar").is_visible()

        # Another notice has its own place.
        app.page.evaluate("() => studio.page.tell('Something else', ['Close', () => {}])")
        assert app.page.locator(".state-bar").is_visible()
        app.page.evaluate("() => studio.page.tell(null)")
        assert app.page.locator(".state-bar").is_visible()

        # It is there after a reload, and the disk changes once more while the dialog is open.
        app.page.reload()
        app.wait(STARTED)
        app.wait(BAR)
        assert app.text.startswith("# mine")
        app.page.keyboard.press("Control+s")
        app.page.locator("dialog.conflict").wait_for()
        newer = f"# newer\n{SCENE}"
        app.file.write_text(newer)
        app.page.locator("dialog", has_text="It has changed once more.").wait_for()
        assert app.page.locator("dialog.conflict").count() == 1
        app.page.get_by_role("button", name="Overwrite the file").click()  # once it is enabled
        app.wait(NO_BAR)
        app.wait("() => !studio.texts.isChanged('scene.py')")
        assert app.file.read_text() == f"# mine\n{SCENE}"

        # What was overwritten is among the versions, and comes back as an edit.
        app.page.evaluate("() => studio.versions.open('scene.py')")
        entries = app.page.locator(".version-list button")
        entries.first.wait_for()
        kinds = [text.split("\n")[-1] for text in entries.all_inner_texts()]
        assert kinds[:3] == ["saved here", "saved by another program", "saved by another program"]
        entries.nth(1).click()
        app.page.locator(".version", has_text="# newer").wait_for()
        assert violations(app.page) == []
        press(app, "Put it into the page")
        assert app.text == newer
        app.page.evaluate("() => studio.editor.view.focus()")
        app.page.keyboard.press("Control+z")
        assert app.text == f"# mine\n{SCENE}"


def test_keep_mine_and_take_the_other(tmp_path):
    with studio(tmp_path) as app:
        app.page.evaluate("(text) => studio.editor.replace('scene.py', text)", f"# mine\n{SCENE}")
        app.file.write_text(f"# theirs\n{SCENE}")
        app.wait(BAR)
        press(app, "Keep mine")
        app.wait(NO_BAR)
        assert app.text == f"# mine\n{SCENE}"
        assert app.file.read_text() == f"# theirs\n{SCENE}"
        app.file.write_text(f"# again\n{SCENE}")
        app.wait(BAR)  # the choice was for the other text
        press(app, "Take the other")
        app.wait(NO_BAR)
        assert app.text == f"# again\n{SCENE}"
        assert not app.page.evaluate("() => studio.texts.isChanged('scene.py')")
        app.page.evaluate("() => studio.editor.view.focus()")
        app.page.keyboard.press("Control+z")
        assert app.text == f"# mine\n{SCENE}"
        assert app.saved() == f"# mine\n{SCENE}"

        # A file that is gone: its text stays, and is written again if one says so.
        app.file.rename(tmp_path / "moved.py")
        app.wait(BAR)
        assert "scene.py was renamed to moved.py" in app.page.locator(".state-bar").inner_text()
        app.page.keyboard.press("Control+s")
        app.page.locator("dialog.conflict").wait_for()
        assert not app.file.exists()
        press(app, "Write it again")
        app.wait(NO_BAR)
        app.wait("() => !studio.texts.isChanged('scene.py')")
        assert app.file.read_text() == f"# mine\n{SCENE}"

        # A folder in its place: why nothing is saved.
        app.file.unlink()
        app.file.mkdir()
        app.wait("() => document.querySelector('.state-bar')?.textContent.includes('is a folder')")
        app.page.evaluate("() => studio.save()")
        assert "scene.py is not saved: what is there now is a folder" in (
            app.page.locator(".notice").inner_text()
        )
        app.file.rmdir()
        app.wait("() => document.querySelector('.state-bar')?.textContent.includes('was deleted')")
        assert app.text == f"# mine\n{SCENE}"


def test_two_tabs_save_different_texts(tmp_path):
    with studio(tmp_path, tabs=2) as (first, second):
        for tab, text in ((first, "# a\n"), (second, "# b\n")):
            tab.page.evaluate("(text) => studio.editor.replace('scene.py', text)", text + SCENE)
        first.saved()
        second.wait(BAR)
        second.page.evaluate("() => void studio.save()")
        second.page.locator("dialog.conflict").wait_for()
        assert first.file.read_text() == f"# a\n{SCENE}"
        press(second, "Overwrite the file")
        first.wait("() => studio.editor.view.state.doc.toString().startsWith('# b')")
        assert first.file.read_text() == f"# b\n{SCENE}"
        assert first.page.locator(".state-bar").count() == 0


def test_two_tabs_have_drafts_of_their_own(tmp_path):
    with studio(tmp_path, tabs=2) as (first, second):
        for tab, text in ((first, "# a\n"), (second, "# b\n")):
            tab.page.evaluate("(text) => studio.editor.replace('scene.py', text)", text + SCENE)
            tab.wait(KEPT)
        for tab, text in ((second, "# b\n"), (first, "# a\n")):
            tab.page.reload()
            tab.wait(STARTED)
            assert tab.text == text + SCENE
            assert "Unsaved changes of scene.py" in tab.page.locator(".notice").inner_text()
        second.page.close()
        first.page.get_by_role("button", name="Discard them").click()
        assert first.text == SCENE


def test_a_file_of_two_names_is_written_in_place(tmp_path):
    with studio(tmp_path) as app:
        os.link(app.file, tmp_path / "twin.py")
        app.page.evaluate("(text) => studio.editor.replace('scene.py', text)", f"# mine\n{SCENE}")
        assert app.saved() == SCENE
        assert "2 names (hard links)" in app.page.locator(".notice").inner_text()
        press(app, "Write in place")
        app.wait("() => !studio.texts.isChanged('scene.py')")
        assert (tmp_path / "twin.py").read_text() == f"# mine\n{SCENE}"


@pytest.fixture
def started(tmp_path):
    """Starts servers as processes of their own; gives the process and its address."""
    running = []

    def begin():
        running.append(start(tmp_path / "scene.py"))
        return running[-1]

    yield begin
    for server, _ in running:
        end(server)


def test_unsaved_text_is_there_after_the_server_was_killed(tmp_path, started):
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    server, address = started()
    with kept_page(reduced_motion="reduce", **DESK) as kept:
        page = kept.page
        page.goto(address)
        page.wait_for_function(IDLE, timeout=SLOW_MS)
        page.evaluate("() => studio.editor.goTo(1)")
        page.keyboard.type("# mine\n")
        page.wait_for_function(KEPT, timeout=SLOW_MS)
        page.wait_for_timeout(300)  # the last key is sent
        server.send_signal(signal.SIGKILL)
        server.wait()
        page.locator(".state-bar", has_text="The studio's server is away.").wait_for()
        page.keyboard.type("# while it is away\n")
        page.wait_for_function(UNSENT)

        # Another program saves, and another server has another port.
        file.write_text(f"# theirs\n{SCENE}")
        _, other = started()
        assert other.split("/")[2] != address.split("/")[2]
        asked: list[str] = []
        page.on("dialog", lambda dialog: (asked.append(dialog.type), dialog.accept()))
        page.goto(other)
        assert asked == ["beforeunload"]  # what was typed since then is in this tab alone
        page.wait_for_function(STARTED, timeout=SLOW_MS)
        page.wait_for_function(BAR, timeout=SLOW_MS)
        text = page.evaluate("() => studio.editor.view.state.doc.toString()")
        assert text.startswith("# mine\n")
        assert file.read_text() == f"# theirs\n{SCENE}"
        kept.messages.clear()  # the browser says that the first server is gone
