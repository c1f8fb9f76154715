"""The grammar of SVG paths and their arcs, against an evaluator written for this test."""

from __future__ import annotations

import cmath
import math
import random

import numpy as np
import pytest

from distal import CompileError, SvgPath

pytest.importorskip("fontTools")

GRID = np.stack(np.meshgrid(np.linspace(-9, 9, 43), np.linspace(-9, 9, 43)), -1).reshape(-1, 2)


def arc_points(start, rx, ry, degrees, large, sweep, end) -> list[complex]:
    """Points of an arc, by the equations of SVG 1.1, F.6.5 and F.6.6."""
    if start == end:
        return []
    if rx == 0 or ry == 0:
        return [end]
    rx, ry, turn = abs(rx), abs(ry), cmath.exp(1j * math.radians(degrees))
    half = (start - end) / 2 / turn
    x, y = half.real, half.imag
    enlarged = max(1.0, math.hypot(x / rx, y / ry))
    rx, ry = rx * enlarged, ry * enlarged
    rest = max((rx * ry) ** 2 - (rx * y) ** 2 - (ry * x) ** 2, 0.0)
    c = math.sqrt(rest / ((rx * y) ** 2 + (ry * x) ** 2)) * (1 if large != sweep else -1)
    center = complex(c * rx * y / ry, -c * ry * x / rx)
    first, last = (
        math.atan2((p.imag - center.imag) / ry, (p.real - center.real) / rx) for p in (half, -half)
    )
    way = (last - first) % math.tau
    way = way if sweep else way - math.tau
    ts = np.linspace(first, first + way, 200)[1:]
    middle = (start + end) / 2
    places = [middle + turn * (center + complex(rx * math.cos(t), ry * math.sin(t))) for t in ts]
    return [*places[:-1], end]


def written(value: float, rng: random.Random) -> str:
    """Write a number in one of the grammar's ways."""
    ways = [f"{value:g}", f"{value:.2e}", f"{value:+g}"]
    if 0 < abs(value) < 1:
        ways.append(f"{value:g}".replace("0.", ".", 1))
    if value == int(value):
        ways += [f"{int(value)}.", f"{int(value):03d}"]
    return rng.choice(ways)


def joined(words: list[str], rng: random.Random) -> str:
    """Join numbers with as little between them as the grammar allows, now and then with more."""
    text = ""
    for word in words:
        is_apart = word[0] in "+-" and rng.random() < 0.5
        separators = [" ", ",", " , ", "\n"] if text else [" ", "", "\n"]
        text += word if is_apart else rng.choice(separators) + word
    return text


def path_of(rng: random.Random) -> tuple[str, list[list[complex]]]:
    """Return a random path, and the closed chains of points that it stands for."""
    at = complex(rng.randint(-6, 6), rng.randint(-6, 6))
    text, chains = f"M{at.real:g} {at.imag:g}", [[at]]
    for _ in range(rng.randint(3, 9)):
        end = complex(rng.randint(-16, 16), rng.randint(-16, 16)) / 2
        here = chains[-1][-1]
        relative = rng.random() < 0.5
        shown = end - here if relative else end
        letter = rng.choice("LLHVAAAAZ")
        if letter == "Z":
            text += rng.choice("Zz") + " "
            chains.append([chains[-1][0]])
            continue
        if letter == "H":
            end, numbers = complex(end.real, here.imag), [shown.real]
        elif letter == "V":
            end, numbers = complex(here.real, end.imag), [shown.imag]
        else:
            numbers = [shown.real, shown.imag]
        added = [end]
        words = [written(n, rng) for n in numbers]
        if letter == "A":
            rx, ry = rng.choice([(0, 3), (4, 0), (1, 1), (2, 5), (-6, 4), (8, 8)])
            turn, large, sweep = rng.choice([0, 30, -75, 200]), rng.randint(0, 1), rng.randint(0, 1)
            added = arc_points(here, rx, ry, turn, large, sweep, end)
            flags = rng.choice([f"{large}{sweep}", f"{large},{sweep} ", f"{large} {sweep}"])
            text += "a" if relative else "A"
            text += joined([f"{rx}", f"{ry}", f"{turn}"], rng) + " " + flags + words[0]
            text += "," + joined(words[1:], rng)
        else:
            text += (letter.lower() if relative else letter) + joined(words, rng)
        chains[-1] += added
    return text, chains


def windings(chains: list[list[complex]]) -> np.ndarray:
    """Return how often the chains run around each place of the grid."""
    found = np.zeros(len(GRID))
    places = GRID[:, 0] + 1j * GRID[:, 1] + (1e-7 + 2e-7j)  # on no corner
    for chain in chains:
        ring = np.array([*chain, chain[0]])
        around = np.angle((ring[None, 1:] - places[:, None]) / (ring[None, :-1] - places[:, None]))
        found += np.round(np.nan_to_num(around).sum(axis=1) / math.tau)
    return found


@pytest.mark.parametrize("seed", range(40))
def test_random_paths_enclose_what_the_specification_says(seed):
    rng = random.Random(seed)
    text, chains = path_of(rng)
    points = np.array([p for chain in chains for p in chain])
    if np.ptp(points.real) == 0 or np.ptp(points.imag) == 0:
        pytest.skip("the random path is a line")
    frame = "M-60-60h.001v.001zM60 60h-.001v-.001z"  # keeps the middle of the box at the origin
    values = SvgPath(text + frame, even_odd=True)(GRID * (1, -1))
    inside = windings(chains) % 2 != 0
    clear = np.abs(values) > 0.1
    assert clear.mean() > 0.5, text
    assert ((values < 0) == inside)[clear].mean() > 0.999, text


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("M0 0 A0 5 0 0 1 10 0 L10 10 L0 10 Z", "M0 0H10V10H0Z"),
        ("M0 0a0,0,0,0,1,10,0v10h-10z", "M0 0H10V10H0Z"),
        ("M0 0A5 5 0 0 1 0 0H10V10H0Z", "M0 0H10V10H0Z"),
        ("M0 0 10 0 10 10 0 10", "M0 0H10V10H0Z"),
        ("m1 1 9 0 0 9-9 0z", "M0 0H9V9H0Z"),
        ("M.5.5H1e1V+10.L.5,1E+1z", "M.5 .5L10 .5L10 10L.5 10"),
        ("M0 0h4v4h-4zl-4 0v-4h4", "M0 0h4v4h-4zM0 0l-4 0v-4h4z"),
        ("M0 0a1 1 0 01 8 0 1 1 0 018 0V9H0Z", "M0 0A4 4 0 0 1 8 0A4 4 0 0 1 16 0V9H0Z"),
    ],
)
def test_ways_of_writing_the_same_path(text, same):
    assert np.abs(SvgPath(text)(GRID) - SvgPath(same)(GRID)).max() < 1e-5


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("M0 0 L10 0 10 10 x", "it has no command at character 18, 'x'"),
        ("M0 0 10 0 e 10 10", "it has no command at character 11, 'e 10 10'"),
        ("M0 0 L10", "'L' takes 2 numbers, and a number is missing at its end"),
        ("M0 0 L1 1 5", "'L' takes 2 numbers, and a number is missing at its end"),
        (
            "M0 0A1 1 0 2 0 3 3",
            "'A' takes 7 numbers, and the flag 0 or 1 is missing at character 12, '2 0 3 3'",
        ),
        ("M0 0,L1 1", "no number follows the comma at character 5, ',L1 1'"),
        ("M0 0 z 5 5", "it has no command at character 8, '5 5'"),
        ("M1 2 L3 \N{ARABIC-INDIC DIGIT FOUR}", "'L' takes 2 numbers, and a number is missing"),
    ],
)
def test_what_is_no_path_is_said_with_its_place(text, message):
    with pytest.raises(CompileError) as error:
        SvgPath(text)
    assert f"this SVG path cannot be read: {message}" in str(error.value)
