"""Scenes of objects: every target draws the CPU's picture, whatever a scene is made of.

Small pictures of scenes that together use each kind of light, camera, material, background, march
and view, and most patterns. The gallery's scenes are held so in ``tests/pictures``.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import distal
from distal import (
    AmbientLight,
    Box,
    Camera,
    Capsule,
    Circle,
    Cylinder,
    DistantLight,
    Environment,
    FisheyeCamera,
    GradientBackground,
    HemisphereLight,
    Hexagon,
    Material,
    OrbitCamera,
    OrthographicCamera,
    PanoramaCamera,
    Plane,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    SpotLight,
    Torus,
    by_cell,
    checker,
    emissive,
    glass,
    glossy,
    image_pattern,
    linear_gradient,
    matte,
    metal,
    mirror,
    noise,
    palette,
    pattern,
    place,
    plastic,
    radial_gradient,
    stripes,
    time,
    waves,
)
from distal.backends import emit, get_target
from distal.compiler.driver import run_passes
from distal.devices.resources import load
from distal.frontend import lower
from distal.ir.types import Texture
from distal.lang import func, length, sin, slider, vec3
from distal.lang.render_options import RenderOptions
from distal.scene.view_ranges import with_range
from tests.pictures.comparison import difference

SIZE = (96, 72)
SECONDS = 1.3
TARGETS = ("glsl-es300", "wgsl")
TALL = slider("Tall", 0.7, 0.1, 2.0)

rows, columns = np.mgrid[0:16, 0:32]
AROUND = np.stack([rows / 16, 0.5 + 0.4 * np.sin(columns / 5), 1 - rows / 16], axis=-1)
AROUND = AROUND.astype(np.float32)


@func
def lumpy(p: vec3, depth: float) -> float:
    return length(p) - 0.6 - depth * sin(9.0 * p.x) * sin(9.0 * p.y)


@func
def by_height(p: vec3, n: vec3) -> vec3:
    return 0.5 + 0.5 * n * p.y


def row(*shapes):
    return [
        shape.translate(1.4 * (i - (len(shapes) - 1) / 2), 0, 0) for i, shape in enumerate(shapes)
    ]


def plain():
    """Blends, cuts, repetitions, deformations, patterns; four kinds of lights, fog."""
    bar = Box(0.7, 1.4, 0.7).twist(0.9).round(0.05 + 0.03 * np.sin(9.0 * place.y)).paint(stripes())
    melted = (
        Sphere(0.5)
        .paint("#c33")
        .union(Box(0.7).translate(0, TALL, 0).paint("#3c3"), smooth=0.08 + 0.02 * np.sin(time))
    )
    cut = (Box(1.0) & Sphere(0.66)) - Cylinder(radius=0.3, height=2.0).cut_material("#fc0")
    field = Capsule().scale(0.3).paint(by_cell()).repeat(0.5, 0.0, 0.5, count=(7, 1, 3))
    own = Shape.from_function(lumpy, slope=2.0, depth=0.05).paint(pattern(by_height))
    lifted = Hexagon().extrude(0.4).rotate(x=1.0).paint(linear_gradient("#024", "#fa5"))
    ring = (
        Circle(0.2 - 0.04 * np.sin(30.0 * place.x))
        .translate(0.5, 0)
        .revolve()
        .paint(noise("#fff", "#06c"))
    )
    front = [lifted.translate(-1.2, 0.2, 1.4), ring.translate(1.2, -0.1, 1.4)]
    ground = [field.translate(0, -0.7, -1.6), Plane(-1.0).paint(checker())]
    return Scene(
        [*row(bar, melted, cut, own), *front, *ground],
        lights=[
            PointLight((2, 3, 4), 9.0, radius=0.2),
            SpotLight((-3, 4, 3), (0, 0, 0), 14.0, color="#fc8"),
            DistantLight((1, 2, 1), 0.3, angle=0.1),
            HemisphereLight(intensity=0.3),
            AmbientLight(0.05),
        ],
        camera=Camera((1.5, 2.0, 6.0), (0, -0.2, 0), fov_deg=40),
        background=GradientBackground(),
        fog=(0.6, 0.65, 0.7),
        fog_density=0.02,
        tone_map="aces",
    )


def mirrored():
    """Metals, coats, mirrors under a sky that is a light; agx."""
    return Scene(
        [
            *row(
                Sphere(0.6).paint(metal((0.9, 0.6, 0.3), roughness=0.3)),
                Torus(0.45, 0.18).rotate(x=1.2).paint(mirror()),
                Box(0.9).round(0.05).rotate(y=0.5).paint(plastic(waves())),
                Sphere(0.6).paint(glossy(radial_gradient(), specular=0.3)),
            ),
            Sphere(0.2).translate(0, 1.1, 0).paint(emissive("#ffa", 2.0)),
            Plane(-0.7).paint(checker("#ddd", "#555")),
        ],
        camera=OrbitCamera(6.0, 0.4, 0.35, fov_deg=35),
        background=Sky((1, 1, 0.5), light=True),
        tone_map="agx",
    )


def refracted():
    """Glass, absorption, weights, a picture around."""
    return Scene(
        [
            *row(
                Sphere(0.6).paint(glass(ior=1.5)),
                Box(0.8).round(0.1).rotate(y=0.6).paint(glass(ior=1.33, color=(0.6, 0.9, 0.7))),
                Sphere(0.6)
                .shell(0.1, where="center")
                .paint(Material("#fcc", diffuse=0.05, specular=0.1, transmission=0.85, ior=1.4)),
            ),
            Plane(-0.7).paint(checker("#eee", "#246")),
        ],
        lights=[PointLight((2, 4, 3), 12.0)],
        camera=Camera((0.5, 1.5, 6.0), fov_deg=35),
        background=Environment(AROUND, light=True),
        bounces=4,
        tone_map="neutral",
    )


def small(**options):
    shapes = [
        Sphere(0.8).paint(palette(1.5)),
        Box(1.0).translate(0, 0.2, -3).paint(image_pattern(AROUND, size=2.0)),
        Torus().rotate(x=1.3).translate(2.5, 0, 0).paint("#39c"),
        Plane(-1.0).paint(checker()),
    ]
    return Scene(shapes, **options)


@func
def water(p: vec3) -> float:
    return p.y - 0.2 * sin(3.0 * p.x) * sin(2.0 * p.z)


def sea():
    waving = Shape.from_function(water, slope=1.3, bounds=((-50, -9, -50), (50, 0.3, 50)))
    return Scene(
        waving.paint(matte((0.1, 0.3, 0.4))),
        march="heightfield",
        camera=Camera((0, 1.5, 4), (0, 0, -4)),
        far=40.0,
    )


def lattice():
    """Parts enough for a grid of distances, by which ambient light is occluded."""
    places = [(x, y, z) for x in range(4) for y in range(3) for z in range(4)]
    parts = [
        (Box(0.5), Sphere(0.3))[i % 2].translate(*(0.7 * c - 1.0 for c in place))
        for i, place in enumerate(places)
    ]
    return Scene([*parts, Plane(-1.4)], lights=AmbientLight(1.0), ambient_occlusion=1.2)


CAMERAS = {
    "orthographic": OrthographicCamera((3, 2, 5), height=5.0),
    "fisheye": FisheyeCamera((0, 0.5, 2.5)),
    "panorama": PanoramaCamera((0, 0.5, 2)),
    "turned": Camera.yaw_pitch_roll((1, 1, 6), 0.1, -0.1, 0.2, fov_deg=40),
    "mirror": Camera((3, 2, 5), mirrored=True),
}
SCENES = {
    "plain": plain,
    "mirrored": mirrored,
    "refracted": refracted,
    "heightfield": sea,
    "lattice": lattice,
    "six taps": lambda: small(normals="six_taps", tone_map="reinhard"),
    "tetrahedron": lambda: small(normals="tetrahedron", shadows=False),
    "forward": lambda: small(normals="forward", ambient_occlusion=0.0, exposure=1.5),
    **{name: lambda camera=camera: small(camera=camera) for name, camera in CAMERAS.items()},
}
VIEWS = (
    "coordinate",
    "signal",
    "distance",
    "normal",
    "depth",
    "steps",
    "material",
    "slope",
    "slice",
)


@cache
def scene(name):
    return SCENES[name]()


@cache
def cpu_picture(name):
    return scene(name).render(size=SIZE, samples=1, time=SECONDS).array


def module_of(picture):
    """What every target is given: the picture in display values, and its textures' data."""
    module = lower(picture.emitted())
    data = {r.name: load(r.source, r.type) for r in module.resources}
    textures = {r.name for r in module.resources if isinstance(r.type, Texture)}
    return module, {
        "textures": {n: a for n, a in data.items() if n in textures},
        "buffers": {n: a for n, a in data.items() if n not in textures},
    }


def drawn(picture, target, **numbers):
    module, data = module_of(picture)
    program = emit(run_passes(module, get_target(target)), get_target(target))
    names = {u["name"] for u in program.interface["uniforms"]}
    uniforms = dict.fromkeys(names & {"time"}, SECONDS) | numbers
    if target == "wgsl":
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(program, SIZE, uniforms, **data)
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(program, SIZE, uniforms, **data)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", SCENES)
def test_drivers_draw_the_cpu_picture(name, target):
    found = difference(drawn(scene(name), target), cpu_picture(name))
    assert cpu_picture(name)[..., :3].std() > 0.05
    assert found.is_agreement, found


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", [n for n in SCENES if n != "refracted"])
def test_the_reference_draws_the_cpu_picture(name):
    reference = scene(name).render(size=SIZE, samples=1, time=SECONDS, device="reference").array
    found = difference(reference, cpu_picture(name))
    assert found.is_agreement, found


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", VIEWS)
def test_drivers_draw_the_cpus_views(name, target):
    whole = scene("turned")
    view = whole.view(name)
    # The range of the values that the view shows, which is measured when it is rendered.
    options = with_range(view, RenderOptions(size=SIZE, time=SECONDS))
    expected = whole.render(size=SIZE, time=SECONDS, view=name).array
    found = difference(drawn(view, target, **(options.settings or {})), expected)
    # Whether a step is accepted is decided by rounding errors, which differ between devices.
    assert found.is_agreement or (name == "steps" and found.far_off < 0.01), found


def test_samples_are_averaged_alike():
    whole = scene("turned")
    cpu = whole.render(size=SIZE, samples=4, time=SECONDS)
    reference = whole.render(size=SIZE, samples=4, time=SECONDS, device="reference")
    assert difference(cpu.array, reference.array).is_agreement
    some = whole.render(size=SIZE, samples=16, time=SECONDS).linear
    many = whole.render(size=SIZE, samples=64, time=SECONDS).linear
    one = whole.render(size=SIZE, samples=1, time=SECONDS).linear
    assert np.abs(some - many).mean() < 0.5 * np.abs(one - many).mean()


@pytest.mark.parametrize("name", ["plain", "refracted"])
def test_constants_draw_what_numbers_draw(name):
    frozen = scene(name).render(size=SIZE, samples=1, time=SECONDS, freeze=True).array
    found = difference(frozen, cpu_picture(name))
    assert found.is_agreement, found


def test_every_kind_is_in_a_scene():
    """What a scene may be made of is drawn by each target here."""
    from_distal = {n for n in distal.__all__ if n.endswith(("Light", "Camera"))}
    used = set(globals())
    assert from_distal <= used | {"TurnedCamera", "BaseCamera"}, from_distal - used
