"""A ruler: places on surfaces, edges and corners in closed form; where places are seen."""

import math
from itertools import product

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    Cone,
    Cylinder,
    FisheyeCamera,
    OrthographicCamera,
    PanoramaCamera,
    Plane,
    Scene,
    Sphere,
)
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.render.ruler import CUT_AXES, CUT_NUMBERS, PLACE_NUMBERS, POINTS
from distal.scene.lowering import ruler as uniforms
from distal.scene.lowering.ruler import CutImage, PlaceImage
from distal.scene.section import CutPlane
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import Guide, Moment
from distal.scene.viewing.number_rows import NumberRow
from distal.scene.viewing.ruler import MINUS, Ruler, RulerEnd, measures_text
from distal.scene.viewing.viewable import viewable

MOMENT = Moment((640, 480))
HALF = (2.0, 1.0, 1.5)
VIEWS = {
    "usual": STILL,
    "steep": Steering(pitch=0.9),
    "grazing": Steering(pitch=-0.44),
    "behind": Steering(yaw=2.6, zoom=0.6),
}


def boxed(scale: float = 1.0, camera=None) -> Scene:
    sides = tuple(2.0 * h * scale for h in HALF)
    place = tuple(scale * n for n in (6, 5, 9))
    return Scene(Box(sides), camera=camera or Camera(place, (0, 0, 0)), floor=False)


def end(*point: float) -> RulerEnd:
    return RulerEnd(point, "surface", 1.0)


def seen_at(ruler: Ruler, point, steering: Steering = STILL):
    """Where a point is seen in the picture, in fractions."""
    return ruler.seen(end(*point), end(*point), MOMENT, steering).places[0]


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_corners_edges_and_faces_of_a_box(scale: float, view: str):
    scene = boxed(scale)
    ruler, steering = Ruler(scene), VIEWS[view]
    eye = Guide(scene).place(steering, MOMENT).position
    kinds = {"corner": 3, "edge": 2, "surface": 1}
    met = dict.fromkeys(kinds, 0)
    for point in product((-1, 0, 1), repeat=3):
        wanted = tuple(n * h * scale for n, h in zip(point, HALF, strict=True))
        away = np.subtract(eye, wanted) / math.dist(eye, wanted)
        if max(np.multiply(point, away)) < 0.25:  # it is behind the box, or at its outline
            continue
        place = seen_at(ruler, wanted, steering)
        found = ruler.place_at(*place, MOMENT, steering, None)
        assert kinds[found.kind] == sum(map(abs, point)), (point, found)
        assert math.dist(found.point, wanted) < 0.02 * scale
        # What is snapped lies on its faces exactly; along an edge the pointer decides.
        off = [
            abs(abs(a) / scale - h) for a, h, n in zip(found.point, HALF, point, strict=True) if n
        ]
        assert max(off) < 4e-6
        met[found.kind] += 1
    assert met["corner"] >= 4
    assert met["edge"] >= 4
    assert met["surface"] >= 1


def test_the_distance_of_two_faces_is_that_of_the_box():
    ruler = Ruler(boxed())
    back, front = Steering(yaw=math.pi), STILL
    near = ruler.place_at(0.5, 0.5, MOMENT, front, None)
    far = ruler.place_at(0.5, 0.5, MOMENT, back, None)
    seen = ruler.seen(near, far, MOMENT, front)
    assert abs(seen.differences[2]) == pytest.approx(3.0, abs=1e-5)
    assert seen.distance == pytest.approx(math.dist(near.point, far.point), rel=1e-6)
    along = np.subtract(far.point, near.point)
    assert seen.differences == pytest.approx(tuple(along), abs=1e-6)


@pytest.mark.parametrize("px", [1, 4, 7, 12, 30])
def test_an_edge_takes_what_is_near_and_nothing_else(px: int):
    """At the right edge of a face that a parallel camera sees from the front."""
    camera = OrthographicCamera((0, 0, 9), (0, 0, 0), height=4.8)  # .01 in a pixel
    ruler = Ruler(boxed(camera=camera))
    x = 320 + 200 - px
    found = ruler.place_at(x / 640, 250 / 480, MOMENT, STILL, None)
    is_near = px < 9
    assert found.kind == ("edge" if is_near else "surface")
    assert found.point[0] == pytest.approx(2.0 if is_near else 2.0 - 0.01 * px, abs=1e-5)
    assert found.point[1] == pytest.approx(-0.1, abs=1e-5)
    assert found.pixel == pytest.approx(0.01, rel=1e-3)
    # Beside the outline the ray misses the box.
    beside = ruler.place_at((320 + 200 + px) / 640, 250 / 480, MOMENT, STILL, None)
    if px <= 4:
        assert beside.kind == "edge"
        assert beside.point[0] == pytest.approx(2.0, abs=1e-5)
    elif not is_near:
        assert beside is None


def test_curved_edges_apexes_and_what_is_round():
    rim = Ruler(Scene(Cylinder(1.0, 2.0), camera=Camera((2, 4, 5), (0, 0, 0)), floor=False))
    for angle in (0.4, 1.2, 1.57):
        place = seen_at(rim, (math.cos(angle), 1.0, math.sin(angle)))
        found = rim.place_at(place[0], place[1] + 0.004, MOMENT, STILL, None)
        assert found.kind == "edge"
        assert math.hypot(found.point[0], found.point[2]) == pytest.approx(1.0, abs=1e-4)
        assert found.point[1] == pytest.approx(1.0, abs=1e-5)
    ball = Ruler(Scene(Sphere(), camera=Camera((0, 0, 5), (0, 0, 0)), floor=False))
    rounded = Ruler(Scene(Box(2).round(0.2), camera=Camera((3, 4, 5), (0, 0, 0)), floor=False))
    for i, j in product(range(1, 12), repeat=2):
        for ruler in (ball, rounded):
            found = ruler.place_at(i / 12, j / 12, MOMENT, STILL, None)
            assert found is None or found.kind == "surface"
    cone = Scene(Cone(1.0, 2.0), camera=Camera((0, 1, 5), (0, 0, 0)), floor=False)
    tip = Ruler(cone)
    top = cone.shape.bounds()[1][1]
    place = seen_at(tip, (0.0, top, 0.0))
    found = tip.place_at(place[0], place[1] + 0.01, MOMENT, STILL, None)
    assert found.kind == "corner"
    assert found.point == pytest.approx((0.0, top, 0.0), abs=1e-3)


def test_where_a_solid_stands_on_another_is_an_edge():
    scene = Scene(Box(2).translate(y=1) | Plane(), camera=Camera((0, 4, 8), (0, 1, 0)))
    ruler = Ruler(scene)
    place = seen_at(ruler, (0.3, 0.0, 1.0))
    found = ruler.place_at(place[0], place[1] + 0.006, MOMENT, STILL, None)
    assert found.kind == "edge"
    assert found.point[1:] == pytest.approx((0.0, 1.0), abs=1e-4)


def test_places_are_found_through_the_plane_of_a_section():
    bored = Box(4, 2, 3) - Box(3, 1, 2)
    seen = viewable(Scene(bored, camera=Camera((0, 0, 9), (0, 0, 0)), floor=False))
    plane = CutPlane((0.0, 0.0, 1.0), 0.0)
    whole = seen.ruler.place_at(0.5, 0.5, MOMENT, STILL, None)
    shown = seen.shown_with(plane).ruler
    inside = shown.place_at(0.5, 0.5, MOMENT, STILL, plane)
    assert whole.point[2] == pytest.approx(1.5, abs=1e-5)
    assert inside.point[2] == pytest.approx(-1.0, abs=1e-5)
    face = shown.place_at(*seen_at(seen.ruler, (1.75, 0.2, 0.0)), MOMENT, STILL, plane)
    assert face.point[2] == pytest.approx(0.0, abs=1e-5)
    rim = shown.place_at(*seen_at(seen.ruler, (1.5, 0.2, 0.0)), MOMENT, STILL, plane)
    assert rim.kind == "edge"
    assert (rim.point[0], rim.point[2]) == pytest.approx((1.5, 0.0), abs=1e-5)


CAMERAS = {
    "usual": Camera((6, 5, 9), (0, 0, 0)),
    "wide": Camera((1, 2, 3), (0, 0, 0), fov_deg=120),
    "mirrored": Camera((6, 5, 9), (0, 0, 0), mirrored=True),
    "parallel": OrthographicCamera((6, 5, 9), (0, 0, 0), height=8),
    "fisheye": FisheyeCamera((1, 2, 3), (0, 0, 0), fov_deg=180),
    "panorama": PanoramaCamera((1, 2, 3), (0, 0, 0)),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_a_place_is_seen_where_it_was_clicked(name: str):
    """Through every camera: the place under a pointer is seen under that pointer."""
    ruler = Ruler(boxed(camera=CAMERAS[name]))
    hits = 0
    for steering in (STILL, Steering(0.7, -0.2, 1.3, (0.2, -0.1))):
        for i, j in product(range(1, 16), repeat=2):
            x, y = i / 16 + 0.01, j / 16
            found = ruler.place_at(x, y, MOMENT, steering, None)
            if found is None or found.kind != "surface":
                continue
            hits += 1
            place = ruler.seen(found, found, MOMENT, steering).places[0]
            assert place == pytest.approx((x, y), abs=2e-4)
    assert hits > 10


def test_what_is_behind_the_camera_is_not_seen():
    seen = Ruler(boxed()).seen(
        end(0, 0, 0), end(12, 10, 18), MOMENT, STILL
    )  # the eye is in the middle
    ahead = [place is not None for place in seen.places]
    assert len(ahead) == POINTS
    assert ahead[0]
    assert not ahead[-1]
    assert ahead == sorted(ahead, reverse=True)


def test_the_reference_finds_the_same_place():
    scene = Scene(Box(4, 2, 3), camera=Camera((6, 5, 9), (0, 0, 0)), floor=False)
    settings = {
        **STILL.settings,
        uniforms.SIZE: (640.0, 480.0),
        uniforms.POINTER: (377.5, 240.0),
    }
    rows = [
        executor()
        .render(
            PlaceImage(scene),
            RenderOptions(size=(len(PLACE_NUMBERS), 1), device=device, settings=settings),
        )
        .array
        for device in ("cpu", "reference")
    ]
    numbers = [np.rint(row * 255).astype(np.uint8).tobytes() for row in rows]
    found = [np.frombuffer(bits, np.float32) for bits in numbers]
    assert found[0][3] != 0
    assert found[0] == pytest.approx(found[1], abs=1e-5)


def test_the_label_rounds_what_nobody_can_point_at():
    a = RulerEnd((0.0, -10.00001, 20.0), "corner", 0.2)
    b = RulerEnd((12.34567, 0.00002, 20.0), "edge", 0.2)
    seen = Ruler(boxed()).seen(a, b, MOMENT, STILL)
    assert measures_text(a, b, seen, "mm") == (
        "15.888 mm",
        "Δx 12.346   Δy 10   Δz 0",
        f"from (0, {MINUS}10, 20), corner",
        "to (12.346, 0, 20), edge",
    )


def test_on_a_face_seen_from_the_side_edges_are_as_near_as_they_look():
    """At the top of a box, 12 degrees above it, through a parallel camera: .01 in a pixel."""
    up = math.sin(math.radians(12.0))
    camera = OrthographicCamera((0, 9 * up, 9 * math.sqrt(1 - up * up)), (0, 0, 0), height=4.8)
    ruler = Ruler(boxed(camera=camera))

    def at(x: float, z: float, right_px: float = 0.0, down_px: float = 0.0) -> RulerEnd:
        place = seen_at(ruler, (x, 1.0, z))
        moved = (place[0] + right_px / 640, place[1] + down_px / 480)
        return ruler.place_at(*moved, MOMENT, STILL, None)

    # The face is 62 pixels high in the picture; 31 from each of its long edges it is plain.
    assert at(0.0, 0.0).kind == "surface"
    far = at(0.0, -1.5, down_px=6.0)  # .29 from the edge on the face
    assert far.kind == "edge"
    assert far.point[1:] == pytest.approx((1.0, -1.5), abs=1e-4)
    # To the side nothing is foreshortened.
    assert at(2.0, 0.0, right_px=-15.0).kind == "surface"
    assert at(2.0, 0.0, right_px=-5.0).kind == "edge"


def test_planes_cut_along_the_box_and_across_the_view():
    scene = Scene(
        Box(4, 2, 6).translate(1, 0, 0) | Plane(y=-1), camera=Camera((0, 0, 9), (0, 0, 0))
    )
    row = NumberRow(CutImage(scene), CUT_NUMBERS)
    settings = {**Steering(yaw=math.pi / 2).settings, uniforms.SIZE: (640.0, 480.0)}
    found = row.read(settings, time=0.0, params={})
    numbers = [
        [found[f"{axis}_{n}"] for n in ("normal_x", "normal_y", "normal_z", "low", "high")]
        for axis in CUT_AXES
    ]
    expected = [
        [1, 0, 0, -1, 3],
        [0, 1, 0, -1, 1],
        [0, 0, 1, -3, 3],
        [1, 0, 0, -1, 3],  # the camera was turned to the right
    ]
    assert np.allclose(numbers, expected, atol=1e-5)
    assert found["diagonal"] == pytest.approx(math.hypot(4, 2, 6), rel=1e-6)
    endless = Scene(Cylinder(1.0, 2.0).repeat((3, 0, 0)), camera=Camera((0, 0, 9), (0, 0, 0)))
    found = NumberRow(CutImage(endless), CUT_NUMBERS).read(settings, time=0.0, params={})
    assert (found["x_low"], found["x_high"]) == (-2.0, 2.0)
