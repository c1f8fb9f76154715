"""Write a scene as a page: one file that needs no network, or a fragment for other pages.

Input: a viewable object. Output: HTML that contains the player, the programs and a poster. The
page's content security policy forbids every request. Does not depend on how the player draws.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.deflating import deflated_text
from distal.diagnostics import CompileError
from distal.export.exported import Exported
from distal.export.page_options import NO_POSTER, TRIANGLE_POSTER, WEBP, PageOptions
from distal.export.page_programs import PagePrograms
from distal.export.payload import payload, view_names
from distal.file_writer import replacement
from distal.lang.lazy_module import LazyModule
from distal.scene.viewing.viewable import Viewable
from distal.version import __version__

if TYPE_CHECKING:
    from distal.export import inspecting, poster, printing
else:
    inspecting = LazyModule("distal.export.inspecting")  # most pages do not need it
    printing = LazyModule("distal.export.printing")  # needs NumPy
    poster = LazyModule("distal.export.poster")  # needs NumPy and Pillow

PLAYER: Final = Path(__file__).with_name("player.js")
# The same player, which also traces paths: 4 kB that other pages do not need.
PATH_PLAYER: Final = Path(__file__).with_name("path_player.js")
# The same player for pictures that read earlier frames, the keyboard, the date: 7 kB more.
FRAME_PLAYER: Final = Path(__file__).with_name("frame_player.js")
# Draws a poster of triangles. It runs before the player, so it is seen while shaders compile.
TRIANGLES: Final = Path(__file__).with_name("triangle_poster.js")
# In a page that resets all styles, the text of scripts would be visible without this.
_UNSEEN: Final = ' style="display:none"'
# A module, to keep its names out of the page. The script that it inserts must be invisible too.
_UNPACK: Final = (
    'try{const bytes=Uint8Array.from(atob("%s"),(c)=>c.charCodeAt(0));'
    'const plain=new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));'
    'const player=document.createElement("script");player.type="module";'
    'player.style.display="none";player.textContent=await new Response(plain).text();'
    "document.documentElement.append(player)}catch{"
    'for(const host of document.querySelectorAll("[data-distal]")){'
    'const note=document.createElement("p");note.textContent="%s";host.append(note)}}'
)
TOO_OLD: Final = "This picture moves and turns in a browser of 2024 or younger."
NO_SCRIPT: Final = "This picture moves and turns where JavaScript is allowed."

# The same colors as in the player's style sheet, so that nothing flashes before it is ready.
_STYLE: Final = (
    ":root{color-scheme:dark light}"
    "html,body{height:100%;margin:0}"
    "body{background:light-dark(#f4f4f2,#151517);color:light-dark(#222,#ddd);"
    "font:14px/1.5 system-ui,sans-serif}"
    ".distal{display:block;position:relative;height:100vh;height:100dvh}"
    ".distal>:is(img,canvas){display:block;width:100%;height:100%;object-fit:contain}"
    "noscript{position:absolute;inset:auto 0 0;padding:.6em;text-align:center;background:Canvas}"
)
# A circle with a ring around it, so that no browser requests /favicon.ico.
ICON: Final = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E"
    "%3Ccircle cx='8' cy='8' r='6.5' fill='none' stroke='%23888'/%3E"
    "%3Ccircle cx='8' cy='8' r='4' fill='%23e8833a'/%3E%3C/svg%3E"
)


def write(seen: Viewable, path: Path, options: PageOptions) -> Exported:
    """Write the page.

    Args:
        seen: The object to show.
        path: The file to write.
        options: The options of the page.

    Raises:
        CompileError: WebGL 2 cannot show the first view.
        ValueError: There is no such view or parameter, or a value is out of range.
        SaveError: The file cannot be written.
    """
    for name in (options.view, *(options.views or ())):
        seen.image(name)  # raises if there is no such view
    seen = seen.in_mode(options.mode, caustics=options.caustics)
    if options.printable:
        printing.printed_node(seen, options)  # raises before time is spent on the poster
    if options.inspect:
        inspecting.check_inspected(seen, options)
    shown = poster.poster(seen, options) if options.poster != NO_POSTER else b""
    made = page(seen, options, shown, str(options.poster))
    with replacement(path) as file:
        file.write(made.text.encode("utf-8"))
    return Exported(path, made.parts, (), made.omitted, made.unprinted)


@dataclass(frozen=True, slots=True)
class Page:
    """A page and what it is made of.

    Attributes:
        text: The HTML.
        parts: Characters by the name of the part.
        omitted: Views that WebGL 2 cannot show, and why.
        unprinted: What has no end and is not saved by the page, in words.
    """

    text: str
    parts: dict[str, int]
    omitted: dict[str, str]
    unprinted: tuple[str, ...] = ()


def page(seen: Viewable, options: PageOptions, shown: bytes, media_type: str = WEBP) -> Page:
    """Return a page. Needs the standard library alone, if the scene has no textures.

    Args:
        seen: The object to show, in its mode.
        options: The options of the page.
        shown: The picture before the first frame; empty for none.
        media_type: The format of that picture: "webp", "png" ... or "triangles".

    Raises:
        CompileError: WebGL 2 cannot show the first view.
        ValueError: There is no such view or parameter, or a value is out of range.
    """
    script = inspecting.SCRIPT if options.inspect else player_of(seen)
    behind = printing.SCRIPT if options.printable else None
    alone = player = player_script(script, behind)
    if shown and media_type == TRIANGLE_POSTER:
        player = player_script(script, behind, TRIANGLES)
    omitted: dict[str, str] = {}
    unprinted: tuple[str, ...] = ()
    if options.printable:
        node, endless = printing.printed_node(seen, options)
        unprinted = tuple(endless)
    if options.inspect:
        inspecting.check_inspected(seen, options)

    def omit(name: str, error: CompileError) -> None:
        omitted[name] = error.diagnostics[0].message

    def more(programs: PagePrograms, name: str) -> dict[str, Any]:
        found: dict[str, Any] = {}
        if options.printable:
            found["printing"] = printing.printing(node, name, programs, options)
        if options.inspect:
            views = [v for v in view_names(seen, options) if v not in omitted]
            found["inspect"] = inspecting.inspecting(seen, views, programs, options, omit)
        return found

    content = payload(seen, options, omit, more=more)
    held = stage(content, shown, media_type)
    text = _fragment(held, player) if options.embed else _document(held, content, player)
    parts = {
        "player": len(alone.text),
        "shaders": len(json.dumps(content["programs"])),
        "textures": len(json.dumps(content["resources"])) if content["resources"] else 0,
        "poster": len(base64.b64encode(shown)) + len(player.text) - len(alone.text),
    }
    return Page(text, parts, omitted, unprinted)


@dataclass(frozen=True, slots=True)
class PlayerScript:
    """The player's script in a page.

    Attributes:
        text: The script that unpacks and starts the player.
        hashes: Hashes of all scripts that run, for the content security policy.
    """

    text: str
    hashes: tuple[str, ...]


def player_of(seen: Viewable) -> Path:
    """Return the file of the player for an object."""
    if seen.mode == "path":
        return PATH_PLAYER
    return FRAME_PLAYER if seen.keeps_frames else PLAYER


@cache
def player_script(
    file: Path = PLAYER, behind: Path | None = None, before: Path | None = None
) -> PlayerScript:
    """Return the compressed player: a page of 60 kB becomes one of 36 kB.

    Decompression needs no newer browser than the player itself.

    Args:
        file: The player's script.
        behind: A script that stands behind it.
        before: A script that runs before it.
    """
    files = [each for each in (before, file, behind) if each is not None]
    player = "\n".join(each.read_text(encoding="utf-8").strip() for each in files)
    text = _UNPACK % (deflated_text(player.encode("utf-8")), TOO_OLD)
    return PlayerScript(text, (_hash(text), _hash(player)))


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"


def json_text(value: Any) -> str:
    """Return JSON for a script element, escaped so that no text in it can end the element."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False)
    # A lone surrogate cannot be encoded in UTF-8; an escape can.
    text = "".join(c if not "\ud800" <= c <= "\udfff" else f"\\u{ord(c):04x}" for c in text)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def escaped(text: str) -> str:
    """Return a text for HTML, in elements and in quoted attributes."""
    return html.escape(text.encode("utf-8", "replace").decode("utf-8"), quote=True)


def stage(content: Mapping[str, Any], poster: bytes, media_type: str = WEBP) -> str:
    """Return the element in which the player draws, and its data.

    Args:
        content: The payload.
        poster: The picture before the first frame; empty for none.
        media_type: Its format.
    """
    width, height = content["size"]
    description = escaped(content["description"])
    shown = ""
    if poster:
        encoded = base64.b64encode(poster).decode("ascii")
        fill = ' style="display:block;width:100%;height:100%;object-fit:contain"'
        style = fill if content["embed"] else ""
        extent = f'width="{width}" height="{height}"'
        if media_type == TRIANGLE_POSTER:
            shown = (
                f'<canvas data-triangles="{encoded}" {extent} role="img"'
                f' aria-label="{description}"{style}></canvas>'
            )
        else:
            shown = (
                f'<img src="data:image/{media_type};base64,{encoded}" {extent}'
                f' alt="{description}"{style}>'
            )
    own = unseen = ""
    if content["embed"]:
        unseen = _UNSEEN
        # As wide as its container, and as high if the container has a height.
        place = (
            f"display:block;position:relative;width:100%;height:100%;aspect-ratio:{width}/{height}"
        )
        own = f' style="{place}"'
    return (
        f'<div data-distal class="distal"{own}>{shown}<noscript>{NO_SCRIPT}</noscript></div>\n'
        f'<script type="application/distal+json"{unseen}>{json_text(content)}</script>\n'
    )


def policy(player: PlayerScript) -> str:
    """Return the content security policy of a page: its own scripts and no requests."""
    scripts = " ".join(f"'{digest}'" for digest in player.hashes)
    return (
        f"default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _fragment(held: str, player: PlayerScript) -> str:
    return (
        f"<!-- Made by distal {__version__}. Paste all of this where the picture is to stand. -->\n"
        f'{held}<script type="module"{_UNSEEN}>{player.text}</script>\n'
    )


def _document(held: str, content: Mapping[str, Any], player: PlayerScript) -> str:
    name, description = escaped(content["name"]), escaped(content["description"])
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy(player)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="dark light">\n'
        f"<title>{name}</title>\n"
        f'<meta name="description" content="{description}">\n'
        f'<meta property="og:title" content="{name}">\n'
        f'<meta property="og:description" content="{description}">\n'
        '<meta property="og:type" content="website">\n'
        f'<meta name="generator" content="distal {__version__}">\n'
        f'<link rel="icon" href="{ICON}">\n'
        f"<style>{_STYLE}</style>\n</head>\n<body>\n<main>\n"
        f'{held}</main>\n<script type="module">{player.text}</script>\n</body>\n</html>\n'
    )
