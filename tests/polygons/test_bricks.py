"""Bricks: the same field as all samples near the surface, a continuous bound elsewhere."""

import base64

import numpy as np
import pytest

from distal import Camera, Scene, Shape, Sphere, compile
from distal.diagnostics import LoadError
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.lang.resources import Buffer, Texture3D
from distal.polygons import bricks, importing, sparse, volumes
from distal.polygons.distances import distances
from distal.polygons.sparse import brick_distances
from distal.polygons.triangles import checked
from distal.scene.objects.volume_shapes import brick_node, grid_node
from distal.scene.tree.errors import SceneValueError
from distal.scene.viewing.viewable import viewable
from tests.mesh.sample_solids import box, sphere, torus
from tests.parity.test_scenes import TARGETS, difference, drawn

SLOPE = 3.0**0.5
SIZE = (96, 72)
RANDOM = np.random.default_rng(11)


def joined(*parts):
    """Meshes as one."""
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    points = np.concatenate([points for points, _ in parts])
    return points, np.concatenate([t + n for (_, t), n in zip(parts, starts, strict=False)])


TWO_BOXES = joined(box(), (box()[0] + np.array((0.5, 0.3, 0.2)), box()[1]))
SPHERE = sphere(4)
SMALL_HOLE = SPHERE[0], SPHERE[1][1:]
SHEET = np.array([(-1.0, 0, -1), (1, 0, -1), (1, 0.3, 1), (-1, 0.3, 1)]), [(0, 2, 1), (0, 3, 2)]
# A mesh, its spacing, how its inside is asked for and found.
MESHES = {
    "torus": (torus(48, 24), 0.03, "auto", "normals"),
    "box of twelve triangles": (box(), 0.017, "auto", "normals"),
    "inside out": ((SPHERE[0], SPHERE[1][:, ::-1]), 0.03, "auto", "normals"),
    "bodies that overlap": (TWO_BOXES, 0.02, "auto", "winding"),
    "a hole smaller than a cell": (SMALL_HOLE, 0.2, "auto", "winding"),
    "a sheet": (SHEET, 0.03, "unsigned", "unsigned"),
    "asked to wind": (torus(24, 12), 0.04, "winding", "winding"),
}


def volume_with_steep_places():
    """A shape with a level, on a grid whose spacings differ; it goes on beyond the grid."""
    z, y, x = np.mgrid[-1:1:70j, -1:1:90j, -1:1:61j]
    return np.sin(5 * x) * np.cos(4 * y) + np.sin(4 * y) * np.cos(5 * z) + np.tanh(9 * (x + z))


def distances_to_small_balls():
    """Much of this grid is far from the surface, and distances bend there."""
    axis = np.linspace(-1.0, 1.0, 97)
    places = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)[..., ::-1]
    middles = np.array([(-0.6, -0.5, 0.1), (0.6, 0.45, 0.65), (0.3, -0.1, -0.7)])
    return np.min([np.linalg.norm(places - m, axis=-1) for m in middles], axis=0) - 0.06


# Samples (z, y, x), their distances along z, y and x, the level of the surface.
VOLUMES = {
    "a volume": (volume_with_steep_places, (0.02, 0.03, 0.025), 0.2),
    "small balls": (distances_to_small_balls, (1 / 48, 1 / 48, 1 / 48), None),
}


def pair(name: str) -> tuple[Shape, Shape, float, float]:
    """The same samples as a whole and in bricks; the spacing, and the reach."""
    if name in VOLUMES:
        make, steps, level = VOLUMES[name]
        samples = volumes.checked_samples(make())
        field = volumes.field_of(samples, "zyx", steps[::-1], level)
        per = [step / field.scale for step in steps]
        found = bricks.from_grid(field.values, tuple(per))
        dense = grid_node(Texture3D(field.values, wrap="clamp"), field.size, field.scale, None)
        sparse = brick_node(Buffer(found.numbers), found, field.size, field.scale, None)
        return Shape._of(dense), Shape._of(sparse), max(steps), found.reach * field.scale
    (points, triangles), step, sign, method = MESHES[name]
    mesh = checked(points, np.array(triangles))
    whole, found = distances(mesh, step, sign), brick_distances(mesh, step, sign)
    assert (whole.sign, found.sign, found.turned) == (method, method, whole.turned)
    assert found.topology.volume == whole.topology.volume
    np.testing.assert_array_equal(found.low, whole.low)
    count = whole.values.shape[::-1]
    dense = grid_node(
        Texture3D(whole.values, wrap="clamp"), tuple(n * step for n in count), 1.0, None
    )
    size = tuple(n * step for n in found.bricks.samples)
    sparse = brick_node(Buffer(found.bricks.numbers), found.bricks, size, 1.0, None)
    moved = [0.5 * (n - m) * step for n, m in zip(found.bricks.samples, count, strict=True)]
    return Shape._of(dense), Shape._of(sparse).translate(*moved), step, found.bricks.reach


@pytest.fixture(scope="module", params=[*MESHES, *VOLUMES])
def both(request):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bricks, "MOST_DENSE", 0)  # bricks even where they save little
        return pair(request.param)


def places_in(shape: Shape, spacing: float, count: int) -> np.ndarray:
    low, high = np.array(shape.bounds())
    return RANDOM.uniform(low + spacing, high - spacing, (count, 3))


def test_the_surface_is_that_of_all_samples(both):
    dense, sparse, spacing, reach = both
    places = places_in(dense, spacing, 30_000)
    all_, near = dense(places), sparse(places)
    # Single floats: the numbers of the place are rounded twice.
    rounding = 1e-4 * spacing
    close = np.abs(all_) < reach - SLOPE * spacing
    assert close.sum() > 50
    assert np.abs(near - all_)[close].max() < rounding
    apart = np.abs(all_) > rounding
    assert (np.sign(near) == np.sign(all_))[apart].all()


def test_elsewhere_it_is_a_lower_bound(both):
    dense, sparse, spacing, reach = both
    places = places_in(dense, spacing, 30_000)
    all_, near = np.abs(dense(places)), np.abs(sparse(places))
    assert (near <= all_ + 1e-4 * spacing).all()
    # Samples that are farther than the reach are lowered to it at most; a cell has both kinds.
    far = all_ > reach
    assert (near[far] >= reach - SLOPE * spacing).all()


def test_the_slope_holds_also_across_the_sides_of_bricks(both):
    dense, sparse, spacing, _ = both
    starts = places_in(dense, spacing, 40_000)
    steps = RANDOM.normal(size=starts.shape)
    steps *= spacing * 10.0 ** RANDOM.uniform(-1.0, 1.0, (len(steps), 1)) / 2.0
    lengths = np.linalg.norm(steps, axis=1)
    # The place is rounded to single floats: an absolute error beside each difference.
    rise = np.abs(sparse(starts + steps) - sparse(starts))
    assert (rise <= SLOPE * lengths + 1e-4 * spacing).all()


def test_values_do_not_jump_at_the_sides_of_bricks(both):
    dense, sparse, spacing, _ = both
    corner = np.array(sparse.bounds()[0])
    is_volume = sparse.node.rule.name == "BrickField"
    steps = np.array((0.025, 0.03, 0.02)) if is_volume and spacing == 0.03 else spacing
    places = places_in(dense, spacing, 30_000)
    axis = RANDOM.integers(0, 3, len(places))
    rows = np.arange(len(places))
    # The first sample is half a step from the corner of the box, and a brick has 8 cells.
    samples = (places - corner) / steps - 0.5
    samples[rows, axis] = np.round(samples[rows, axis] / 8.0) * 8.0
    at = corner + (samples + 0.5) * steps
    step = np.zeros_like(at)
    step[rows, axis] = 0.01 * spacing
    jump = np.abs(sparse(at + step) - sparse(at - step))
    assert jump.max() <= SLOPE * 0.02 * spacing + 1e-4 * spacing


@pytest.mark.parametrize("name", ["small balls", "torus"])
def test_values_at_corners_of_bricks_rise_by_their_distance_at_most(name):
    if name in VOLUMES:
        spacing = 1 / 48
        found = bricks.from_grid(distances_to_small_balls().astype(np.float32), (spacing,) * 3)
    else:
        spacing = 0.02
        found = brick_distances(checked(*torus(48, 24)), spacing).bricks
    x, y, z = map(bricks.bricks_along, found.samples)
    index, corners, _ = np.split(found.numbers, np.cumsum([x * y * z, (x + 1) * (y + 1) * (z + 1)]))
    corners = corners.reshape(z + 1, y + 1, x + 1)
    rises = [np.abs(np.diff(corners, axis=axis)) for axis in range(3)]
    most = bricks.CELLS * spacing
    assert max(map(np.max, rises)) <= most * (1.0 + 1e-5)
    # It is reached: values are no lower than they have to be.
    assert max(map(np.max, rises)) > 0.99 * most
    # Corners of stored bricks are not above the reach, which is the value beyond their sides.
    k, j, i = np.nonzero(index.reshape(z, y, x) > 0)
    for step in np.ndindex(2, 2, 2):
        assert corners[k + step[0], j + step[1], i + step[2]].max() <= found.reach


def test_a_larger_hole_needs_all_samples():
    points, triangles = SPHERE
    middle = points[triangles].mean(axis=1)
    mesh = checked(points, triangles[middle[:, 1] < 0.8])
    assert brick_distances(mesh, 0.05) is None
    assert distances(mesh, 0.05).sign == "winding"


def test_a_mesh_uses_bricks_above_a_number_of_samples(monkeypatch):
    arrays = torus(24, 12)
    whole = Shape.from_mesh(*arrays, spacing=0.05)
    assert whole.imported[0].bricks == 0 and "bricks" not in str(whole.imported[0])
    monkeypatch.setattr(importing, "_MOST_WHOLE", 1000)
    parts = Shape.from_mesh(*arrays, spacing=0.05)
    report = parts.imported[0]
    assert report.bricks > 50 and f"stored in {report.bricks} bricks" in str(report)
    assert report.largest == pytest.approx(whole.imported[0].largest, rel=1e-3)
    places = RANDOM.uniform(-1.3, 1.3, (5000, 3))
    near = np.abs(whole(places)) < 2.0 * 0.05
    assert np.abs(parts(places) - whole(places))[near].max() < 1e-5


def test_a_volume_uses_bricks_where_they_are_smaller():
    z, y, x = np.mgrid[-1:1:97j, -1:1:97j, -1:1:97j]
    ball = np.sqrt(x * x + y * y + z * z).astype(np.float32) - np.float32(0.4)
    shape = Shape.from_volume(ball, spacing=2 / 96)
    assert shape.node.rule.name == "BrickField"
    (values,) = (c for c in shape.node.constants.values() if isinstance(c, Buffer))
    assert len(values.data) < 0.5 * ball.size
    assert Shape.from_volume(ball[::4, ::4, ::4], spacing=1 / 12).node.rule.name == "VolumeField"
    places = RANDOM.uniform(-1.0, 1.0, (5000, 3))
    true = np.linalg.norm(places, axis=1) - 0.4
    near = np.abs(true) < 2 / 96
    # spacing^2 / 8 times two curvatures of 1 / radius
    assert np.abs(shape(places) - true)[near].max() < (2 / 96) ** 2 / 8.0 * 2.0 / 0.37
    # Beyond the volume, a lower bound as before.
    far = RANDOM.normal(size=(3000, 3)) * 4.0
    far = far[np.abs(far).max(axis=1) > 1.02]
    assert (shape(far) <= np.linalg.norm(far, axis=1) - 0.4 + 1e-3).all()
    assert (shape(far) > 0.0).all()
    # It grows with the distance: a brick and half of the way less than the distance at most.
    corner = np.array((0.9, 0.9, 0.9))
    assert shape(corner) > np.linalg.norm(corner) - 0.4 - 12 * 2 / 96 - 0.05


@pytest.mark.parametrize("spacing", [0.004, 0.0001])
def test_too_many_bricks_are_refused_and_the_spacing_that_is_named_is_enough(spacing, monkeypatch):
    monkeypatch.setattr(sparse, "MOST_NUMBERS", 2_000_000)
    with pytest.raises(LoadError) as caught:
        brick_distances(checked(*box()), spacing)
    text = caught.value.message
    assert text.startswith(f"a spacing of {spacing:g} needs ")
    assert "numbers near the surface, more than 2,000,000" in text
    enough = float(text.split("a spacing of ")[-1].split()[0])
    found = brick_distances(checked(*box()), enough)
    # Not far coarser than needed: half of the numbers at least.
    assert 0.3 * 2_000_000 < found.bricks.numbers.size <= 2_000_000


def test_a_volume_of_too_many_numbers_is_refused(monkeypatch):
    monkeypatch.setattr(bricks, "MOST_NUMBERS", 5000)
    monkeypatch.setattr(bricks, "MOST_DENSE", 0)
    z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
    with pytest.raises(SceneValueError) as caught:
        Shape.from_volume(np.sqrt(x * x + y * y + z * z) - 0.5, spacing=2 / 31)
    assert "numbers, more than 5,000: leave some out" in str(caught.value)


@pytest.fixture(scope="module")
def scene() -> Scene:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(importing, "_MOST_WHOLE", 1000)
        ring = Shape.from_mesh(*torus(48, 24), spacing=0.04)
    assert ring.imported[0].bricks
    camera = Camera(position=(1.5, 1.8, 2.5), target=(0.0, 0.0, 0.0))
    return Scene(ring.twist(0.3) | Sphere(0.35), camera=camera)


def test_the_reference_draws_the_cpu_picture(scene):
    cpu = scene.render(size=(24, 18), samples=1).array
    assert cpu[..., :3].std() > 0.05
    found = difference(scene.render(size=(24, 18), samples=1, device="reference").array, cpu)
    assert found.is_agreement, found


@pytest.mark.parametrize("target", TARGETS)
def test_drivers_draw_the_cpu_picture(scene, target):
    found = difference(drawn(scene, target), scene.render(size=SIZE, samples=1).array)
    assert found.is_agreement, found


def test_it_compiles_to_every_target_with_buffers(scene):
    for target in ("glsl-es300", "wgsl", "llvm", "glsl-330"):
        assert len(compile(scene, target=target).text) > 200


def test_a_page_carries_the_numbers_as_they_are(scene):
    made = payload(viewable(scene), PageOptions(size=SIZE, views=("color",)))
    (stored,) = (
        r for r in made["resources"].values() if r["type"] == "buffer" and r["size"][0] > 999
    )
    assert stored["format"] == "float32" and stored["components"] == 1
    assert len(base64.b64decode(stored["data"])) == 4 * stored["size"][0]
