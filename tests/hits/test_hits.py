"""A hit is a surface: where faces meet, slopes are steep, scenes are small, solids are thin."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import distal
from distal import (
    AmbientLight,
    Annulus,
    Box,
    Camera,
    Circle,
    Cylinder,
    DistantLight,
    Plane,
    PointLight,
    Rectangle,
    Scene,
    Shape,
    Sphere,
)
from distal.backends.base import Artifact
from distal.lang import abs, func, length, max, sin, vec3
from distal.scene.checks.probe import probe
from tests.browser import BrowserUnavailableError
from tests.hits.looking import cover, faults, faults_by_points, scene, seen_from_anywhere

ABOVE = (0.0, 6.0, 0.001)
UPRIGHT = {"x": math.pi / 2.0}
RING = Annulus(0.8, 0.4).extrude(0.5).rotate(**UPRIGHT)
FLUSH = Cylinder(1, 0.5) - Cylinder(0.6, 0.5)
PLATE = Box(2, 1, 1).rotate(**UPRIGHT)
# A cut whose ends lie in the faces of what it cuts, and the same solid without such faces.
CUTS = {
    "ring": (FLUSH, RING),
    "a little longer": (Cylinder(1, 0.5) - Cylinder(0.6, 0.5002), RING),
    "plate": (PLATE - Cylinder(0.4, 1), PLATE - Cylinder(0.4, 2)),
    "notch": (
        Box(2, 1, 1) - Box(1, 1, 1).translate(x=0.5),
        Box(1, 1, 1).translate(x=-0.5),
    ),
    "extruded": (
        (Rectangle(2, 1).extrude(1) - Circle(0.3).extrude(1)).rotate(**UPRIGHT),
        (Rectangle(2, 1) - Circle(0.3)).extrude(1).rotate(**UPRIGHT),
    ),
    "touching": (Box(1, 1, 1) | Box(1, 1, 1).translate(x=1), Box(2, 1, 1).translate(x=0.5)),
}


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", range(24))
def test_each_pixel_of_coincident_faces_is_that_of_exact_intervals(seed):
    judged, wrong_cover, wrong_depth = faults(seed)
    assert judged > 8000
    assert (wrong_cover, wrong_depth) <= (0, 2)


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", range(16))
def test_each_pixel_of_round_solids_is_that_of_a_count_by_points(seed):
    """Balls, cylinders, rings and boxes with common faces and axes, at sizes from 1e-6 to 1e6."""
    judged, wrong_cover, wrong_depth = faults_by_points(seed, k=10.0 ** (seed % 13 - 6))
    assert judged > 1500
    assert (wrong_cover, wrong_depth) == (0, 0)


@pytest.mark.parametrize("device", ["reference", "gpu", "gpu-fragment"])
def test_on_every_device(device):
    if device != "reference":
        pytest.importorskip("wgpu")
    judged, wrong_cover, wrong_depth = faults(3, 64, device)
    assert judged > 3500
    assert (wrong_cover, wrong_depth) <= (1, 2)


@pytest.mark.parametrize("target", ["glsl-es300", "glsl-330", "wgsl"])
def test_texts_draw_a_flush_cut(target):
    """In SwiftShader's WebGL 2, in OpenGL and in WebGPU."""
    for name in ("ring", "notch"):
        cut, same = CUTS[name]
        shown = drawn(distal.compile(scene(cut, ABOVE), target), (96, 96))[..., 0] > 0.3
        assert shown.mean() == pytest.approx(cover(same, ABOVE, size=96), abs=1e-3)


def drawn(program: Artifact, size: tuple[int, int]) -> np.ndarray:
    """The picture of a text."""
    target = program.interface["target"]
    if target == "wgsl":
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(program, size)
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    if target == "glsl-es300":
        webgl = pytest.importorskip("tests.webgl")
        try:
            return webgl.run_webgl(program, size)
        except BrowserUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(program, size)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))


def test_a_thousand_sizes_from_the_origin():
    judged, wrong_cover, _ = faults(5, offset=1000.0)
    assert wrong_cover <= 8e-4 * judged


ANGLES = [ABOVE, (6, 1.5, 0), (3, 4, 2), (-2, 5, -3), (0.5, -6, 1), (1, 2, 6)]


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize("name", CUTS)
@pytest.mark.parametrize("k", [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e6])
def test_a_flush_cut_is_drawn(name, k):
    """From six angles and four distances, at three resolutions."""
    cut, same = (seen_from_anywhere(shape.scale(k)) for shape in CUTS[name])
    for eye, away, size in itertools.product(ANGLES, (1, 3, 10, 100), (32, 64, 120)):
        unit = np.array(eye) / np.linalg.norm(eye)
        place = dict(zip("xyz", (6.0 * away * k * unit).tolist(), strict=True))
        given = {"params": {**place, "fov": 30.0 / away}, "transparent": True, "samples": 1}
        shown, right = (
            scene.render((size, size), **given).array[..., 3] > 0.5 for scene in (cut, same)
        )
        assert shown.mean() == pytest.approx(right.mean(), abs=1e-3), (eye, away, size)


@pytest.mark.parametrize("device", ["cpu", "reference", "gpu"])
def test_nothing_is_left_of_a_shape_without_itself(device):
    for solid in (Sphere(1), Cylinder(1, 0.5), Box(1, 2, 1)):
        assert cover(solid - solid, ABOVE, size=48, device=device) == 0.0
        assert cover(solid ^ solid, ABOVE, size=48, device=device) == 0.0


def test_paths_meet_the_same_surfaces():
    for cut, same in CUTS.values():
        shown = (cover(shape, ABOVE, size=80, mode="path", samples=1) for shape in (cut, same))
        assert next(shown) == pytest.approx(next(shown), abs=2e-3)
    assert cover(FLUSH - FLUSH, ABOVE, size=48, mode="path", samples=1) == 0.0


@pytest.mark.parametrize("away", [1.0, 5.0, 20.0, 100.0])
def test_a_thin_shell_is_whole_from_any_distance(away):
    right = math.pi * (math.tan(math.asin(1.0 / (6.0 * away))) / math.tan(math.pi / 12 / away)) ** 2
    for thickness in (1e-3, 1e-5):
        eye, fov = (0.0, 6.0 * away, 0.001 * away), 30.0 / away
        found = cover(Sphere(1).shell(thickness, where="center"), eye, fov)
        assert found == pytest.approx(right / 4.0, abs=4e-3)


def test_a_narrow_gap_lets_the_eye_through():
    """Two plates 1e-4 apart, from the side along the gap: 2 rays of 9 pass between."""
    plates = Box(1, 0.1, 1).translate(y=0.05005) | Box(1, 0.1, 1).translate(y=-0.05005)
    fov = 2.0 * math.degrees(math.atan(2.25e-4 / 60.0))
    assert cover(plates, (60.0, 0.0, 0.0), fov, size=9) == pytest.approx(7.0 / 9.0, abs=0.12)


@func
def steep_ball(p: vec3) -> float:
    q = abs(p)
    m = max(q.x, max(q.y, q.z))
    return m * (length(p) / max(m, 1e-6)) - 1.0


@pytest.mark.parametrize("slope", [1.0, 1e2, 1e4, 1e8, None])
def test_a_slope_too_large_makes_no_shape_larger(slope):
    """Declared, or proved: of a guarded division 1.4e8 for a field that is |p| - 1."""
    if slope is None:
        ball = Shape.from_function(steep_ball, region=((-2,) * 3, (2,) * 3))
        assert ball.slope > 1e8
    else:
        ball = Shape.from_function(steep_ball, slope=slope, bounds=((-1.1,) * 3, (1.1,) * 3))
    right = math.pi * (math.tan(math.asin(0.2)) / math.tan(math.radians(20)) / 2.0) ** 2
    assert cover(ball, (0, 0, 5), 40, size=200) == pytest.approx(right, abs=1e-3)


def lit(k: float) -> Scene:
    """A scene of size k with its own lights."""
    shape = Sphere(k) | Box(k, k, k).translate(1.3 * k, -0.5 * k, 0.2 * k)
    lamp = PointLight((3 * k, 5 * k, 4 * k), intensity=30 * k * k, radius=0.3 * k)
    return Scene(
        (shape | Plane(y=-k)).paint("white"),
        camera=Camera((2 * k, 1.5 * k, 5 * k), fov_deg=40),
        tone_map="none",
        lights=[AmbientLight(0.1), lamp],
        background="skyblue",
        ambient_occlusion=0.5 * k,
    )


def looked_at(k: float) -> Scene:
    """A scene of size k in the default look."""
    return Scene((Box(2 * k, 2 * k, 2 * k) & Sphere(1.3 * k)) - Cylinder(0.5 * k, 3 * k))


@func
def hills(p: vec3, k: float) -> float:
    return p.y - 0.3 * k * sin(2.0 * p.x / k) * sin(1.7 * p.z / k)


def terrain(k: float) -> Scene:
    """Hills of size k, by the march for terrain."""
    endless, high = 1e18, 0.3 * k
    bounds = ((-endless, -high, -endless), (endless, high, endless))
    return Scene(
        Shape.from_function(hills, slope=1.3, bounds=bounds, k=k).paint("white"),
        camera=Camera((0, 0.6 * k, 4 * k), target=(0, 0, 0), fov_deg=50),
        lights=[DistantLight((0.5, 0.7, 0.3))],
        background="skyblue",
        march="heightfield",
        ambient_occlusion=0.0,
    )


@pytest.mark.parametrize("made", [lit, looked_at, terrain])
def test_a_scene_of_any_size_has_the_same_picture(made):
    right = made(1.0).render(size=(80, 60), samples=4).array[..., :3]
    for k in (1e-6, 1e-4, 1e-2, 1e2, 1e6):
        found = made(k).render(size=(80, 60), samples=4).array[..., :3]
        assert np.abs(found - right).mean() < 0.002, k


def shadow_of(ring: Shape, angle: float | None) -> np.ndarray:
    """A ring above a floor, under a light of this angle or, if None, ambient light alone."""
    lights = [AmbientLight(0.3)]
    if angle is not None:
        lights.append(DistantLight((0.15, 1, 0.1), intensity=2.0, angle=angle))
    shown = Scene(
        (ring | Plane(y=-0.8)).paint("white"),
        camera=Camera((1.5, 4.5, 3.0), target=(0, -0.3, 0), fov_deg=40),
        lights=lights,
        background="black",
        tone_map="none",
        ambient_occlusion=0.5 if angle is None else 0.0,
    )
    return shown.render(size=(200, 150), samples=1).linear[..., :3]


@pytest.mark.parametrize(("angle", "most"), [(0.005, 1e-3), (0.1, 1e-3), (0.5, 5e-3), (None, 2e-3)])
def test_a_flush_bore_has_the_shadow_of_the_ring(angle, most):
    assert np.abs(shadow_of(RING, angle) - shadow_of(FLUSH, angle)).mean() < most


def test_thin_opaque_solids_leak_no_soft_shadow():
    """The middle of the shadow of a lid with raised letters is as dark as that of a plate."""
    for height in (0.002, 0.02):
        lid = Box(1.6, 0.05, 1.6) | Box(0.4, height, 0.4).translate(y=0.025 + height / 2.0)
        plate, raised = (
            shadow_of(shape.rotate(x=0.0), 0.3).reshape(-1, 3)
            for shape in (Box(1.6, 0.05, 1.6), lid)
        )
        under = plate.max(axis=1) < 0.35  # in the umbra
        assert under.sum() > 300
        assert (raised[under].max(axis=1) < 0.37).all()


def test_what_is_nearer_than_a_thousandth_is_seen():
    """Rays begin at the eye: ``near`` is 0 unless its author says more."""
    assert cover(Sphere(1e-5), (0.0, 0.0, 1e-4), 30.0, size=64) > 0.1


def endless_city() -> Scene:
    tower = Box(0.3, 1.2, 0.3) | Box(0.12, 2, 0.12)
    return Scene(
        tower.repeat((1, 1e4, 1)) | Plane(y=-0.6),
        camera=Camera((0.5, 1.5, 9), target=(0.37, 0.2, 0), fov_deg=45),
        floor=False,
    )


CITIES = {
    "city": (lambda: distal.load("example:city"), (64, 48), 60),
    "endless": (endless_city, (96, 72), 200),
}


@pytest.mark.parametrize("name", CITIES)
def test_no_tower_of_a_city_is_stepped_over(name):
    """Streets are flat and repeat: values agree with what is expected behind a tower too."""
    make, size, count = CITIES[name]
    city = make()
    depth = np.asarray(
        city.render(size, samples=1, layers=["depth"], mode="direct").layers["depth"]
    )
    along = np.arange(0.0, 30.0, 2e-3)
    drawn_pixels = np.random.default_rng(1).integers((0, 0.4 * size[1]), size, (count, 2))
    met = 0
    for x, y in drawn_pixels:
        seen = probe(city, (int(x), int(y)), size).seen
        ray = np.array(seen.origin, float) + along[:, None] * np.array(seen.direction, float)
        inside = np.flatnonzero(np.asarray(city.shape(ray)) < 0.0)
        if len(inside):
            met += 1
            assert depth[y, x] == pytest.approx(along[inside[0]], abs=0.02), (x, y)
    assert met > 0.6 * count
