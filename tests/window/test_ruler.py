"""The ruler of a window: clicks, what is drawn, what is said, and a real window with hands."""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import distal
from distal import Box, Camera, Plane, Scene, matte
from distal.cli.application import application
from distal.images.picture_files import read
from distal.scene.rerender import plan_rerender
from distal.scene.viewing.viewable import Viewable, viewable
from distal.window.keys import Action
from distal.window.overlay import Overlay
from distal.window.overlay_content import OverlayContent
from distal.window.panels import Panel, blended
from distal.window.ruler_panels import ruler_panels
from distal.window.ruler_tool import NEEDS_SOLID, ShownRuler
from distal.window.session import Session
from tests.window.display import Window

SIZE = (320, 240)
SCENE = """from distal import Box, Camera, Scene

scene = Scene(Box(4, 2, 3), camera=Camera((0, 0, 9), (0, 0, 0)), floor=False)
"""
LEFT = 1


def box() -> Viewable:
    camera = Camera((0, 0, 9), (0, 0, 0))
    return viewable(Scene(Box(4, 2, 3).paint(matte("#ffffff")), camera=camera, floor=False))


def click(session: Session, x: float, y: float) -> None:
    session.press(x, y, LEFT, 0.0)
    session.release(0.0)


def session_of(seen: Viewable, unit: str = "mm") -> Session:
    made = Session(seen, unit=unit)
    made.size = SIZE
    made.shot(0.0)
    return made


def test_two_clicks_make_a_ruler_and_a_third_starts_anew() -> None:
    session = session_of(box(), "cm")
    click(session, 160, 120)
    assert session.ruler.ends == ()  # clicks choose places only while the ruler is on
    session.act(Action.RULER, 0.0)
    assert session.ruler.hint == "ruler: click the first place"
    click(session, 160, 120)
    assert session.ruler.hint == "from (0, 0, 1.5), surface: click the second place"
    click(session, 2, 2)
    assert session.ruler.hint == "nothing is there; click a place on the shape"
    click(session, 200, 120)
    shown = session.ruler.shown(session.sight(0.0))
    assert shown.lines[0].endswith(" cm")
    assert shown.lines[1].endswith("Δy 0   Δz 0")
    a, b = session.ruler.ends
    length = float(shown.lines[0].removesuffix(" cm"))
    assert length == pytest.approx(math.dist(a.point, b.point), abs=1e-4)
    assert shown.places[0] == pytest.approx((0.5, 0.5), abs=1e-4)
    assert shown.places[-1] == pytest.approx((200 / 320, 0.5), abs=1e-3)
    click(session, 160, 120)
    assert len(session.ruler.ends) == 1
    session.act(Action.RULER, 0.0)
    assert (session.ruler.is_on, session.ruler.ends, session.ruler.hint) == (False, (), "")


def test_a_drag_turns_the_camera_and_the_ruler_stays_on_the_shape() -> None:
    session = session_of(box())
    session.act(Action.RULER, 0.0)
    click(session, 160, 120)
    session.press(160, 120, LEFT, 0.0)
    session.drag(162, 121, 0.0)  # a hand trembles
    assert session.steering.yaw == 0.0
    session.release(0.0)
    assert len(session.ruler.ends) == 2
    before = session.ruler.shown(session.sight(0.0))
    session.press(160, 120, LEFT, 0.0)
    session.drag(200, 120, 0.0)
    session.release(0.0)
    assert session.steering.yaw != 0.0
    ends = session.ruler.ends
    assert len(ends) == 2
    after = session.ruler.shown(session.sight(0.0))
    assert after.lines == before.lines
    assert after.places[0][0] > before.places[0][0] + 0.05
    session.double_click(160, 120, 0.0)
    assert session.steering.yaw != 0.0  # two clicks choose two places
    session.adopt(box(), 0.0, animated=False)
    assert session.ruler.ends == ends


def test_a_click_sees_through_the_cut() -> None:
    session = session_of(box())
    for _ in range(3):
        session.act(Action.SECTION, 0.0)  # along z, in the middle
    session.act(Action.RULER, 0.0)
    click(session, 160, 120)
    assert session.ruler.ends[0].point == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)


def test_keys_that_do_nothing_say_why(tmp_path: Path) -> None:
    def refusals(seen: Viewable) -> tuple[str, str]:
        session = session_of(seen)
        return session.refusal(Action.SECTION), session.refusal(Action.RULER)

    image = viewable(distal.load("example:raymarcher"))
    assert refusals(image) == (
        "only scenes and shapes can be cut open; an @image has no solid",
        NEEDS_SOLID,
    )
    hills = Viewable("hills", Scene(Box(2), march="heightfield"))
    assert refusals(hills) == ('a scene with march="heightfield" cannot be cut open', "")
    planes = Viewable("planes", Scene(Plane()))
    assert refusals(planes)[0] == "nothing to cut open: planes stay whole"
    session = session_of(box())
    assert session.refusal(Action.SECTION) == ""
    assert session.refusal(Action.SECTION_FORTH) == "press X first, which cuts the scene open"
    session.act(Action.SECTION, 0.0)
    assert session.refusal(Action.SECTION_FORTH) == ""
    assert session.refusal(Action.HELP) == ""
    image_session = session_of(image)
    image_session.act(Action.RULER, 0.0)
    assert not image_session.ruler.is_on


def test_an_unknown_unit_is_refused_before_a_window_opens() -> None:
    found = CliRunner().invoke(application, ["view", "example:enclosure", "--unit", "mile"])
    assert found.exit_code == 2
    assert "a unit is one of um, mm, cm, m, inch, ft, not 'mile'" in found.output


def drawn(ruler: ShownRuler, back: float, size: tuple[int, int] = SIZE) -> np.ndarray:
    picture = np.full((size[1], size[0], 4), back, np.float32)
    picture[..., 3] = 1.0
    return blended(picture, ruler_panels(ruler, size, 1.0))


@pytest.mark.parametrize("back", [0.0, 0.5, 1.0])
def test_line_and_label_stand_out_on_any_picture(back: float) -> None:
    ruler = ShownRuler(("surface", "corner"), ((0.1, 0.8), (0.9, 0.8)), ("12.5 mm", "Δx 1"))
    found = drawn(ruler, back)
    column = found[185:200, 160, :3].mean(axis=1)  # across the line at y = 192
    assert column.max() > 0.7
    assert column.min() < 0.1
    changed = np.abs(found[..., :3] - back).max(axis=2) > 0.2
    if back:  # the plate is dark
        plate = found[: 192 - 12, :, :3].max(axis=2) < 0.2
        assert plate.sum() > 1500
    assert changed[:, 160].sum() < 120


def test_panels_of_a_ruler_stay_on_the_window_and_are_few() -> None:
    places = tuple((0.5 + 40 * (i / 16 - 0.5), 0.2 + i / 20) for i in range(17))
    ruler = ShownRuler(("surface", "surface"), places, ("1 mm",))
    panels = Overlay().panels(OverlayContent(ruler=ruler), SIZE, 1.0)
    assert 1 < len(panels) < 14
    for panel in panels:
        assert panel.x >= 0 <= panel.y
        assert panel.x + panel.pixels.shape[1] <= SIZE[0]
        assert panel.y + panel.pixels.shape[0] <= SIZE[1]
    overlay = Overlay()
    same = [overlay.panels(OverlayContent(ruler=ruler), SIZE, 1.0) for _ in range(2)]
    assert all(a is b for a, b in zip(*same, strict=True))
    hidden = ShownRuler(("surface", "surface"), (None,) * 17, ("1 mm",))
    assert len(ruler_panels(hidden, SIZE, 1.0)) == 1  # the label alone


def test_panels_are_blended_by_their_alpha() -> None:
    picture = np.zeros((2, 2, 4), np.float32)
    picture[0, 0] = (1.0, 0.0, 0.0, 1.0)
    over = np.array([[[0, 255, 0, 51], [0, 255, 0, 51]]], np.uint8)
    found = blended(picture, [Panel(0, 0, over)])
    assert found[0, 0] == pytest.approx((0.8, 0.2, 0.0, 1.0), abs=1e-6)
    assert found[0, 1] == pytest.approx((0.0, 1.0, 0.0, 0.2), abs=1e-6)
    assert not found[1].any()


def test_hands_measure_a_box_in_a_window(display: str, tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    arguments = ["scene.py", "--device", "cpu", "--size", "320x240", "--unit", "cm"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        plain = window.settled()
        window.hands("mousemove", 160, 120, "key", "d", "click", 1)
        window.wait(lambda e: "second place" in e.get("hint", ""))
        count = len(window.events)
        # Near the right edge of the front face, at x = 2.
        right = 160 + round(2.0 / (7.5 * math.tan(math.radians(20))) * 120) - 3
        window.hands("mousemove", right, 120, "click", 1)
        lines = window.wait(lambda e: e.get("ruler"), count)["ruler"]
        assert lines[0] == "2 cm"
        assert lines[3].startswith("to (2, 0, 1.5), edge")
        assert window.settled()["steering"] == plain["steering"]
        seen = window.screenshot(SIZE)
        row = seen[118:123, 190]
        assert (row[:, 0] - row[:, 2]).max() > 0.5  # the yellow line
        window.hands("key", "s")
        saved = Path(window.wait(lambda e: e["event"] == "saved")["path"])
        picture = np.asarray(Image.open(saved))[118:123, 190, :3].astype(float) / 255
        assert (picture[:, 0] - picture[:, 2]).max() > 0.5
        ends = read(saved).provenance.ruler
        assert ends[1] == pytest.approx((2.0, 0.0, 1.5), abs=1e-4)
        source = f"{tmp_path / 'scene.py'}"
        notes = plan_rerender(saved, source=source).notes
        assert notes == (f"the ruler that is drawn over {saved} is not rendered again",)
        window.hands("key", "Escape")
        assert window.wait(lambda e: e.get("ruler") == [], count + 1)
        count = len(window.events)
        window.hands("key", "Escape")
        assert window.process.wait(10) == 0


def test_a_window_says_why_a_picture_is_not_cut(display: str, tmp_path: Path) -> None:
    arguments = ["example:raymarcher", "--device", "cpu", "--size", "320x240", "--paused"]
    with Window(display, arguments, tmp_path) as window:
        window.sharp()
        window.hands("mousemove", 160, 110, "key", "x")
        found = window.wait(lambda e: e["event"] == "refused")
        assert found["text"] == "only scenes and shapes can be cut open; an @image has no solid"
