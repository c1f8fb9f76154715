"""The work and the time of lines: estimates in closed form, repetitions that change nothing."""

import re

import numpy as np
import pytest

from distal.editor.counting import counting, timing
from distal.example_files import gallery
from distal.ir.intrinsics import INTRINSICS
from distal.loading import load
from distal.scene.viewing.viewable import viewable
from tests.editor.line_costs import LineCost, Native, Repeated, counted, line_costs, spearman
from tests.egl import EglUnavailableError, context

SIZE = (24, 16)
FILE = "scene.py"
CALLS = """from distal.lang import Frame, cos, floor, func, image, sin, vec3

@func
def roots(x: float, count: int) -> float:
    total = x * x + x
    for i in range(count):
        total += floor(total * 1.25)
        if i > 6:
            return total - 1.0
    return total

@image
def picture(frame: Frame) -> vec3:
    x = frame.coord.x
    count = int(frame.coord.y)
    first = roots(x, count)
    left = x
    while left * 2.0 > 7.0:
        left = left * 0.5
    if first * x > 500.0: first = roots(left, 2) + roots(x, 1)
    speed = sin(frame.time * 3.0) + cos(frame.time)
    return vec3(first * speed, left, x) * 0.01
"""
HEAVY = """from distal.lang import Frame, func, image, sqrt, vec3

@func
def slow(x: float) -> float:
    total = x
    for i in range(150):
        total = sqrt(total * 0.7 + float(i))
    return total

@image
def picture(frame: Frame) -> vec3:
    x = frame.coord.x * 0.37 + 1.0
    light = sqrt(x) + x * 0.2
    heavy = slow(x)
    shown = light * 0.1 + heavy
    return vec3(shown, light, x) * 0.05
"""


@pytest.fixture(autouse=True)
def _egl():
    try:
        context()
    except EglUnavailableError as error:
        pytest.skip(str(error))


def seen_of(folder, text):
    file = folder / FILE
    file.write_text(text)
    return viewable(load(file))


def plain_work(width, height):
    """The operations of each line of ``CALLS``, pixel by pixel: the same program in Python."""
    floor = INTRINSICS["floor"].cost
    found: dict[int, list[int]] = {}
    now: dict[int, int] = {}

    def spend(line, operations):
        now[line] = now.get(line, 0) + operations
        return operations

    def roots(x, count):
        done = spend(5, 2)
        total = np.float32(x * x + x)
        for i in range(count):
            done += spend(7, floor + 2)
            total += np.floor(total * np.float32(1.25))
            done += spend(8, 1)
            if i > 6:
                done += spend(9, 1)
                return total - 1, done
        return total, done

    for pixel in range(width * height):
        now.clear()
        x, y = np.float32(pixel % width + 0.5), pixel // width + 0.5
        first, done = roots(x, int(y))
        spend(16, 2 + done)
        left = x
        spend(18, 2)
        while left * 2 > 7:
            spend(19, 1)
            left /= 2
            spend(18, 2)
        spend(20, 2)
        if first * x > 500:
            spend(20, 1 + 2 * 2 + roots(left, 2)[1] + roots(x, 1)[1])
        spend(22, 4)
        for line in range(1, 23):
            found.setdefault(line, []).append(now.get(line, 0))
    return {line: operations for line, operations in found.items() if any(operations)}


def test_work_is_runs_times_estimated_operations(tmp_path):
    found = counted(counting(seen_of(tmp_path, CALLS), "color", (FILE,), work=True), SIZE)
    expected = plain_work(*SIZE)
    for line, operations in expected.items():
        assert found[line].tolist() == operations, line
    # A conversion to int costs what the target needs for numbers out of range.
    assert found[15].min() == found[15].max() > 0
    assert {line for line, operations in found.items() if operations.any()} == {15, *expected}
    # What is the same for all pixels is computed once a frame.
    assert not found.get(21, np.zeros(1)).any()


def test_work_without_calls_is_a_multiple_of_runs(tmp_path):
    seen = seen_of(tmp_path, CALLS)
    runs, work = (counted(counting(seen, "color", (FILE,), work=w), SIZE) for w in (False, True))
    for line, operations in ((5, 2), (7, 2 + INTRINSICS["floor"].cost), (8, 1), (9, 1), (19, 1)):
        assert (work[line] == operations * runs[line]).all(), line


@pytest.mark.parametrize("work", [False, True], ids=["runs", "work"])
def test_a_program_of_counts_leaves_the_author_all_names(tmp_path, work):
    plain = counted(counting(seen_of(tmp_path, CALLS), "color", (FILE,), work=work), SIZE)
    text = CALLS.replace("first", "spend" if work else "run").replace("total", "work")
    text = text.replace("left", "inside").replace("speed", "enter")
    found = counted(counting(seen_of(tmp_path, text), "color", (FILE,), work=work), SIZE)
    assert {n: c.tolist() for n, c in found.items()} == {n: c.tolist() for n, c in plain.items()}


def test_a_program_of_time_leaves_the_author_all_names(tmp_path):
    text = CALLS.replace("first", "MEASURED_PLACE").replace("total", "Repeats")
    text = text.replace("left", "kept").replace("count", "rounds")
    times = timing(seen_of(tmp_path, text), "color", (FILE,))
    for number in range(len(times.places)):
        Repeated(times, number, SIZE).release()


@pytest.mark.parametrize("text", [CALLS, HEAVY])
def test_repetitions_leave_the_picture_as_it_is(tmp_path, text):
    times = timing(seen_of(tmp_path, text), "color", (FILE,))
    whole = Native(times.program, SIZE)
    picture = whole.pixels()
    assert len(np.unique(picture)) > 30
    for number, place in enumerate(times.places):
        repeated = Repeated(times, number, SIZE)
        for repeats in (1, 2, 9):
            for drawn in repeated.pixels(repeats):
                assert (drawn == picture).all(), (place, repeats)
        repeated.release()


def test_without_a_choice_the_text_repeats_nothing(tmp_path):
    """All that is added stands between the macros of a place that is not chosen."""
    times = timing(seen_of(tmp_path, HEAVY), "color", (FILE,))
    kept = re.sub(r"#if MEASURED_PLACE == \d+ \|\|.*?\n#else\n(.*?)#endif\n", r"\1",
                  nested(times.program["fragment"]), flags=re.DOTALL)  # fmt: skip
    assert "#if" not in kept and "rounds" not in kept
    assert kept.count("for (") == 1


def test_each_evaluation_reads_copies_that_a_round_could_replace(tmp_path):
    """A driver that moves what does not change out of a loop finds nothing that it could move."""
    times = timing(seen_of(tmp_path, HEAVY), "color", (FILE,))
    text = times.program["fragment"]
    pattern = (
        r"#if MEASURED_PLACE == \d+\n(\w+) = (.*?);\n(?:kept\w* \+= \1;\n#else\n.*?\n)?#endif\n"
        r"if \(round\w* \+ \d+ == Round_that_never_is\) \{\n(.*?)\}"
    )
    found = re.findall(pattern, text, flags=re.DOTALL)
    assert len(found) == sum(times.evaluations)
    for _, value, replaced in found:
        names = set(re.findall(r"\b[a-z]\w*\b(?!\()", re.sub(r"\.\w+", "", value)))
        assert names
        assert names == set(re.findall(r"(\w+) = (?:0|vec\d\(0)", replaced)) - {"kept"}, value


def nested(text):
    """Return a text without the macros inside of a place."""
    return re.sub(r"#if MEASURED_PLACE (?:== \d+|!= \d+)\n(.*?)#endif\n", "", text, flags=re.DOTALL)


def test_lines_that_compute_nothing_are_not_measured(tmp_path):
    times = timing(seen_of(tmp_path, CALLS), "color", (FILE,))
    lines = {line for _, line in times.places}
    assert lines == {5, 7, 8, 9, 15, 16, 18, 19, 20, 22}


def test_a_line_with_a_heavy_loop_takes_the_largest_part(tmp_path):
    frame, found = line_costs(seen_of(tmp_path, HEAVY), FILE)
    by_line = {cost.line: cost for cost in found}
    heavy = by_line[14]
    assert heavy.is_measured
    assert heavy.seconds == max(cost.seconds for cost in found)
    assert 0.5 * frame < heavy.seconds < 1.5 * frame, (frame, heavy)
    # The line inside the loop comes next; alone it may overlap with the loop around it.
    assert by_line[7].is_measured
    others = [cost.seconds for cost in found if cost.line not in (7, 14)]
    assert by_line[7].seconds > 2 * max(others)


@pytest.mark.parametrize("name", ["melting", "course_4_materials"])
def test_work_and_time_rank_lines_alike(name):
    """The condition under which the studio shows work (decision 58)."""
    path = gallery()[name]
    _, found = line_costs(viewable(load(path)), path.name)
    measured = [cost for cost in found if cost.is_measured]
    assert len(measured) >= 10
    assert rank_correlation(measured) >= 0.8


def rank_correlation(costs: list[LineCost]) -> float:
    return spearman([c.work for c in costs], [c.seconds for c in costs])


def test_the_rank_correlation_is_that_of_ranks():
    assert spearman([1, 2, 3, 4], [10, 20, 400, 500]) == pytest.approx(1)
    assert spearman([1, 2, 3, 4], [4, 3, 2, 1]) == pytest.approx(-1)
    # scipy.stats.spearmanr([1, 2, 2, 4], [1, 3, 2, 4]) is 0.9486832980505138.
    assert spearman([1, 2, 2, 4], [1, 3, 2, 4]) == pytest.approx(0.9486832980505138)
