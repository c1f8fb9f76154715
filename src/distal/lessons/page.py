"""Write a lesson as one page that needs neither a compiler nor a network.

Input: a lesson's file. Output: HTML with the text, the player, all programs and stills. The page's
script is made from ``web/src/lesson/``; each button carries its values as data.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Final, assert_never

from PIL import Image as PillowImage

from distal.diagnostics import readable
from distal.export.exported import Exported
from distal.export.page import ICON, NO_SCRIPT, escaped, player_script, policy, stage
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.export.poster import poster
from distal.file_writer import replacement
from distal.images.png import quantise
from distal.lang.parameter_values import Value
from distal.lang.render_options import RenderOptions
from distal.lessons.document import LAYERS, Goal, Layers, Phrases, Prose, Try
from distal.lessons.prose import Section, code_block, inline, markdown, python, sections
from distal.lessons.reading import read
from distal.lessons.scenes import StagedLesson, folded, staged
from distal.scene.viewing.viewable import Viewable
from distal.version import __version__

SCRIPT: Final = Path(__file__).with_name("lesson.js")
STYLE: Final = Path(__file__).with_name("lesson.css")
STILL_PX: Final = 192
STILL_QUALITY: Final = 70


@dataclass(frozen=True, slots=True)
class LessonLinks:
    """Links of a lesson's page to other pages; empty texts for none.

    Attributes:
        index: The list of lessons.
        previous: Address and title of the lesson before.
        following: Address and title of the next lesson.
        editor: The lesson's scene in an editor.
    """

    index: str = ""
    previous: tuple[str, str] = ("", "")
    following: tuple[str, str] = ("", "")
    editor: str = ""


def write(file: str | Path, path: Path, links: LessonLinks | None = None) -> Exported:
    """Write the page of a lesson.

    Args:
        file: The lesson.
        path: The file to write.
        links: Links to other pages.

    Raises:
        LoadError: The lesson cannot be read.
        CompileError: The lesson or its scene is wrong.
        SaveError: The file cannot be written.
    """
    made = lesson_page(staged(read(file)), links or LessonLinks())
    with replacement(path) as out:
        out.write(made.text.encode("utf-8"))
    return Exported(path, made.parts, (), made.omitted)


@dataclass(frozen=True, slots=True)
class LessonPage:
    """A page of a lesson.

    Attributes:
        text: The HTML.
        parts: The sizes of its parts in bytes.
        poster: The picture that it shows first, as WebP.
        omitted: The views that it leaves out, with reasons.
    """

    text: str
    parts: Mapping[str, int]
    poster: bytes
    omitted: dict[str, str] = field(default_factory=dict)


def lesson_page(made: StagedLesson, links: LessonLinks) -> LessonPage:
    """Return the page of a lesson."""
    head = made.lesson.head
    options = PageOptions(
        size=head.size,
        time=head.time,
        view=head.view,
        views=made.views,
        embed=True,
        title=head.title,
    )
    omitted: dict[str, str] = {}
    content = payload(
        made.seen, options, lambda name, error: omitted.update({name: error.diagnostics[0].message})
    )
    still = poster(made.seen, options)
    article = _article(made)
    layers = _layers(made)
    text = _document(made, links, stage(content, still), layers, article)
    parts = {
        "player": len(player_script(SCRIPT).text),
        "style": len(_style()),
        "shaders": len(json.dumps(content["programs"])),
        "poster": len(base64.b64encode(still)),
        "layers": len(layers),
        "text": len(article),
    }
    return LessonPage(text, parts, still, omitted)


@cache
def _style() -> str:
    return STYLE.read_text(encoding="utf-8").strip()


# Pictures


def still_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return the size of the stills of a lesson."""
    return STILL_PX, max(1, round(STILL_PX * size[1] / size[0]))


def still(
    seen: Viewable,
    size: tuple[int, int],
    time: float,
    view: str = "color",
    params: Mapping[str, Value] | None = None,
) -> Any:
    """Return a still picture as an array of bytes, (height, width, 3)."""
    options = RenderOptions(size=size, time=time, params=dict(params or {}), view=view)
    return quantise(seen.render(options).array)[..., :3]


def _image(pixels: Any, *, lossless: bool = False) -> str:
    """Return a picture as an address that holds it."""
    file = io.BytesIO()
    PillowImage.fromarray(pixels).save(
        file, "WEBP", lossless=lossless, quality=STILL_QUALITY, method=6
    )
    return f"data:image/webp;base64,{base64.b64encode(file.getvalue()).decode('ascii')}"


# Parts of the page


def _layers(made: StagedLesson) -> str:
    """Return the strip of stills; empty if the lesson has none."""
    for part in made.lesson.parts:
        if isinstance(part, Layers):
            break
    else:
        return ""
    head = made.lesson.head
    width, height = size = still_size(head.size)
    items = []
    for name in LAYERS:
        view = part.views[name]
        is_first = view == head.view
        pressed = str(is_first).lower()
        # The view that the page begins with stands in it already, as the poster: the script shows
        # that one again, because a second picture of it may take 9 kB.
        picture = "" if is_first else f' src="{_image(still(made.seen, size, head.time, view))}"'
        items.append(
            f'<button type="button" class="layer" data-view="{escaped(view)}"'
            f' data-caption="{escaped(part.captions.get(name, ""))}" aria-pressed="{pressed}">'
            f'<img{picture} width="{width}" height="{height}" alt="">'
            f"<span>{name.capitalize()}</span></button>"
        )
    caption = escape(part.captions.get("color", ""))
    return (
        '<section class="layers" aria-label="Layers of the picture">'
        f'<div class="strip">{"".join(items)}</div><p class="caption">{caption}</p></section>'
    )


def _data(values: Mapping[str, Value], view: str = "") -> str:
    """Return the attributes of a button that sets values."""
    shown = f' data-view="{escaped(view)}"' if view else ""
    plain = {name: list(v) if isinstance(v, tuple) else v for name, v in values.items()}
    return f' data-values="{escaped(json.dumps(plain, separators=(",", ":")))}"{shown}'


def _article(made: StagedLesson) -> str:
    """Return the text with its experiments, in sections."""
    shown: list[Section] = [Section()]
    for part in made.lesson.parts:
        match part:
            case Prose():
                first, *others = sections(part.text)
                shown[-1].parts += first.parts
                shown += others
            case Try():
                shown[-1].parts.append(_try(part, made.values[part.line]))
            case Phrases():
                shown[-1].parts.append(_phrases(part, made))
            case Layers():
                pass  # below the picture
            case Goal():
                shown[-1].parts.append(_goal(part, made))
            case _:
                assert_never(part)
    if made.lesson.head.code:
        shown.append(Section([_code(made)]))
    full = [section for section in shown if section.parts]
    return "\n".join("\n".join(["<section>", *s.parts, "</section>"]) for s in full)


def _try(part: Try, values: Mapping[str, Value]) -> str:
    return (
        f'<div class="try"><button type="button" class="act"{_data(values, part.view)}>'
        f"{escape(part.title)}</button>\n{markdown(part.text)}\n"
        '<div class="outcome" hidden><figure class="before"><img alt="The picture before">'
        "<figcaption>Before</figcaption></figure>"
        f'<div class="watch"><p class="kicker">Watch for</p>{markdown(part.watch)}'
        '<button type="button" class="back">Put it back</button></div></div></div>'
    )


def _phrases(part: Phrases, made: StagedLesson) -> str:
    rows = []
    for row in part.rows:
        values = made.values[row.line]
        phrase = f"“{escape(row.phrase)}”"
        said = (
            f'<button type="button" class="phrase"{_data(values)}>{phrase}</button>'
            if values
            else f'<span class="phrase">{phrase}</span>'
        )
        labels = {p.name: p.label for p in made.seen.parameters}
        moved = ", ".join(f"{labels[name]}: {_shown(v)}" for name, v in values.items())
        rows.append(
            f'<tr><th scope="row">{said}</th><td>{escape(moved) or "no slider"}</td>'
            f"<td>{inline(row.text)}</td></tr>"
        )
    return (
        '<div class="wide" role="region" aria-label="Phrases" tabindex="0">'
        '<table class="phrases"><thead><tr><th scope="col">When someone says</th>'
        '<th scope="col">move</th><th scope="col">because</th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _shown(value: Value) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, tuple):
        return ", ".join(f"{v:g}" for v in value)
    return f"{value:g}"


def _goal(part: Goal, made: StagedLesson) -> str:
    head = made.lesson.head
    width, height = size = still_size(head.size)
    picture = _image(still(made.goals[part.line], size, head.time), lossless=True)
    yours = _image(still(made.seen, size, head.time))
    return (
        f'<div class="goal" data-within="{part.within:g}">{markdown(part.text)}\n'
        f'<div class="pair"><figure><img class="wanted" src="{picture}" width="{width}"'
        f' height="{height}" alt="The picture to reach"><figcaption>Goal</figcaption></figure>'
        f'<figure><img class="yours" src="{yours}" width="{width}" height="{height}"'
        ' alt="Your picture"><figcaption>Yours</figcaption></figure>'
        '</div><p class="difference" role="status"></p>'
        f'<p><button type="button" class="solve"{_data(made.values[part.line])}>'
        "Show the solution</button></p></div>"
    )


def _code(made: StagedLesson) -> str:
    """Return the scene's source, folded to the lines that matter."""
    name = readable(Path(made.seen.file).name) if made.seen.file else "scene.py"
    parts = []
    for text, first, is_shown in folded(made.source, made.lesson.head.code):
        block = code_block(python(text), label=f"Code from line {first}")
        if is_shown:
            parts.append(block)
        else:
            count = text.count("\n") + 1
            last = first + count - 1
            parts.append(
                f"<details><summary>Lines {first} to {last}</summary>{block}</details>"
                if count > 1
                else f"<details><summary>Line {first}</summary>{block}</details>"
            )
    return f"<h2>The code</h2>\n<p><code>{escape(name)}</code></p>\n{''.join(parts)}"


def _links(links: LessonLinks) -> tuple[str, str]:
    """Return the links above and below the text."""
    above, below = [], []
    if links.index:
        above.append(f'<a href="{escaped(links.index)}">All lessons</a>')
    if links.editor:
        above.append(f'<a href="{escaped(links.editor)}">Open in the editor</a>')
    for (address, title), word in ((links.previous, "Previous"), (links.following, "Next")):
        if address:
            below.append(f'<a href="{escaped(address)}">{word}: {escape(title)}</a>')
    foot = f'<nav class="foot" aria-label="Lessons">{"".join(below)}</nav>' if below else ""
    return "".join(above), foot


def _document(made: StagedLesson, links: LessonLinks, held: str, layers: str, article: str) -> str:
    head = made.lesson.head
    title = escaped(f"{head.number}. {head.title}")
    player = player_script(SCRIPT)
    above, below = _links(links)
    source = f'<p class="source">{inline(head.source)}</p>' if head.source else ""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy(player)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="dark light">\n'
        f'<title>{title}</title>\n<meta name="description" content="{escaped(head.summary)}">\n'
        f'<meta name="generator" content="distal {__version__}">\n'
        f'<link rel="icon" href="{ICON}">\n<style>{_style()}</style>\n</head>\n<body>\n'
        '<a class="skip" href="#text">Skip to the text</a>\n'
        f'<header class="top"><p class="order">Lesson {head.number}</p>'
        f"<h1>{escape(head.title)}</h1>"
        f'<p class="summary">{inline(head.summary)}</p><div class="tools">{above}'
        '<button type="button" class="present" hidden>Present</button></div></header>\n'
        '<main>\n<div class="bench"><div class="picture">\n'
        f'{held}</div>\n{layers}<section class="controls" aria-label="Sliders"></section></div>\n'
        f'<article id="text" tabindex="-1">\n{article}\n{source}</article>\n</main>\n{below}'
        '<p class="announcer" role="status"></p>\n'
        f"<noscript><p>{NO_SCRIPT}</p></noscript>\n"
        f'<script type="module">{player.text}</script>\n</body>\n</html>\n'
    )
