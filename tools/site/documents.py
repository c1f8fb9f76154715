"""The documents of the site: guides, reference and decisions as pages, with search.

Input: Markdown files of ``docs/``. Output: HTML. Blocks of Python that make a picture by themselves
have a link that opens them in the playground.
"""

from __future__ import annotations

import contextlib
import io
import json
import posixpath
import re
import shutil
import tempfile
from dataclasses import dataclass, field
from html import escape, unescape
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from distal.editor.links import link_of
from distal.editor.looks import Looks
from distal.editor.messages import LookRequest
from distal.lessons.prose import code_block, python
from distal.public_names import DECLARED_NAMES

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
_SHAPES = frozenset(DECLARED_NAMES["distal.scene.objects.shapes"].split())
_SHAPE = re.compile(r"<strong>([A-Z]\w+)</strong>")
_LINK = re.compile(r'(href|src)="([^"]+)"')


@dataclass(frozen=True, slots=True)
class Found:
    """A part of a page that the search finds.

    Attributes:
        title: Its heading.
        page: The page's title.
        address: Its address from the site's root.
        text: What it says.
    """

    title: str
    page: str
    address: str
    text: str


@dataclass
class Tried:
    """Which blocks of Python make a picture without NumPy and without other files."""

    known: dict[str, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._looks = Looks(Path(self._folder.name))

    def works(self, code: str) -> bool:
        """Whether the playground shows a picture of a block."""
        if code not in self.known:
            self.known[code] = not re.search(r"\bnumpy\b|Image\.open", code) and self._shows(code)
        return self.known[code]

    def _shows(self, code: str) -> bool:
        number = len(self.known)
        texts = {"scene.py": code}
        request = LookRequest(id=number, revision=number, files=texts, main="scene.py")
        try:
            # What a block writes goes to a folder that is removed.
            with contextlib.redirect_stdout(io.StringIO()), contextlib.chdir(self._folder.name):
                self._looks.load(request, texts)
        except Exception:  # whatever it raises, there is no picture to show
            return False
        return True


def playground_link(files: dict[str, str], main: str, up: str) -> str:
    """Return the address that opens texts in the playground."""
    return f"{up}playground/index.html{link_of({'files': files, 'main': main})}"


def build(folder: Path, tried: Tried) -> list[Found]:
    """Write the pages of all documents; return what the search finds in them."""
    found: list[Found] = []
    for file in sorted(DOCS.rglob("*.md")):
        inner = file.relative_to(DOCS).with_suffix(".html")
        target = (
            folder / "docs" / (inner.with_name("index.html") if file.stem == "README" else inner)
        )
        target.parent.mkdir(parents=True, exist_ok=True)
        up = "../" * len(target.relative_to(folder).parts[:-1])
        made = Document(file, up, tried)
        target.write_text(page(made.title, made.html, up), encoding="utf-8")
        found += made.found(target.relative_to(folder).as_posix())
    shutil.copytree(DOCS / "pictures", folder / "docs" / "pictures")
    return found


class Document:
    """A Markdown file as HTML.

    Args:
        file: The file, in ``docs/``.
        up: The way from its page to the site's root.
        tried: Which blocks can be tried.
    """

    def __init__(self, file: Path, up: str, tried: Tried) -> None:
        self._file, self._up, self._tried = file, up, tried
        self._sections: list[tuple[str, str, list[str]]] = [("", "", [])]
        parser = MarkdownIt("commonmark", {"html": True}).enable("table")
        tokens = parser.parse(file.read_text(encoding="utf-8"))
        self._prepare(tokens)
        parser.options["highlight"] = self._block
        body = str(parser.renderer.render(tokens, parser.options, {}))
        self.html = self._linked(self._live(body))
        self.title = next((title for _, title, _ in self._sections if title), file.stem)

    def found(self, address: str) -> list[Found]:
        """Return its sections for the search."""
        if self._file.stem == "gallery":
            return []  # the site has its own
        return [
            Found(
                title or self.title,
                self.title,
                f"{address}#{slug}" if slug else address,
                " ".join(text),
            )
            for slug, title, text in self._sections
            if title or text
        ]

    def _prepare(self, tokens: list[Token]) -> None:
        slugs: dict[str, int] = {}
        for i, token in enumerate(tokens):
            if token.type == "heading_open":
                title = re.sub(r"[*`]|\]\([^)]*\)|\[", "", tokens[i + 1].content)
                slug = re.sub(r"[^\w -]", "", title.lower()).strip().replace(" ", "-")
                count = slugs.get(slug, 0)
                slugs[slug] = count + 1
                slug = f"{slug}-{count}" if count else slug
                token.attrSet("id", slug)
                self._sections.append((slug, title, []))
            elif token.type == "table_open":
                token.attrSet("tabindex", "0")  # it scrolls where it is wider than the page
            elif token.type == "inline" and tokens[i - 1].type != "heading_open":
                self._sections[-1][2].append(re.sub(r"\]\([^)]*\)|[*`\[]", "", token.content))

    def _block(self, code: str, language: str, _: str) -> str:
        if language != "python":
            return code_block(escape(code.rstrip("\n")))
        made = code_block(python(code))
        if not self._tried.works(code):
            return made
        address = escape(playground_link({"scene.py": code}, "scene.py", self._up))
        return f'<div class="block">{made}<a class="try" href="{address}">Try it</a></div>'

    def _live(self, body: str) -> str:
        """Link the names of shapes in the catalogue to a picture of each."""
        if self._file.stem != "catalogue":
            return body

        def linked(match: re.Match[str]) -> str:
            name = match[1]
            code = f"from distal import {name}\n\nshape = {name}()\n"
            if name not in _SHAPES or not self._tried.works(code):
                return match[0]
            address = escape(playground_link({"scene.py": code}, "scene.py", self._up))
            return f'<strong><a href="{address}">{name}</a></strong>'

        return _SHAPE.sub(linked, body)

    def _linked(self, body: str) -> str:
        return _LINK.sub(
            lambda match: f'{match[1]}="{escape(self._address(unescape(match[2])))}"', body
        )

    def _address(self, address: str) -> str:
        """Return a link of the repository as one of the site."""
        if re.match(r"[a-z]+:|#", address) or address.startswith(f"{self._up}playground/"):
            return address
        path, _, anchor = address.partition("#")
        anchor = f"#{anchor}" if anchor else ""
        whole = posixpath.normpath((self._file.parent.relative_to(ROOT) / path).as_posix())
        if re.fullmatch(r"examples/\w+\.py", whole):
            return f"{self._up}playground/index.html#example={Path(whole).stem}"
        if whole.startswith("examples"):
            return f"{self._up}gallery/index.html"
        if whole.startswith("lessons"):
            return f"{self._up}lessons/index.html"
        if not whole.startswith("docs"):
            return f"{self._up}index.html"
        if (ROOT / whole).is_dir():
            return f"{self._up}docs/index.html"
        made = re.sub(r"README\.md$", "index.html", whole)
        return f"{self._up}{re.sub(r'.md$', '.html', made)}{anchor}"


def page(title: str, body: str, up: str, classes: str = "text") -> str:
    """Return a page of the site.

    Args:
        title: Its title, as text.
        body: What is in it, as HTML.
        up: The way from the page to the site's root.
        classes: The classes of its main part.
    """
    links = (
        ("playground/index.html", "Playground"),
        ("lessons/index.html", "Lessons"),
        ("gallery/index.html", "Gallery"),
        ("docs/index.html", "Documentation"),
    )
    nav = "".join(f'<a href="{up}{address}">{text}</a>' for address, text in links)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{escape(title)} · distal</title>\n"
        '<link rel="icon" href="data:,">\n'
        f'<link rel="stylesheet" href="{up}site.css">\n</head>\n'
        '<body>\n<a class="skip" href="#main">Skip to the text</a>\n<header class="top">'
        f'<a class="brand" href="{up}index.html">distal</a><nav aria-label="Site">{nav}</nav>'
        f'<form class="search" role="search" data-up="{up}"><input type="search" '
        'aria-label="Search" placeholder="Search" autocomplete="off">'
        '<div class="hits" hidden></div>'
        f'</form></header>\n<main id="main" class="{classes}" tabindex="-1">\n{body}\n</main>\n'
        f'<script src="{up}index.js" defer></script>\n<script src="{up}site.js" defer></script>\n'
        "</body>\n</html>\n"
    )


def write_search(folder: Path, found: list[Found]) -> None:
    """Write what the search looks through: a script, because pages on disk may read no data."""
    rows = [[f.title, f.page, f.address, " ".join(f.text.split())[:1500]] for f in found]
    text = f"window.SEARCHED = {json.dumps(rows, ensure_ascii=False, separators=(',', ':'))};\n"
    (folder / "index.js").write_text(text, encoding="utf-8")
