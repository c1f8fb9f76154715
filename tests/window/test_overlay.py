"""What is drawn over the picture, as pixels."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.window import lettering, overlay
from distal.window.layout import Table, time_track
from distal.window.lettering import plain_font, shortened, shortened_inside, width
from distal.window.overlay import Overlay, Panel
from distal.window.overlay_content import OverlayContent, ParameterRow

ROWS = (
    ParameterRow("Softness", "0.054", 0.27, is_moved=True),
    ParameterRow("Paint r", "0.5", 0.5, is_moved=False),
    ParameterRow("Spot x", "-1.25", None, is_moved=False),
    ParameterRow(
        "A label that is far too long for its column", "a long choice's name", 1.0, is_moved=False
    ),
)
MISTAKE = """error: there is no function 'lenght'
  --> scene.py:12:12
   |
12 |     return lenght(p) - 1.0
   |            ^^^^^^
   = hint: did you mean 'length'?"""
FULL = OverlayContent(
    status="raymarcher   color   60 fps   12.3 ms   640x480   cpu",
    rows=ROWS,
    chosen=1,
    time=(3.25, 0.0, 10.0),
    trouble=MISTAKE,
    help=True,
    note="saved raymarcher-3.25s.png",
)


def composed(panels: list[Panel], size: tuple[int, int]) -> NDArray[np.float64]:
    """The panels over middle grey, (height, width, 3), 0 to 255."""
    whole = np.full((size[1], size[0], 3), 128.0)
    for panel in panels:
        height, wide = panel.pixels.shape[:2]
        part = whole[panel.y : panel.y + height, panel.x : panel.x + wide]
        assert part.shape == (height, wide, 3), "a panel reaches beyond the window"
        alpha = panel.pixels[..., 3:].astype(float) / 255
        part[:] = part * (1 - alpha) + panel.pixels[..., :3] * alpha
    return whole


@pytest.mark.parametrize("ratio", [1.0, 1.25, 2.0])
@pytest.mark.parametrize("size", [(640, 480), (1280, 960), (300, 200), (120, 90), (16, 16)])
def test_panels_stay_on_the_window(size: tuple[int, int], ratio: float) -> None:
    composed(Overlay().panels(FULL, size, ratio), size)


def test_what_says_the_same_is_the_same_panel() -> None:
    drawn = Overlay()
    first = drawn.panels(FULL, (640, 480), 1.0)
    again = drawn.panels(replace(FULL, time=(3.5, 0.0, 10.0)), (640, 480), 1.0)
    assert [a is b for a, b in zip(first, again, strict=True)].count(False) == 1
    resized = drawn.panels(FULL, (800, 480), 1.0)
    assert not any(a is b for a, b in zip(first, resized, strict=True))
    assert drawn.panels(OverlayContent(), (640, 480), 1.0) == []


@pytest.mark.parametrize("ratio", [1, 2])
def test_bars_end_where_the_pointer_finds_them(ratio: int) -> None:
    size = (640 * ratio, 480 * ratio)
    read = OverlayContent(rows=ROWS, chosen=0, time=(2.5, 0.0, 10.0))
    picture = composed(Overlay().panels(read, size, ratio), size)
    table = Table.of(640, 480, len(ROWS), 0)
    ends = [(table.track(n), row.share) for n, row in enumerate(ROWS) if row.share is not None]
    for track, share in [*ends, (time_track(640, 480), 0.25)]:
        assert share is not None
        line = picture[round((track.y + track.height / 2) * ratio)]
        blue = line[:, 2] - line[:, 0] > 60  # the filled part
        found = np.flatnonzero(blue[: round((track.x + track.width + 1) * ratio)])
        left = round(track.x * ratio)
        # The dot hides the last pixels of the filled part.
        end = left + share * track.width * ratio
        assert abs(found[0] - left) <= 2 * ratio
        assert end - 7 * ratio <= found[-1] <= end + ratio


def marks(picture: NDArray[np.float64], rows: slice) -> NDArray[np.intp]:
    """The columns with light pixels in some rows."""
    return np.flatnonzero((picture[rows].min(axis=2) > 150).any(axis=0))


@pytest.mark.parametrize("has_fixed_font", [True, False])
def test_a_caret_stands_under_what_it_means(
    monkeypatch: pytest.MonkeyPatch, has_fixed_font: bool
) -> None:
    if not has_fixed_font:
        monkeypatch.setattr(overlay, "fixed_font", lettering.plain_font)
    lines = ["12 |     ######     after", "   |     ^^^^^^"]
    (panel,) = Overlay().panels(OverlayContent(trouble="\n".join(lines)), (640, 480), 1.0)
    pixels = panel.pixels[..., :3].astype(float)
    line = round(13 * 1.45)
    source = marks(pixels, slice(12, 12 + line))
    carets = marks(pixels, slice(12 + line, 12 + 2 * line))
    cell = width(overlay.fixed_font(13), "M")
    begin = 12 + 9 * cell
    for columns in (source, carets):
        inside = columns[(columns > begin - 2) & (columns < begin + 6 * cell + 2)]
        assert abs(inside[0] - begin) < cell / 2
        assert abs(inside[-1] - (begin + 6 * cell)) < cell / 2


def test_a_long_line_moves_until_its_caret_is_seen() -> None:
    source = " 4 | scene = Scene(thing(, camera=Camera(position=(0, 1, 4), target=(0, 0, 0)))"
    for column in (5, 20, 60, 74):
        caret = "   | " + " " * (column - 5) + "^"
        shown, below = overlay._fitted([source, caret], 40)
        assert max(len(shown), len(below)) <= 40
        assert below.rstrip().endswith("^")
        assert shown[below.index("^")] == source[column]
    assert overlay._fitted(["x" * 25], 10) == ["x" * 10, "x" * 10, "x" * 5]
    assert overlay._fitted([source], 200) == [source]


def test_words_go_on_below_whole() -> None:
    told = ["error: it left while it was loaded", "   |", ""]
    assert overlay._fitted(told, 26) == ["error: it left while it", "was loaded", "   |", ""]


def test_a_mistake_of_many_lines_is_cut_with_a_sign() -> None:
    text = "\n".join(f"line {n}" for n in range(200))
    panels = Overlay().panels(OverlayContent(trouble=text), (400, 300), 1.0)
    composed(panels, (400, 300))


def test_words_are_shortened_to_their_room() -> None:
    font = plain_font(13)
    assert shortened(font, "short", 500.0) == "short"
    cut = shortened(font, "a label that is far too long", 60.0)
    assert cut.endswith("…")
    assert width(font, cut) <= 60.0


def test_names_of_one_family_stay_apart() -> None:
    font = plain_font(13)
    names = [shortened_inside(font, f"Parameter number {i:02d}", 90.0) for i in range(40)]
    assert len(set(names)) == 40
    assert all("…" in name and width(font, name) <= 90.0 for name in names)
    assert shortened_inside(font, "Parameter number 07", 500.0) == "Parameter number 07"
    assert width(font, shortened_inside(font, "Parameter", 20.0)) <= 20.0


def test_rows_that_are_not_shown_are_marked() -> None:
    """A mark at the right edge stands as far down as the rows stand among all."""

    def mark(count: int, chosen: int) -> NDArray[np.intp]:
        rows = tuple(ParameterRow(f"row {i}", "1", None, is_moved=False) for i in range(count))
        (panel,) = Overlay().panels(OverlayContent(rows=rows, chosen=chosen), (640, 480), 1.0)
        return np.flatnonzero(panel.pixels[:, -2, :3].min(axis=1) > 100)

    assert mark(5, 0).size == 0
    first, last = mark(40, 0), mark(40, 39)
    table = Table.of(640, 480, 40, 0)
    assert abs(first.size / (table.frame.height - 16) - table.count / 40) < 0.02
    assert first[0] == 8
    assert last[-1] == int(table.frame.height) - 9


@pytest.mark.parametrize("size", [(120, 90), (300, 200), (640, 480)])
def test_lines_of_help_never_lie_over_each_other(size: tuple[int, int]) -> None:
    (panel,) = Overlay().panels(OverlayContent(help=True), size, 1.0)
    accent = (np.abs(panel.pixels[..., :3].astype(int) - overlay._ACCENT[:3]) < 40).all(axis=2)
    lines = np.flatnonzero(np.diff(accent.any(axis=1).astype(int)) == 1).size
    assert lines >= min(len(overlay.HELP), int((size[1] - 20) // 21))


def test_a_swatch_shows_the_color_beside_its_components() -> None:
    color = (208, 112, 64)
    rows = tuple(
        ParameterRow(f"Tint {name}", "1", 0.5, is_moved=False, swatch=color) for name in "rgb"
    )
    read = OverlayContent(rows=(*rows, ROWS[0]))
    picture = composed(Overlay().panels(read, (640, 480), 1.0), (640, 480))
    table = Table.of(640, 480, 4, 0)
    shown = (picture == color).all(axis=2)
    first, last = table.row(0), table.row(2)
    assert shown.sum() == 14 * (3 * first.height - 8)
    down, across = np.nonzero(shown)
    assert first.y + 4 == down.min() and down.max() == last.y + last.height - 5
    assert across.max() < table.track(0).x
