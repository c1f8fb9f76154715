"""The course: each lesson compiles, its experiments show, its goals can be reached."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from distal.lessons.document import Goal, Layers, Phrases, Prose, Try
from distal.lessons.page import LessonLinks, lesson_page, still
from distal.lessons.prose import count_words
from distal.lessons.reading import read
from distal.lessons.scenes import StagedLesson, staged

FOLDER = Path(__file__).parents[2] / "lessons"
FILES = sorted(FOLDER.glob("*/lesson.md"))
SIZE = (96, 72)
MOST_WORDS = 900
MOST_BYTES = 120_000
MOST_POSTER = 27_000
LINK = re.compile(r"\[[^\]]*\]\(([^)]+)\)")
each = pytest.mark.parametrize("file", FILES, ids=lambda file: file.parent.name)


@cache
def lesson_of(file: Path) -> StagedLesson:
    return staged(read(file))


def difference(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a.astype(float) - b.astype(float)).mean() / 255.0)


def test_there_are_sixteen_in_order():
    assert [read(file).head.number for file in FILES] == list(range(1, 17))
    assert all(file.parent.name.startswith(f"{i:02d}_") for i, file in enumerate(FILES, 1))


@each
def test_it_has_what_a_lesson_has(file):
    made = lesson_of(file)
    assert made.seen.parameters
    assert all(parameter.label for parameter in made.seen.parameters)
    for kind, least in ((Try, 2), (Layers, 1), (Phrases, 1), (Prose, 2)):
        assert len(made.lesson.of_kind(kind)) >= least, kind.__name__
    layers = made.lesson.of_kind(Layers)[0]
    assert set(layers.captions) == set(layers.views)
    assert made.lesson.head.code


@each
def test_it_is_short(file):
    assert 300 <= count_words(file.read_text(encoding="utf-8")) <= MOST_WORDS


@each
def test_its_links_lead_somewhere(file):
    for target in LINK.findall(file.read_text(encoding="utf-8")):
        assert not target.startswith("http"), target
        assert (file.parent / target.split("#")[0]).exists(), target


@each
def test_every_experiment_changes_the_picture(file):
    made = lesson_of(file)
    head = made.lesson.head
    before = still(made.seen, SIZE, head.time, head.view)
    for part in made.lesson.of_kind(Try):
        view = part.view or head.view
        after = still(made.seen, SIZE, head.time, view, made.values[part.line])
        assert difference(before, after) >= part.least, part.title


@each
def test_every_phrase_moves_something(file):
    made = lesson_of(file)
    for table in made.lesson.of_kind(Phrases):
        moving = [row for row in table.rows if made.values[row.line]]
        assert len(moving) >= 2
        assert len({row.phrase for row in table.rows}) == len(table.rows)


@pytest.mark.parametrize(
    "file", [f for f in FILES if read(f).of_kind(Goal)], ids=lambda file: file.parent.name
)
def test_the_stored_solution_reaches_the_goal(file):
    made = lesson_of(file)
    time = made.lesson.head.time
    for part in made.lesson.of_kind(Goal):
        wanted = still(made.goals[part.line], SIZE, time)
        solved = still(made.seen, SIZE, time, params=made.values[part.line])
        assert difference(wanted, solved) <= part.within
        # It is a task: the picture at the beginning is far from the goal.
        assert difference(wanted, still(made.seen, SIZE, time)) >= 5.0 * part.within


def test_there_is_an_exercise():
    assert any(read(file).of_kind(Goal) for file in FILES)


@each
def test_its_page_is_small_before_the_first_picture(file):
    page = lesson_page(lesson_of(file), LessonLinks())
    assert page.omitted == {}
    text = page.text
    # The still picture is in the first part of the file; the live one needs all of it.
    assert text.index("</noscript>") <= MOST_POSTER
    assert len(text.encode()) <= MOST_BYTES
    assert not re.findall(r"https?://(?!www\.w3\.org/2000/svg)", text)


def test_the_sixth_holds_what_the_seed_holds():
    made = lesson_of(FILES[5])
    parameters = {p.name: (p.default, p.high) for p in made.seen.parameters}
    assert parameters == {"blend_softness": (0.3, 1.0), "max_steps": (64, 96)}
    values = [made.values[part.line] for part in made.lesson.of_kind(Try)]
    assert {"max_steps": 16} in values and {"blend_softness": 0.0} in values
    assert any(v.get("blend_softness", 0.0) > 0.7 for v in values)
    (table,) = made.lesson.of_kind(Phrases)
    assert len(table.rows) >= 6
