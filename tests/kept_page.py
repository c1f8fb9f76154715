"""A page of a browser that one test after another uses, each as if it were new.

A context of its own for each test costs a renderer process, which is most of what a small page
costs. Here the context and its page stay, and what a test leaves behind is removed: other pages,
what is stored, permissions, emulated media, the mouse. Whether that worked is asked of the page:
one that differs from a new one is closed, and so is one that a test has given listeners, routes or
scripts, or in which a test failed. Knows nothing of what is shown.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final
from urllib.parse import urlsplit

BLANK: Final = Path(__file__).with_name("blank_page.html")
# What cannot be taken back: pages on which one of these was called are not used again.
SPENDING: Final = ("on", "once", "route", "add_init_script", "expose_function", "expose_binding")
# No fault of a page: what SwiftShader says when a picture is read back, which Chromium does to show
# it; and that the driver's process ended, with what all pages draw in it (which they draw anew).
OF_THE_DRIVER: Final = (
    "GPU stall due to ReadPixels",
    "CONTEXT_LOST_WEBGL: loseContext: context lost",
)
# Options of a context that a page can change for itself.
_MEDIA: Final = {"color_scheme": "light", "reduced_motion": "no-preference"}
_STATE: Final = """async () => {
  const media = (query) => matchMedia(query).matches;
  return {
    stored: [localStorage.length, sessionStorage.length, document.cookie],
    databases: (await indexedDB.databases()).length,
    granted: (await navigator.permissions.query({ name: "clipboard-read" })).state,
    media: [
      media("(prefers-reduced-motion: reduce)"), media("(prefers-color-scheme: dark)"),
      media("print"), media("(pointer: coarse)"),
    ],
    ratio: devicePixelRatio,
    scale: visualViewport.scale,
    isOnline: navigator.onLine,
    name: window.name,
    hovered: document.querySelectorAll("body :hover").length,
    hasFocusElsewhere: document.activeElement !== document.body,
    isWhole: !document.fullscreenElement && !document.pointerLockElement,
    // playwright's clock stays in a context: what a page waits for would never come.
    isClockReal: [Date, setTimeout, requestAnimationFrame].every((own) => /native code/.test(own)),
  };
}"""


def is_of_the_driver(text: str) -> bool:
    """Return whether a line of the console is no fault of a page."""
    return any(noise in text for noise in OF_THE_DRIVER)


class KeptPage:
    """A context and its page.

    Attributes:
        context: playwright's context.
        page: Its page; others of the context are closed at the end of a test.
        messages: Lines of the console since the test began, and what was thrown, but not
            what the driver says.
        asked: Addresses that were asked for since the test began.
    """

    def __init__(self, running: Any, timeout_ms: float, options: dict[str, Any]) -> None:
        self._running, self._timeout_ms = running, timeout_ms
        self._media = {name: options.get(name, usual) for name, usual in _MEDIA.items()}
        self.context = running.new_context(**options)
        self.page = self.context.new_page()
        self.messages: list[str] = []
        self.asked: list[str] = []
        self._listen()
        self._is_spent = False
        for name in SPENDING:
            for thing in (self.context, self.page):
                if hasattr(thing, name):
                    setattr(thing, name, self._spending(getattr(thing, name)))
        self._commands = self.context.new_cdp_session(self.page)
        self._blank()
        self._new = self._state()

    def _listen(self) -> None:
        def said(text: str) -> None:
            if not is_of_the_driver(text):
                self.messages.append(text)

        def asked(address: str) -> None:
            self.asked.append(address)

        self.context.on("console", lambda line: said(f"{line.type}: {line.text}"))
        self.context.on("weberror", lambda thrown: said(f"error: {thrown.error}"))
        self.context.on("request", lambda request: asked(request.url))
        self.page.on("websocket", lambda socket: asked(socket.url))
        self.page.on("crash", lambda _: said("error: the page crashed"))

    def serves(self, running: Any) -> bool:
        """Return whether it is a page of this browser, and the browser still there."""
        return self._running is running and not self.page.is_closed()

    def begin(self, viewport: dict[str, int] | None) -> None:
        """Give it to a test: as large as that wants it, with nothing heard yet."""
        if viewport is not None and self.page.viewport_size != viewport:
            self.page.set_viewport_size(viewport)
        self.messages, self.asked = [], []

    def is_renewed(self) -> bool:
        """Remove what a test left behind; return whether the page is as a new one."""
        if self._is_spent or not self._running.is_connected():
            return False
        for other in self.context.pages:
            if other != self.page:
                other.close()
        scheme, place, *_ = urlsplit(self.page.url)
        origin = {"origin": f"{scheme}://{place}", "storageTypes": "all"}
        self._blank()
        self._commands.send("Storage.clearDataForOrigin", origin)
        self.page.evaluate("() => { sessionStorage.clear(); window.name = ''; }")
        self.context.clear_cookies()
        self.context.clear_permissions()
        return self._state() == self._new

    def close(self) -> None:
        """Close the context."""
        self.context.close()

    def _blank(self) -> None:
        self.page.set_default_timeout(self._timeout_ms)
        self.page.goto(BLANK.as_uri())
        self.page.emulate_media(**self._media)
        self.page.mouse.up()
        self.page.mouse.move(-1, -1)
        for key in ("Shift", "Control", "Alt", "Meta"):
            self.page.keyboard.up(key)

    def _state(self) -> Any:
        return self.page.evaluate(_STATE)

    def _spending(self, act: Callable[..., Any]) -> Callable[..., Any]:
        def spending(*args: Any, **options: Any) -> Any:
            self._is_spent = True
            return act(*args, **options)

        return spending


def key_of(options: dict[str, Any]) -> str:
    """Return what tells contexts apart that a page cannot change: all options but a size."""
    told = {**options, "viewport": options.get("viewport", {}) is None}
    return json.dumps(told, sort_keys=True)
