"""The list of commands: found by typing, run by keys and touch; buttons and keys come from it."""

from __future__ import annotations

import re

import pytest

from tests.editor.studio_page import SLOW_MS, studio
from tests.editor.test_app import PHONE

pytest.importorskip("websockets")

_ALL = (
    "() => studio.commands.all.map(({ id, text, keys, button, act }) =>"
    " ({ id, text, keys, button, hasAct: !!act }))"
)
_FIELD = "() => document.activeElement.getAttribute('role')"


def options(app) -> list[str]:
    return app.page.locator(".palette [role=option] > span:first-child").all_inner_texts()


def chosen(app) -> str:
    """Return the option that the field names as the active one, which must be the selected one."""
    return app.page.evaluate(
        """() => {
          const field = document.querySelector('.palette [role=combobox]');
          const option = document.getElementById(field.getAttribute('aria-activedescendant'));
          const selected = [...document.querySelectorAll('.palette [aria-selected=true]')];
          if (selected.length !== 1 || selected[0] !== option) throw new Error('not the selected');
          return option.firstChild.textContent;
        }"""
    )


def test_a_command_is_found_and_run_by_keys(tmp_path):
    with studio(tmp_path) as app:
        keys = app.page.keyboard
        app.page.evaluate("() => studio.editor.view.focus()")
        keys.press("Control+k")
        assert app.page.evaluate(_FIELD) == "combobox"
        everything = options(app)
        assert chosen(app) == everything[0]
        keys.press("ArrowUp")
        assert chosen(app) == everything[-1]
        keys.press("ArrowDown")
        keys.press("ArrowDown")
        assert chosen(app) == everything[1]
        keys.type("nothing of this name")
        field = app.page.locator(".palette [role=combobox]")
        assert field.get_attribute("aria-expanded") == "false"
        assert field.get_attribute("aria-activedescendant") is None
        assert app.page.locator(".palette [role=status]").inner_text() == "No command of that name."
        keys.press("Enter")
        field.fill("glsl emitted")  # by another word, and in any order
        assert options(app) == ["Show the emitted text"]
        keys.press("Enter")
        app.page.locator(".palette").wait_for(state="detached")
        tab = app.page.get_by_role("tab", name="Emitted text")
        assert tab.get_attribute("aria-selected") == "true"
        app.page.evaluate("() => studio.editor.view.focus()")
        keys.press("Control+k")
        keys.press("Escape")
        assert app.page.evaluate("() => document.activeElement.ariaLabel") == "Code"
        # On a keyboard of other letters, the same place.
        app.page.evaluate(
            "() => document.body.dispatchEvent(new KeyboardEvent('keydown',"
            " { key: 'л', code: 'KeyK', ctrlKey: true, bubbles: true, cancelable: true }))"
        )
        assert app.page.locator(".palette").count() == 1


def test_buttons_keys_and_help_are_those_of_the_list(tmp_path):
    with studio(tmp_path) as app:
        declared = app.page.evaluate(_ALL)
        assert len({one["id"] for one in declared}) == len(declared)
        buttons = {one["id"]: one["button"] for one in declared if one.get("button")}
        shown = app.page.evaluate(
            "() => Object.fromEntries([...document.querySelectorAll('[data-command]')]"
            ".map((one) => [one.dataset.command, one.textContent]))"
        )
        assert shown == buttons
        app.page.get_by_role("button", name="?").click()
        told = app.page.locator(".keys dd").all_inner_texts()
        assert told == [one["text"] for one in declared if one.get("keys")]
        assert app.page.locator(".keys kbd").first.inner_text() == "Ctrl K"
        app.page.keyboard.press("Escape")
        app.page.get_by_role("button", name="Commands").click()
        listed = options(app)
        impossible = {"mistake", "play", "keepCamera", "resetCamera"}
        possible = [one for one in declared if one["hasAct"] and one["id"] not in impossible]
        missing = {one["text"] for one in possible} - set(listed)
        assert missing <= {"Find a command", "Show the picture on the full screen"}
        for text in ("Go to scene.py", "View: Normal", "Export: Shadertoy", "Open example bunny"):
            assert text in listed
        assert "Go to the next mistake" not in listed


def test_examples_exports_views_and_colors_by_name(tmp_path):
    with studio(tmp_path) as app:

        def run(words: str) -> None:
            app.page.keyboard.press("Control+k")
            app.page.locator(".palette [role=combobox]").fill(words)
            app.page.keyboard.press("Enter")

        run("view normal")
        app.wait("() => studio.picture.player.view === 'normal'")
        with app.page.expect_download(timeout=SLOW_MS) as found:
            run("export shadertoy")
        assert found.value.suggested_filename.startswith("scene")
        app.page.locator(".notice", has_text="The same: distal export scene.py").wait_for()
        run("dark colors")
        paper = "() => getComputedStyle(document.body).backgroundColor"
        assert app.page.evaluate(paper) == "rgb(19, 20, 23)"
        app.page.reload()
        app.wait("() => window.studio?.picture.player")
        assert app.page.evaluate(paper) == "rgb(19, 20, 23)"
        run("open example melting")
        app.wait("() => studio.texts.files['scene.py'].includes('sd_sphere')")


def test_commands_by_touch(tmp_path):
    with studio(tmp_path, **PHONE) as app:
        app.page.get_by_role("button", name="Find a command").tap()
        app.page.locator(".palette li", has_text=re.compile("^Show what each")).tap()
        app.wait("() => studio.costs.isOpen")
        wide = app.page.evaluate("() => document.documentElement.scrollWidth")
        assert wide <= PHONE["viewport"]["width"]
