"""Make HTML of a lesson's text: CommonMark with tables, and Python in colors.

Input: Markdown. Output: HTML. Raw HTML in the text stays text.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from typing import Final

from markdown_it import MarkdownIt
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

_FORMATTER: Final = HtmlFormatter(nowrap=True)
_LEXER: Final = PythonLexer()


def python(code: str) -> str:
    """Return Python source as HTML, with a class for each kind of token."""
    return str(highlight(code, _LEXER, _FORMATTER)).rstrip("\n")


def code_block(code: str, *, label: str = "") -> str:
    """Return a block of code that the keyboard can scroll; ``code`` is HTML."""
    name = f' role="region" aria-label="{label}"' if label else ""
    return f'<pre tabindex="0"{name}><code>{code}</code></pre>'


def _block(code: str, language: str, _: str) -> str:
    return code_block(python(code) if language == "python" else escape(code.rstrip("\n")))


_MARKDOWN: Final = MarkdownIt("commonmark", {"html": False, "highlight": _block}).enable("table")


def markdown(text: str) -> str:
    """Return paragraphs as HTML."""
    return str(_MARKDOWN.render(text)).strip()


def inline(text: str) -> str:
    """Return a sentence as HTML, without a paragraph around it."""
    return str(_MARKDOWN.renderInline(text)).strip()


@dataclass(slots=True)
class Section:
    """A section of a lesson: the HTML below one heading of the second level."""

    parts: list[str] = field(default_factory=list)


def sections(text: str) -> list[Section]:
    """Return the text in sections; the first has no heading and may be empty."""
    tokens = _MARKDOWN.parse(text)
    starts = [i for i, token in enumerate(tokens) if token.type == "heading_open"]
    cuts = [0, *(i for i in starts if tokens[i].tag == "h2"), len(tokens)]
    made = []
    for first, last in pairwise(cuts):
        shown = _MARKDOWN.renderer.render(tokens[first:last], _MARKDOWN.options, {})
        made.append(Section([str(shown).strip()] if last > first else []))
    return made


def count_words(text: str) -> int:
    """Return the number of words a reader reads; code blocks are left out."""
    words, is_code = 0, False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code:
            words += sum(any(c.isalnum() for c in word) for word in line.split())
    return words
