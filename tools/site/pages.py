"""The gallery and the lessons of the site.

Input: examples, their pictures, lessons. Output: pages. Each scene of the gallery is a page of its
own that needs neither Python nor a network.
"""

from __future__ import annotations

import io
import shutil
from collections.abc import Sequence
from html import escape
from pathlib import Path

from PIL import Image

from distal import example_files
from distal.editor.local.files import SceneFiles
from distal.editor.local.server import examples
from distal.export.page import page as scene_page
from distal.export.page_options import PageOptions
from distal.lessons.page import LessonLinks, lesson_page
from distal.lessons.reading import read
from distal.lessons.scenes import staged
from distal.loading import load
from distal.scene.viewing.viewable import viewable
from tools.site.documents import Found, page, playground_link

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "pictures"
LESSONS = ROOT / "lessons"
CARD = (480, 360)
# More views would make the pages larger and the build longer; the playground has all.
VIEWS = ("color", "normal", "steps")


def build_gallery(folder: Path, names: Sequence[str]) -> list[Found]:
    """Write a live page for each example, and the page of all."""
    (folder / "gallery").mkdir()
    titles = {row["name"]: row["title"] for row in examples()}
    cards, found = [], []
    for name in names:
        poster = example_card(name)
        (folder / "gallery" / f"{name}.webp").write_bytes(poster)
        (folder / "gallery" / f"{name}.html").write_text(_live(name, poster), encoding="utf-8")
        shown = name.replace("_", " ")
        edit = f'<a class="edit" href="../playground/index.html#example={name}">Edit</a>'
        cards.append(card(f"{name}.html", f"{name}.webp", shown, titles[name], edit))
        found.append(Found(shown, "Gallery", f"gallery/{name}.html", titles[name]))
    body = (
        "<h1>Gallery</h1>\n<p>Each opens live, in a page of its own; <em>Edit</em> opens it in the "
        f'playground.</p>\n<ul class="cards">{"".join(cards)}</ul>'
    )
    text = page("Gallery", body, "../", "wide")
    (folder / "gallery" / "index.html").write_text(text, encoding="utf-8")
    return found


def card(address: str, picture: str, title: str, text: str, more: str = "") -> str:
    """Return a linked picture with a title and a sentence.

    Args:
        address: Where it leads.
        picture: The picture's address.
        title: The title, as text.
        text: The sentence, as text.
        more: What stands below, as HTML.
    """
    return (
        f'<li><a href="{address}"><img src="{picture}" alt="" width="480" height="360" '
        f'loading="lazy"><strong>{escape(title)}</strong><span>{escape(text)}</span></a>{more}</li>'
    )


def card_picture(picture: Image.Image) -> bytes:
    """Return a picture at the size of a card, as WebP."""
    small = picture.convert("RGB")
    small.thumbnail(CARD)
    held = io.BytesIO()
    small.save(held, "webp", quality=78)
    return held.getvalue()


def example_card(name: str) -> bytes:
    """Return the picture of an example at the size of a card."""
    with Image.open(PICTURES / f"{name}.png") as image:
        return card_picture(image)


def _live(name: str, poster: bytes) -> str:
    seen = viewable(load(f"example:{name}"))
    views = [view for view in VIEWS if view in seen.views]
    return scene_page(seen, PageOptions(views=views), poster, "webp").text


def build_lessons(folder: Path, files: Sequence[Path]) -> list[Found]:
    """Write the pages of lessons, and the page of all."""
    (folder / "lessons").mkdir()
    heads = [read(file).head for file in files]
    names = [f"{file.parent.name}.html" for file in files]
    found, rows = [], []
    for i, file in enumerate(files):
        neighbors = [
            (names[j], heads[j].title) if 0 <= j < len(files) else ("", "") for j in (i - 1, i + 1)
        ]
        scene = heads[i].scene
        path = (
            example_files.all_examples()[scene[8:]]
            if scene.startswith("example:")
            else file.parent / scene
        )
        texts = SceneFiles(path)
        editor = playground_link(texts.all().files, texts.main, "../")
        links = LessonLinks("index.html", *neighbors, editor)
        made = lesson_page(staged(read(file)), links)
        (folder / "lessons" / names[i]).write_text(made.text, encoding="utf-8")
        picture = f"{file.parent.name}.webp"
        (folder / "lessons" / picture).write_bytes(made.poster)
        title = f"{heads[i].number}. {heads[i].title}"
        rows.append(card(names[i], picture, title, heads[i].summary))
        found.append(Found(title, "Lessons", f"lessons/{names[i]}", heads[i].summary))
    body = (
        "<h1>Lessons</h1>\n<p>From the first ray to glass: each with a live picture, sliders and "
        f'experiments.</p>\n<ol class="cards">{"".join(rows)}</ol>'
    )
    text = page("Lessons", body, "../", "wide")
    (folder / "lessons" / "index.html").write_text(text, encoding="utf-8")
    return found


def all_lessons() -> list[Path]:
    """Return the files of all lessons, in order."""
    return sorted(LESSONS.glob("*/lesson.md"))


def all_examples() -> list[str]:
    """Return the names of the gallery that have a picture."""
    return [name for name in example_files.all_examples() if (PICTURES / f"{name}.png").exists()]


def copy_style(folder: Path) -> None:
    """Write the style sheet and the script that all pages have."""
    for name in ("site.css", "site.js"):
        shutil.copyfile(ROOT / "web" / "src" / "site" / name, folder / name)
