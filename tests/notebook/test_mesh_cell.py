"""A mesh in a notebook's cell: what is packed, where it is seen, how it is lit, how it turns."""

from __future__ import annotations

import base64
import html
import io
import json
import math
import re
import time
import zlib
from contextlib import contextmanager

import numpy as np
import pytest
from PIL import Image

from distal import Box, Cylinder, DistantLight, HemisphereLight, OrbitCamera, Scene, Sphere, matte
from distal.lang import func, length, sin, vec2, vec3, vec4
from distal.mesh import preview_arithmetic
from distal.mesh.files.parts import display_codes
from distal.mesh.files.shading import corner_normals
from distal.mesh.kernels import rows_of
from distal.mesh.preview import fewer, preview_of
from distal.mesh.preview_arithmetic import AZIMUTH, ELEVATION, LOOK, OPENING, UP, seen_corner
from distal.mesh.solid import Mesh
from distal.notebook.mesh_cell import html_of
from distal.render.camera import orbit
from distal.render.steer import Steer, lens, rig, steered_ray
from tests.browser import BrowserUnavailableError, browser, offline_page

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
ORANGE = np.array([0xD0, 0x70, 0x40]) / 255.0
CORNERS = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]])


def unpacked(content):
    """What the viewer reads: places, normals, codes and triangles."""
    plain = zlib.decompress(base64.b64decode(content["data"]), -zlib.MAX_WBITS)
    at = 0

    def column(count, kind):
        nonlocal at
        width = np.dtype(kind).itemsize
        planes = np.frombuffer(plain, np.uint8, count * width, at).reshape(width, count)
        at += count * width
        changes = sum(
            planes[byte].astype(np.uint64) << np.uint64(8 * byte) for byte in range(width)
        )
        return np.cumsum(changes, dtype=np.uint64).astype(f"u{width}").view(kind)

    n = content["points"]
    found = [np.stack([column(n, kind) for _ in range(3)], 1) for kind in ("u2", "i1", "u1")]
    triangles = column(3 * content["triangles"], "u4").reshape(-1, 3)
    assert at == len(plain)
    return *found, triangles


def test_what_is_packed_is_the_mesh():
    made = (Box(4.0, 2.0, 1.0).round(0.1) - Cylinder(0.3, 3.0)).translate(5.0, -2.0, 1.0).mesh()
    found = preview_of(made)
    places, normals, _, triangles = unpacked(found.content)
    assert (found.triangles, found.shown) == (len(made.triangles), len(made.triangles))
    assert found.size == pytest.approx((4.2, 2.2, 1.2), abs=1e-6)
    low = np.array(made.bounds[0])
    side = max(found.size)
    shown = low + places[triangles] * side / 65535.0
    assert np.abs(shown - made.points[made.triangles]).max() <= 0.5001 * side / 65535.0
    lengths = np.linalg.norm(normals / 127.0, axis=1)
    assert np.abs(lengths - 1.0).max() < 0.01
    # A point has 12 bytes, a triangle too; the characters of base64 have 6 bits.
    plain = 12 * (len(places) + len(triangles)) * 8 / 6
    assert len(found.content["data"]) < 0.5 * plain


def test_faces_of_a_box_have_their_own_normals():
    made = Box(2.0, 1.0, 0.5).mesh()
    _, normals, codes, triangles = unpacked(preview_of(made).content)
    a, b, c = (made.points[made.triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    assert np.abs(normals[triangles] / 127.0 - faces[:, None]).max() < 1e-6
    # Without paint, the color of the look.
    assert (codes == display_codes(np.array([preview_arithmetic.MATERIAL]))).all()


def test_a_smooth_surface_keeps_the_normals_of_its_points():
    made = Sphere(1.0).mesh()
    found = corner_normals(made.points, made.triangles, made.normals)
    assert (found == made.normals[made.triangles]).all()


def test_the_rim_of_a_cylinder_is_an_edge_and_its_side_is_round():
    made = Cylinder(1.0, 1.0).mesh(tolerance=0.001)
    for normals in (made.normals, None):
        found = corner_normals(made.points, made.triangles, normals).reshape(-1, 3)
        caps = np.abs(found[:, 1]) > 0.9
        assert np.abs(found[caps][:, 1]).min() > 0.999
        side, points = found[~caps], made.points[made.triangles.reshape(-1)][~caps]
        radial = points * (1.0, 0.0, 1.0)
        radial /= np.linalg.norm(radial, axis=1, keepdims=True)
        # Of triangles alone, means: within the angle of a cell.
        assert (side * radial).sum(axis=1).min() > (0.99 if normals is None else 0.995)


def test_a_point_with_many_triangles_does_not_take_its_square():
    count = 20_000
    turn = np.arange(count) * (2.0 * math.pi / count)
    ring = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
    points = np.concatenate([[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], ring])
    one = np.arange(count) + 2
    other = np.roll(one, -1)
    above = np.stack([0 * one, one, other], axis=1)
    triangles = np.concatenate([above, np.stack([0 * one + 1, other, one], axis=1)])
    found = corner_normals(points, triangles, None)
    assert np.abs(np.linalg.norm(found, axis=2) - 1.0).max() < 1e-9
    assert (found[:count, :, 2] > 0.7).all() and (found[count:, :, 2] < -0.7).all()


def test_colors_of_triangles_stay_sharp():
    made = (Sphere(1.0).paint("#ff0000") & Box(4.0).paint("#0000ff").translate(x=2.0)).mesh()
    _, _, codes, triangles = unpacked(preview_of(made).content)
    expected = display_codes(made.triangle_colors)
    assert len(np.unique(expected, axis=0)) > 1
    assert (codes[triangles] == expected[:, None]).all()


def test_a_large_mesh_is_shown_with_fewer_triangles_and_says_so():
    made = Sphere(1.0).mesh(tolerance=0.0005)
    most = len(made.triangles) // 4
    kept, of = fewer(0.5 + 0.5 * made.points, made.triangles, most)
    assert 0.4 * most < len(kept) <= most
    assert len(of) == len(kept)
    # Few, but the same ball: its volume within 2 %.
    a, b, c = (made.points[kept[:, i]] for i in range(3))
    volume = (a * np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(4.0 / 3.0 * math.pi, rel=0.02)
    shown, count = html_of(made, most), preview_of(made, most).shown
    assert 0.4 * most < count <= most
    assert f"sphere: {len(made.triangles):,} triangles, 2 x 2 x 2" in shown.lower()
    assert f"Shown with {count:,} triangles, since it is large" in shown
    assert "Shown with" not in html_of(made)


@pytest.mark.parametrize(
    "made",
    [
        Mesh(np.zeros((0, 3)), np.zeros((0, 3))),
        Mesh(CORNERS * math.nan, TETRAHEDRON),
        Mesh(CORNERS * 1e300, TETRAHEDRON),
        Mesh(CORNERS * 0.0, TETRAHEDRON),
    ],
    ids=["empty", "no numbers", "too large", "a point"],
)
def test_what_cannot_be_shown_is_its_text(made):
    assert made._repr_html_() is None
    assert repr(made).startswith("<Mesh 'shape': ")


def test_no_name_leaves_its_place():
    name = '</script><b title="x">&'
    shown = Mesh(CORNERS, TETRAHEDRON, name=name)._repr_html_()
    assert re.fullmatch(r"<iframe [^<>]*></iframe>", shown)
    inside = html.unescape(re.search(r'srcdoc="([^"]*)"', shown)[1])
    assert name not in inside
    assert f"<p>{html.escape(name)}: 4 triangles, 3 x 2 x 1</p>" in inside
    content = json.loads(re.search(r'distal\+json">(.*?)</script>', inside)[1])
    assert content["description"].startswith(f"The mesh '{name}', which can be turned")


@func
def point_at(
    uv: vec2, way: float, size: vec3, yaw: float, pitch: float, zoom: float, pan: vec2
) -> vec3:
    """A point on a ray of the library's own camera, moved as a person moved it."""
    middle = 0.5 * size
    away = length(middle) / sin(0.5 * OPENING)
    still = lens(lambda at: orbit(at, away, AZIMUTH, ELEVATION, middle, OPENING), middle, UP)
    moved = rig(still, Steer(yaw, pitch, zoom, pan))
    ray = steered_ray(uv, lambda at: orbit(at, away, AZIMUTH, ELEVATION, middle, OPENING), moved)
    return ray.origin + ray.direction * (way * away)


@func
def place_of(
    p: vec3, size: vec3, yaw: float, pitch: float, zoom: float, pan: vec2, aspect: float
) -> vec4:
    """Where a point is seen."""
    return seen_corner(p, UP, size, yaw, pitch, zoom, pan, aspect).place


def random_views(count, seed=1):
    drawn = np.random.default_rng(seed)
    size = drawn.uniform(0.01, 1.0, (count, 3))
    size[np.arange(count), drawn.integers(0, 3, count)] = 1.0
    yaw, pitch = drawn.uniform(-3.0, 3.0, count), drawn.uniform(-1.2, 1.2, count)
    zoom, pan = np.exp(drawn.uniform(-1.0, 1.0, count)), drawn.uniform(-1.0, 1.0, (count, 2))
    return drawn, (size, yaw, pitch, zoom, pan)


def test_a_corner_is_seen_where_the_camera_of_scenes_sees_it():
    drawn, (size, *moved) = random_views(400)
    uv, way = drawn.uniform(-1.0, 1.0, (400, 2)), drawn.uniform(0.3, 2.0, 400)
    points = rows_of(point_at, uv, way, size, *moved)
    aspect = drawn.uniform(1.0, 3.0, 400)
    place = rows_of(place_of, points, size, *moved, aspect)
    assert (place[:, 3] > 0.0).all()
    assert place[:, 0] / place[:, 3] * aspect == pytest.approx(uv[:, 0], abs=1e-9)
    assert place[:, 1] / place[:, 3] == pytest.approx(uv[:, 1], abs=1e-9)


@pytest.mark.parametrize("aspect", [0.4, 1.0, 2.5])
def test_no_turn_moves_a_corner_out_of_the_picture(aspect):
    drawn, (size, yaw, pitch, _, _) = random_views(2000)
    corners = size * drawn.integers(0, 2, (2000, 3))
    still = np.ones(2000), np.zeros((2000, 2)), np.full(2000, aspect)
    place = rows_of(place_of, corners, size, yaw, pitch, *still)
    seen = np.abs(place[:, :3] / place[:, 3:])
    assert seen.max() <= 1.0
    # The picture is filled: some corner of some box is close to its border.
    assert seen[:, 0 if aspect < 1.0 else 1].max() > 0.9


def test_light_turns_with_the_camera():
    at = rows_of(normal_of, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([0.7, 0.7]))
    assert at[0] == pytest.approx([math.cos(0.7), 0.0, math.sin(0.7)])
    assert at[1] == pytest.approx([0.0, 1.0, 0.0])


@func
def normal_of(n: vec3, yaw: float) -> vec3:
    """The normal that is lit."""
    return seen_corner(vec3(0.5), n, vec3(1.0), yaw, 0.3, 1.0, vec2(0.0), 1.5).normal


@pytest.mark.parametrize("turned", [0.0, 2.0, 4.0])
def test_a_surface_is_lit_as_the_look_lights_it(turned):
    numbers = LOOK.numbers
    azimuth, up = numbers["azimuth"] + turned, numbers["elevation"]

    def lamp(which):
        level = math.cos(numbers[f"{which}_elevation"])
        angle = numbers["azimuth"] + numbers[f"{which}_azimuth"]
        height = math.sin(numbers[f"{which}_elevation"])
        to = (math.sin(angle) * level, height, math.cos(angle) * level)
        return DistantLight(to, numbers[f"{which}_intensity"], color=numbers[f"{which}_color"])

    fill = HemisphereLight(numbers["sky"], numbers["ground"], numbers["fill"])
    scene = Scene(
        Sphere(1.0).paint(matte("#d07040")),
        camera=OrbitCamera(6.0, azimuth, up),
        lights=[lamp("light"), lamp("rim"), fill],
        tone_map=LOOK.tone_map,
        exposure=numbers["exposure"],
        ambient_occlusion=0.0,
        background=(0.0, 0.0, 0.0),
    )
    picture = scene.render((33, 33), samples=1).array[16, 16, :3]
    level = math.cos(up)
    normal = [math.sin(azimuth) * level, math.sin(up), math.cos(azimuth) * level]
    found = rows_of(preview_arithmetic.seen_color, np.array([normal]), np.array([ORANGE]))
    assert found[0, :3] == pytest.approx(picture, abs=2e-3)


@pytest.fixture(scope="module")
def running():
    try:
        return browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


# With much space below, as in a long notebook.
PAGE = (
    '<!doctype html><meta charset="utf-8"><body style="margin:0">{}'
    '<div style="height:4000px"></div>'
)
VIEWER = "document.querySelector('[data-distal]').distal"


class Cell:
    """A notebook with a mesh."""

    def __init__(self, watched, turning):
        self.page = watched.page
        self.page.wait_for_function("frames.length === 1")
        self.frame = self.page.frames[1]
        # The frame may be told late that less motion is asked for.
        self.wait(f"{VIEWER}?.frames > 0 && {VIEWER}.turning === {str(turning).lower()}")

    def wait(self, condition):
        # A frame that nobody sees gets no frames to wait for.
        end = time.monotonic() + 20.0
        while not self.frame.evaluate(condition):
            assert time.monotonic() < end, condition
            self.page.wait_for_timeout(30)

    def state(self):
        return self.frame.evaluate(
            f"(() => {{ const {{frames, turning, steering}} = {VIEWER};"
            " return {frames, turning, ...steering}; })()"
        )

    def pixels(self):
        """The canvas as the page shows it, (height, width, 3)."""
        box = self.page.locator("iframe").bounding_box()
        caption = self.frame.evaluate(
            "document.body.lastElementChild.previousElementSibling.getBoundingClientRect().top"
        )
        picture = self.page.screenshot(clip={**box, "height": math.floor(caption)})
        return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"))


@contextmanager
def cell(tmp_path, made, **options):
    path = tmp_path / "notebook.html"
    path.write_text(PAGE.format(made._repr_html_()), encoding="utf-8")
    with offline_page(path, viewport={"width": 660, "height": 440}, **options) as watched:
        yield Cell(watched, turning="reduced_motion" not in options)
        watched.settle()
        assert watched.complaints == []
        assert watched.requests == []


def test_a_ball_has_its_outline_and_its_color(running, tmp_path):
    made = Sphere(1.0).paint("#d07040").mesh()
    with cell(tmp_path, made, reduced_motion="reduce", color_scheme="light") as shown:
        pixels = shown.pixels().astype(int)
    height, width = pixels.shape[:2]
    background = pixels[20, 20]
    ball = np.abs(pixels - background).sum(axis=2) > 60  # the corners of the frame are white
    # The ball around the box touches the picture's border; the mesh's is 1 / sqrt(3) of it.
    half = 0.5 * preview_arithmetic.OPENING
    radius = math.tan(math.asin(math.sin(half) / math.sqrt(3.0))) / math.tan(half) * 0.5 * height
    for axis in (0, 1):
        across = np.flatnonzero(ball.any(axis=axis))
        assert across[-1] - across[0] + 1 == pytest.approx(2.0 * radius, abs=2.0)
        assert across[-1] + across[0] + 1 == pytest.approx(pixels.shape[1 - axis], abs=2.0)
    # In the middle it faces the eye.
    azimuth, up = preview_arithmetic.AZIMUTH, preview_arithmetic.ELEVATION
    level = math.cos(up)
    normal = [math.sin(azimuth) * level, math.sin(up), math.cos(azimuth) * level]
    expected = rows_of(preview_arithmetic.seen_color, np.array([normal]), np.array([ORANGE]))
    assert np.abs(pixels[height // 2, width // 2] - 255.0 * expected[0, :3]).max() <= 3.0


def test_it_turns_until_it_is_touched(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh()) as shown:
        shown.wait(f"{VIEWER}.steering.yaw < -0.05")
        assert shown.state()["turning"]
        shown.page.mouse.move(300, 200)
        shown.page.mouse.down()
        held = shown.state()
        assert not held["turning"] and held["pitch"] == 0.0
        shown.page.mouse.move(300, 260, steps=3)
        shown.page.mouse.up()
        moved = shown.state()
        assert moved["pitch"] > 0.3 and moved["yaw"] == held["yaw"]
        shown.page.wait_for_timeout(200)
        rest = shown.state()
        shown.page.wait_for_timeout(200)
        # Nothing moves, so nothing is drawn.
        assert shown.state() == rest


def test_keys_turn_it_and_stay_in_the_frame(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh(), reduced_motion="reduce") as shown:
        shown.page.locator("iframe").content_frame.locator("canvas").focus()
        before = shown.state()["yaw"]
        shown.page.keyboard.press("ArrowRight")
        assert shown.state()["yaw"] > before + 0.1
        shown.page.keyboard.press("+")
        assert shown.state()["zoom"] < 1.0
        shown.page.keyboard.press("r")
        state = shown.state()
        assert (state["yaw"], state["zoom"], state["turning"]) == (0.0, 1.0, False)
        shown.page.keyboard.press("Space")
        shown.wait(f"{VIEWER}.steering.yaw < 0")
        assert shown.page.evaluate("scrollY") == 0
        shown.page.keyboard.press("Space")
        assert not shown.state()["turning"]


FOCUS = "document.hasFocus() && document.activeElement.localName === 'canvas'"


def test_the_wheel_is_the_notebooks_at_first(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh(), reduced_motion="reduce") as shown:
        shown.page.mouse.move(300, 200)
        shown.page.mouse.wheel(0, 100)
        shown.page.wait_for_function("() => scrollY === 100")
        assert shown.state()["zoom"] == 1.0


def test_the_wheel_is_the_meshs_once_it_is_clicked(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh(), reduced_motion="reduce") as shown:
        shown.page.mouse.click(300, 200)
        shown.wait(FOCUS)
        shown.page.mouse.wheel(0, 100)
        shown.wait(f"{VIEWER}.steering.zoom > 1")
        assert shown.state()["zoom"] == pytest.approx(1.15)
        assert shown.page.evaluate("scrollY") == 0


def test_the_wheel_is_the_notebooks_again_after_a_click_elsewhere(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh(), reduced_motion="reduce") as shown:
        shown.page.mouse.click(300, 200)
        shown.wait(FOCUS)
        shown.page.mouse.click(655, 430)
        shown.wait(f"!({FOCUS})")
        shown.page.mouse.move(300, 200)
        shown.page.mouse.wheel(0, 100)
        shown.page.wait_for_function("() => scrollY === 100")
        assert shown.state()["zoom"] == 1.0


def test_a_notebook_gets_both_forms():
    formatters = pytest.importorskip("IPython.core.formatters")
    data, _ = formatters.DisplayFormatter().format(Box(1.0).mesh())
    assert data["text/html"].startswith("<iframe ")
    assert data["text/plain"].startswith("<Mesh 'Box': ")


def test_it_stands_where_people_asked_for_less_motion(running, tmp_path):
    with cell(tmp_path, Box(1.0).mesh(), reduced_motion="reduce") as shown:
        shown.page.wait_for_timeout(100)
        rest = shown.state()
        assert not rest["turning"] and rest["yaw"] > -0.5
        shown.page.wait_for_timeout(200)
        assert shown.state() == rest


def test_it_rests_where_nobody_sees_it_and_gives_its_context_back(running, tmp_path):
    lost = "document.querySelector('canvas').getContext('webgl2').isContextLost()"
    with cell(tmp_path, Box(1.0).mesh()) as shown:
        first = shown.pixels()
        shown.page.evaluate("scrollTo(0, 3000)")
        shown.wait(lost)
        rest = shown.state()["frames"]
        shown.page.wait_for_timeout(300)
        assert shown.state()["frames"] == rest
        shown.page.evaluate("scrollTo(0, 0)")
        shown.wait(f"!{lost} && {VIEWER}.frames > {rest + 1}")
        again = shown.pixels()
        assert len(np.unique(first.reshape(-1, 3), axis=0)) > 3
        assert len(np.unique(again.reshape(-1, 3), axis=0)) > 3


def test_without_webgl_it_says_so(running, tmp_path):
    path = tmp_path / "notebook.html"
    path.write_text(PAGE.format(Box(1.0).mesh()._repr_html_()), encoding="utf-8")
    with offline_page(path, flags=("--disable-3d-apis",)) as watched:
        watched.page.wait_for_function("frames.length === 1")
        note = watched.page.locator("iframe").content_frame.locator("[data-distal] p").first
        assert note.inner_text() == "This mesh turns in a browser with WebGL 2."
