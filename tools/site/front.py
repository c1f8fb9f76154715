"""The front page of the site: a live scene, its code, and what else there is.

Input: the gallery's and the lessons' pages that are written already. Output: ``index.html``. The
live scene is a page's player with all it needs, so the front page needs no other file to move.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from PIL import Image

from distal.editor.local.server import examples
from distal.example_files import all_examples
from distal.export.page import page as scene_page
from distal.export.page_options import PageOptions
from distal.images.png import quantise
from distal.lang.render_options import RenderOptions
from distal.lessons.prose import code_block, python
from distal.lessons.reading import read
from distal.loading import load
from distal.scene.viewing.viewable import viewable
from tools.site.documents import page
from tools.site.pages import CARD, card, card_picture, example_card

HERO = "planet"
# Changes of the scene beside its code: what to write, the parameters, the look.
CHANGES = (
    ("Drag <em>Melt</em> to 0.4", {"melt": 0.4, "turn": 0.25}, None),
    ("Drag <em>Turn</em> to -0.4", {"turn": -0.4}, None),
    ('Write <code>look="night"</code>', {"turn": 0.8}, "night"),
)
SHOWN = (
    *("still_life", "city", "castle", "wine"),
    *("beach", "gyroid_part", "room_door", "molecule"),
)
TAUGHT = (3, 6, 13)
COMMANDS = (
    ("distal view scene.py", "a window that follows the file"),
    ("distal studio scene.py", "code and picture side by side"),
    ("distal export scene.py -o scene.html", "a page with sliders: one file, works offline"),
    ("distal video scene.py -o scene.mp4", "a film"),
    ("distal render scene.py --mode path", "a picture with exact light and caustics"),
    ("distal compile scene.py --target wgsl", "a shader for your own program"),
)


def build(folder: Path, names: Sequence[str], lessons: Sequence[Path]) -> None:
    """Write the front page.

    Args:
        folder: The site's folder.
        names: The examples that the gallery shows.
        lessons: The files of the lessons.
    """
    parts = (_hero(), _code(folder), _lessons(lessons), _examples(names), _commands())
    text = page("3D scenes in Python", "\n".join(parts), "", "wide")
    (folder / "index.html").write_text(text, encoding="utf-8")


def _hero() -> str:
    poster = example_card(HERO)
    options = PageOptions(views=["color"], embed=True)
    live = scene_page(viewable(load(f"example:{HERO}")), options, poster, "webp").text
    return f"""<section class="hero"><div><h1>3D scenes, written as ordinary Python</h1>
<p>A function answers “how far is the nearest surface from here?”. distal compiles it to vector code
for the CPU, to GLSL for browsers and to WGSL for GPUs: one source, everywhere.</p>
<p class="acts"><a class="act" href="playground/index.html">Open the playground</a>
<a href="lessons/index.html">Learn it</a> <a href="docs/index.html">Read about it</a></p></div>
<div class="live">{live}</div></section>"""


def _code(folder: Path) -> str:
    source = all_examples()[HERO].read_text(encoding="utf-8")
    code = source[source.index("from ") :].strip()
    figures = []
    for number, (text, values, look) in enumerate(CHANGES):
        picture = f"change_{number}.webp"
        (folder / picture).write_bytes(_changed(values, look))
        figures.append(
            f'<figure><img src="{picture}" alt="" width="480" height="360" loading="lazy">'
            f"<figcaption>{text}</figcaption></figure>"
        )
    link = f"playground/index.html#example={HERO}"
    return (
        '<section class="scene"><h2>This is all of it</h2><div class="block">'
        f'{code_block(python(code))}<a class="try" href="{link}">Try it</a></div>'
        f'<div class="changes">{"".join(figures)}</div></section>'
    )


def _changed(values: dict[str, float], look: str | None) -> bytes:
    seen = viewable(load(f"example:{HERO}"), look=look)
    options = RenderOptions(size=CARD, params=dict(values), samples=4, device="cpu")
    return card_picture(Image.fromarray(quantise(seen.render(options).array)[..., :3]))


def _lessons(files: Sequence[Path]) -> str:
    cards = []
    for file in files:
        head, name = read(file).head, file.parent.name
        if head.number in TAUGHT:
            address, picture = f"lessons/{name}.html", f"lessons/{name}.webp"
            cards.append(card(address, picture, f"{head.number}. {head.title}", head.summary))
    return (
        "<section><h2>Learn ray marching by breaking it</h2>"
        f'<ul class="cards three">{"".join(cards)}</ul>'
        f'<p><a href="lessons/index.html">All {len(files)} lessons</a></p></section>'
    )


def _examples(names: Sequence[str]) -> str:
    titles = {row["name"]: row["title"] for row in examples()}
    cards = "".join(
        f'<li><a href="gallery/{name}.html"><img src="gallery/{name}.webp" '
        f'alt="{escape(titles[name])}" width="480" height="360" loading="lazy"></a></li>'
        for name in SHOWN
        if name in names
    )
    return (
        f'<section><h2>Each of these is live</h2><ul class="cards four">{cards}</ul>'
        f'<p><a href="gallery/index.html">All {len(names)} examples</a></p></section>'
    )


def _commands() -> str:
    rows = "".join(
        f"<div><dt><code>{escape(command)}</code></dt><dd>{escape(what)}</dd></div>"
        for command, what in COMMANDS
    )
    return (
        '<section><h2>One source, everywhere</h2><dl class="commands"><div><dt><code>pip install '
        f"'distal[all]'</code></dt><dd>Python 3.11 or newer</dd></div>{rows}</dl></section>"
    )
