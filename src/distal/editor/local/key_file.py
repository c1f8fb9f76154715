"""The file that brings the key to the browser.

Input: the address with the key. Output: a file that only this user can read, and that leads the
browser there. The arguments of programs, such as ``xdg-open``, can be read by all users of the
machine. Needs the standard library alone.
"""

from __future__ import annotations

import html
import os
from typing import Final

from distal.editor.local.scratch import OPENING, ScratchFolder

_PAGE: Final = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta name="color-scheme" content="dark light">
<meta http-equiv="refresh" content="0; url={address}">
<title>distal studio</title>
<p><a href="{address}">Open the studio</a></p>
</html>
"""


class KeyFile:
    """A page that leads to an address, in a folder of its own.

    Args:
        address: The address.

    Raises:
        OSError: It cannot be written.
    """

    def __init__(self, address: str) -> None:
        self._folder = ScratchFolder(OPENING)
        self.path = self._folder.path / "studio.html"
        try:
            opened = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with open(opened, "w", encoding="utf-8") as file:
                file.write(_PAGE.replace("{address}", html.escape(address)))
        except OSError:
            self.remove()
            raise

    def remove(self) -> None:
        """Remove the file and its folder; later calls do nothing."""
        self._folder.remove()
