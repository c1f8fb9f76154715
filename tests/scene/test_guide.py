"""A camera moved by hand never enters a solid, goes as far as it can, and finds the scene again."""

import math
from itertools import product

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    FisheyeCamera,
    OrbitCamera,
    OrthographicCamera,
    PanoramaCamera,
    Plane,
    Scene,
    Sphere,
    Torus,
    glass,
    time,
)
from distal.lang import slider
from distal.scene.objects.cameras import CLASSES
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import Guide, Moment

BALL = Sphere().translate(y=1) | Plane()
WALLS = Box((6, 3, 6)).shell(0.1, where="center").translate(y=1.5)
ROOM = WALLS | Box((1, 1, 1)).translate(1, 0.5, -1)
FENCE = Box((0.01, 3.0, 0.01)).repeat((0.3, 0, 0), count=(21, 1, 1)).translate(y=1.5)
TURNED = Box((1, 6, 1)).twist(0.3).translate(y=3)
STAIRS = Box((2, 0.5, 1)) | Box((2, 1, 1)).translate(z=-1) | Box((2, 1.5, 1)).translate(z=-2)
SCENES = {
    "ball": Scene(BALL, camera=Camera((3, 2, 5), (0, 1, 0))),
    "room": Scene(ROOM, camera=Camera((0, 1.6, 2.5), (0, 1.2, 0))),
    "fence": Scene(FENCE | Plane(), camera=Camera((1, 1, 4), (0, 1, 0))),
    "tower": Scene(TURNED | Plane(), camera=Camera((3, 1.5, 6), (0, 2.5, 0))),
    "stairs": Scene(STAIRS | Plane(), camera=OrbitCamera(6.0, elevation=0.2)),
    "ring": Scene(Torus(2.0, 0.8), camera=OrbitCamera(5.0, elevation=0.3)),
    "millimetres": Scene(Box((40, 20, 30)) | Plane(y=-10), camera=Camera((60, 50, 110))),
    "plan": Scene(BALL, camera=OrthographicCamera((4, 4, 4), (0, 1, 0))),
    "wide": Scene(ROOM, camera=FisheyeCamera((0, 1.6, 2.5), (0, 1.2, 0), fov_deg=150)),
    "z up": Scene(
        Box((1, 1, 2)) | Plane().rotate(x=math.pi / 2),
        camera=Camera((2, -4, 2), (0, 0, 0.5), up=(0, 0, 1)),
    ),
}
EVENTS = 12


def field_at(scene, place):
    """The field of the scene where a camera is, by another way than the guide's."""
    return float(scene.shape(np.asarray(place.position, np.float64)))


def towards(now, goal, share):
    """A part of the way to a goal, as one event of a drag."""
    return Steering(
        now.yaw + (goal.yaw - now.yaw) * share,
        now.pitch + (goal.pitch - now.pitch) * share,
        now.zoom * (goal.zoom / now.zoom) ** share,
        tuple(n + (g - n) * share for n, g in zip(now.pan, goal.pan, strict=True)),
    )


def dragged(guide, goal, moment, events=EVENTS):
    """Where a camera is after a drag to a goal."""
    now = STILL
    for k in range(events):
        now = guide.go(now, towards(now, goal, 1.0 / (events - k)), moment)
    return now


@pytest.mark.parametrize("name", SCENES)
def test_random_drags_end_outside_and_go_most_of_the_way(name):
    scene = SCENES[name]
    guide, moment = Guide(scene), Moment()
    source = np.random.default_rng(len(name))
    gone, wanted, blocked = 0.0, 0.0, 0
    for _ in range(12):
        yaw, pitch = source.normal(0, 1.2), source.uniform(-1.2, 1.2)
        pan = tuple(source.normal(0, 0.4, 2)) if source.random() < 0.5 else (0.0, 0.0)
        goal = Steering(yaw, pitch, math.exp(source.uniform(-2.5, 0.7)), pan)
        blocked += guide.place(goal, moment).clearance <= 0.0
        end = dragged(guide, goal, moment)
        place = guide.place(end, moment)
        assert field_at(scene, place) > 0.0
        assert place.clearance > 0.0
        gone += math.dist(end.numbers, STILL.numbers)
        wanted += math.dist(goal.numbers, STILL.numbers)
    assert gone > 0.8 * wanted, "the camera is stopped where it need not be"
    if name in ("ball", "tower", "stairs"):
        assert blocked >= 2, "these drags prove nothing"


def test_most_of_the_way_is_gone_in_open_scenes():
    guide, moment = Guide(SCENES["ball"]), Moment()
    for yaw, pitch, zoom in [(1.0, 0.5, 0.8), (-2.0, 0.2, 1.5), (0.4, -0.1, 1.0)]:
        goal = Steering(yaw, pitch, zoom)
        assert guide.go(STILL, goal, moment) == goal


def test_a_drag_into_the_floor_slides_along_it():
    guide, moment = Guide(SCENES["ball"]), Moment()
    end = dragged(guide, Steering(yaw=1.0, pitch=-0.8), moment)
    place = guide.place(end, moment)
    assert end.yaw == pytest.approx(1.0, abs=1e-5)
    # As low as the rule allows: two hundredths of the distance.
    clear = 0.02 * math.dist(place.position, place.target)
    assert clear * 0.99 < place.position[1] < clear * 1.6


def test_no_jump_over_a_wall_in_one_event():
    # The goal is free, on the far side of a wall thinner than the way of one event.
    wall = Box((20, 20, 0.01)).translate(z=2.0)
    scene = Scene(wall | Sphere(0.5), camera=Camera((0, 0, 4)))
    guide = Guide(scene)
    assert guide.place(Steering(zoom=0.2), Moment()).clearance > 0.0
    near = guide.go(STILL, Steering(zoom=0.2), Moment())
    assert 2.005 < guide.place(near, Moment()).position[2] < 2.2
    # And from the side: the way around through the wall's plane is blocked too.
    turned = guide.go(STILL, Steering(yaw=math.pi - 0.1), Moment())
    assert guide.place(turned, Moment()).position[2] > 2.0


@pytest.mark.parametrize("notches", [1, 40])
def test_a_wheel_stops_before_a_wall(notches):
    guide, moment, now = Guide(SCENES["room"]), Moment(), STILL
    for _ in range(60 // notches):
        now = guide.go(now, Steering(zoom=max(now.zoom * 1.15**-notches, 0.02)), moment)
        assert guide.place(now, moment).clearance > 0.0
    for _ in range(60 // notches):
        now = guide.go(now, Steering(zoom=min(now.zoom * 1.15**notches, 60.0)), moment)
    # A room seen from inside stays a room.
    x, y, z = guide.place(now, moment).position
    assert abs(x) < 2.95 and 0.05 < y < 2.95 and abs(z) < 2.95
    assert z > 2.7


def test_a_camera_that_starts_inside_moves_freely_and_does_not_return():
    scene = Scene(Sphere(2.0).paint(glass()), camera=Camera((0, 0, 1), (0, 0, -4)))
    guide, moment = Guide(scene), Moment()
    assert guide.place(STILL, moment).clearance < 0.0
    inside = Steering(yaw=0.05, zoom=0.9)
    assert guide.go(STILL, inside, moment) == inside
    outside = guide.go(STILL, Steering(zoom=1.6), moment)
    assert guide.place(outside, moment).position[2] == pytest.approx(4.0, abs=1e-4)
    back = guide.go(outside, STILL, moment)
    assert guide.place(back, moment).position[2] > 2.0


def test_a_camera_that_starts_close_to_a_surface_can_move():
    scene = Scene(Plane(), camera=Camera((0, 0.01, 3), (0, 0.01, 0)))
    guide, moment = Guide(scene), Moment()
    assert dragged(guide, Steering(yaw=0.5), moment).yaw == pytest.approx(0.5, abs=1e-5)
    low = guide.go(STILL, Steering(pitch=-0.3), moment)
    assert 0.0 < guide.place(low, moment).position[1] <= 0.0101


def test_a_camera_that_starts_on_a_surface_can_leave_it():
    guide, moment = Guide(Scene(Plane(), camera=Camera((0, 1e-6, 3), (0, 1e-6, 0)))), Moment()
    assert dragged(guide, Steering(pitch=0.5), moment).pitch == pytest.approx(0.5, abs=1e-5)


def test_parameters_and_time_count():
    size = slider("Size", 1.0, 0.5, 5.0)
    scene = Scene(Sphere(size).translate(x=time), camera=Camera((0, 0, 6)), floor=False)
    guide = Guide(scene)
    goal = Steering(zoom=0.5)
    assert guide.go(STILL, goal, Moment()) == goal
    assert guide.go(STILL, goal, Moment(params={"size": 4.0})).zoom > 4.0 / 6.0
    assert guide.go(STILL, goal, Moment(time=20.0, params={"size": 4.0})) == goal


def test_a_scene_that_moved_over_the_camera_lets_it_out():
    scene = Scene(Sphere(time), camera=Camera((0, 0, 6)), floor=False)
    guide = Guide(scene)
    goal = Steering(zoom=2.0)
    assert guide.go(STILL, goal, Moment(time=7.0)) == goal
    # Close to a surface that came: away is allowed, closer is not.
    assert guide.go(STILL, goal, Moment(time=5.99)) == goal
    closer = guide.go(STILL, Steering(zoom=0.5), Moment(time=5.99))
    assert guide.place(closer, Moment()).position[2] > 5.99


# Framing


def projected(place, aspect, box):
    """The corners of a box in the picture, in units of half its height; by plain trigonometry."""
    eye, target, up = (np.array(v) for v in (place.position, place.target, place.up))
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, up)
    right /= np.linalg.norm(right)
    corners = np.array(np.meshgrid(*zip(*box, strict=True))).reshape(3, -1).T - eye
    depth = corners @ ahead
    assert (depth > 0).all()
    half = 0.5 * place.height + math.tan(math.radians(place.opening_deg / 2.0)) * depth
    return np.stack([corners @ right / half / aspect, corners @ np.cross(right, ahead) / half])


@pytest.mark.parametrize(
    "camera",
    [
        Camera((3, 2, 5), (0, 1, 0)),
        Camera((30, 20, 50), (2, 1, 0), fov_deg=70, mirrored=True),
        OrthographicCamera((3, 2, 5), (0, 1, 0)),
        Camera.yaw_pitch_roll((1, 1, 6)),
    ],
)
def test_the_box_fills_the_picture(camera):
    shape = Box((2, 1, 3)).translate(1, 1.5, 0.5)
    guide = Guide(Scene(shape | Plane(), camera=camera))
    wanted = {"front": (0, 0, 1), "back": (0, 0, -1), "right": (1, 0, 0), "left": (-1, 0, 0)}
    for size, action in product([(4.0, 3.0), (3.0, 4.0), (1.0, 5.0)], ["frame", *wanted, "top"]):
        moment = Moment(size=size)
        place = guide.place(guide.show(action, Steering(0.3, 0.1, 1.7, (0.2, 0.1)), moment), moment)
        seen = projected(place, size[0] / size[1], shape.bounds())
        assert np.abs(seen).max() == pytest.approx(1 / 1.12, abs=2e-3), (action, size)
        away = np.array(place.position) - np.array(place.target)
        away /= np.linalg.norm(away)
        if action in wanted:
            assert away @ np.array(wanted[action]) > 0.95  # raised, if the floor is in the way
        if action == "top":
            assert away == pytest.approx((0, 1, 0), abs=1e-3)


def test_axes_with_z_up_are_those_of_a_modeller():
    scene = Scene(Box(1), camera=Camera((2, -4, 2), up=(0, 0, 1)), floor=False)
    guide, moment = Guide(scene), Moment()
    for action, wanted in [
        ("front", (0, -1, 0)),
        ("back", (0, 1, 0)),
        ("right", (1, 0, 0)),
        ("top", (0, 0, 1)),
        ("bottom", (0, 0, -1)),
    ]:
        place = guide.place(guide.show(action, STILL, moment), moment)
        away = np.array(place.position) - np.array(place.target)
        assert away / np.linalg.norm(away) == pytest.approx(wanted, abs=1e-4)


def test_a_view_from_below_the_floor_stays_above_it():
    scene = SCENES["ball"]
    guide, moment = Guide(scene), Moment()
    place = guide.place(guide.show("bottom", STILL, moment), moment)
    assert field_at(scene, place) > 0.0
    assert place.position[1] > 0.0


def test_ground_is_no_part_of_what_is_framed():
    ground = Box((200, 1, 200)).translate(y=-0.5)
    camera = Camera((3, 2, 5), (0, 1, 0))
    guides = [Guide(Scene(Sphere().translate(y=1) | g, camera=camera)) for g in (ground, Plane())]
    found = [guide.show("frame", STILL, Moment()).numbers for guide in guides]
    assert found[0] == pytest.approx(found[1], abs=1e-4)


def test_nothing_finite_shows_the_authors_distance():
    scene = Scene(Plane(), camera=Camera((3, 2, 5)))
    assert Guide(scene).show("frame", Steering(0.2, 0.1, 3.0), Moment()).zoom == 1.0


# Where it is


@pytest.mark.parametrize(
    "camera",
    [
        Camera((3, 2, 5), (0, 1, 0), fov_deg=35),
        OrbitCamera(4.0, azimuth=0.5, elevation=0.3),
        Camera.yaw_pitch_roll((1, 1, 6), 0.1, -0.2, 0.3, fov_deg=50),
        OrthographicCamera((3, 2, 5), (0, 1, 0), height=3.0),
        Camera((2, -4, 2), up=(0, 0, 1), mirrored=True),
        FisheyeCamera((1, 1, 2), fov_deg=120),
        PanoramaCamera((1, 1, 2), (0, 1, 0)),
    ],
)
def test_the_text_is_the_camera(camera):
    guide = Guide(Scene(Sphere(0.1), camera=camera))
    place = guide.place(Steering(0.7, 0.2, 1.3, (0.1, -0.05)), Moment())
    again = Guide(Scene(Sphere(0.1), camera=eval(guide.text(place), dict(CLASSES))))
    found = again.place(STILL, Moment())
    for mine, its in [
        (found.position, place.position),
        (found.target, place.target),
        (found.up, place.up),
        ((found.opening_deg, found.height), (place.opening_deg, place.height)),
    ]:
        assert mine == pytest.approx(its, abs=2e-3)
    assert again.form == guide.form


def test_the_text_is_short():
    guide = Guide(Scene(BALL, camera=Camera((3, 2, 5), (0, 1, 0))))
    text = guide.text(guide.place(STILL, Moment()))
    assert text == "Camera((3, 2, 5), (0, 1, 0), fov_deg=40)"
