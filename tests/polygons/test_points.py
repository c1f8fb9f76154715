"""Solids from points with normals, against closed forms."""

import warnings

import numpy as np
import pytest

from distal import Camera, Scene, Shape, compile
from distal.diagnostics import LoadError
from distal.lang import notices
from distal.polygons.clouds import cloud_distances
from distal.polygons.points import checked_points, read_points
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.parity.test_scenes import TARGETS, difference, drawn

SLOPE = 3.0**0.5


def on_sphere(rng, count):
    p = rng.normal(size=(count, 3))
    p /= np.linalg.norm(p, axis=1)[:, None]
    return p, p


def on_box(rng, count):
    p, n = rng.uniform(-1.0, 1.0, (count, 3)), np.zeros((count, 3))
    rows, axis = np.arange(count), rng.integers(0, 3, count)
    p[rows, axis] = n[rows, axis] = rng.choice([-1.0, 1.0], count)
    return p, n


def on_torus(rng, count):
    u, v = rng.uniform(0.0, 2.0 * np.pi, (2, 4 * count))
    kept = np.flatnonzero(rng.uniform(0.0, 1.25, 4 * count) < 1.0 + 0.25 * np.cos(v))[:count]
    u, v = u[kept], v[kept]
    n = np.stack([np.cos(v) * np.cos(u), np.sin(v), np.cos(v) * np.sin(u)], axis=1)
    return np.stack([np.cos(u), 0.0 * u, np.sin(u)], axis=1) + 0.25 * n, n


def of_sphere(p):
    return np.linalg.norm(p, axis=-1) - 1.0


def of_box(p):
    q = np.abs(p) - 1.0
    return np.linalg.norm(np.maximum(q, 0.0), axis=-1) + np.minimum(q.max(axis=-1), 0.0)


def of_torus(p):
    return np.hypot(np.hypot(p[..., 0], p[..., 2]) - 1.0, p[..., 1]) - 0.25


# How to sample a solid, its distance, its area.
SOLIDS = {
    "sphere": (on_sphere, of_sphere, 4.0 * np.pi),
    "box": (on_box, of_box, 24.0),
    "torus": (on_torus, of_torus, np.pi**2),
}
# The largest and the mean error on the surface, in distances of points: random points, without
# noise; the edges of a box are rounded.
ERRORS = {"sphere": (0.06, 0.015), "box": (0.75, 0.05), "torus": (0.2, 0.025)}


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", SOLIDS)
def test_random_points_give_the_solid_within_a_part_of_their_distance(name, seed):
    sample, true, area = SOLIDS[name]
    rng = np.random.default_rng(seed)
    apart = (area / 3000) ** 0.5
    solid = Shape.from_points(*sample(rng, 3000))
    report = solid.imported[0]
    assert report.apart == pytest.approx(apart, rel=0.1)
    off = np.abs(solid(sample(rng, 5000)[0])) / apart
    assert off.max() < ERRORS[name][0] and off.mean() < ERRORS[name][1]
    low, high = np.array(solid.bounds())
    places = rng.uniform(low, high, (20_000, 3))
    values, distance = solid(places), true(places)
    assert ((values < 0.0) == (distance < 0.0))[np.abs(distance) > apart].all()
    # Away from the points the distance is that to triangles with gaps between them.
    assert (np.abs(values) <= np.abs(distance) + 0.5 * report.spacing + 0.1 * apart).all()
    far = distance > 3.0 * apart
    assert (values[far] > 0.6 * distance[far]).all() and np.median(
        values[far] / distance[far]
    ) > 0.9


@pytest.mark.parametrize("name", SOLIDS)
def test_noise_is_smoothed(name):
    sample, _, area = SOLIDS[name]
    rng = np.random.default_rng(3)
    apart = (area / 4000) ** 0.5
    points, normals = sample(rng, 4000)
    noise = 0.25 * apart * rng.normal(size=(4000, 1))
    turned = normals + 0.1 * rng.normal(size=normals.shape)
    solid = Shape.from_points(points + noise * normals, turned)
    off = np.abs(solid(sample(rng, 5000)[0])) / apart
    # The mean of the noise is .2 of the distance of points.
    assert off.mean() < 0.09 and off.max() < 0.75
    assert solid.imported[0].mean == pytest.approx(0.2 * apart, rel=0.25)


def test_more_points_are_nearer_to_the_sphere():
    errors = []
    for count in (500, 2000, 8000):
        solid = Shape.from_points(*on_sphere(np.random.default_rng(4), count))
        errors.append(np.abs(solid(on_sphere(np.random.default_rng(5), 4000)[0])).mean())
    # A plane through each point errs with the square of the distance, a quarter each time; chords
    # of a sphere are exact, what is left is the interpolation between the samples of the grid.
    assert errors[1] < 0.4 * errors[0] and errors[2] < 0.4 * errors[1]


def test_the_slope_holds():
    rng = np.random.default_rng(6)
    points, normals = on_box(rng, 2000)
    solid = Shape.from_points(points + 0.02 * rng.normal(size=points.shape), normals)
    step = solid.imported[0].spacing
    starts = rng.uniform(-1.3, 1.3, (30_000, 3))
    moves = rng.normal(size=starts.shape) * step * 10.0 ** rng.uniform(-1.0, 0.7, (30_000, 1))
    rise = np.abs(solid(starts + moves) - solid(starts))
    assert (rise <= SLOPE * np.linalg.norm(moves, axis=1) + 1e-4 * step).all()


def noisy_box():
    rng = np.random.default_rng(17)
    points, normals = on_box(rng, 3000)
    return points + 0.04 * rng.normal(size=points.shape), normals


def bowl():
    points, normals = on_sphere(np.random.default_rng(18), 3000)
    return points[points[:, 1] < 0.4], normals[points[:, 1] < 0.4]


@pytest.mark.parametrize("points", [noisy_box, bowl])
def test_neighbors_differ_by_their_distance_at_most(points):
    found = cloud_distances(checked_points(*points()), 0.05)
    for axis in range(3):
        assert np.abs(np.diff(found.values, axis=axis)).max() <= 0.05 * (1.0 + 1e-4)


@pytest.mark.parametrize(("scale", "away"), [(1e-9, 1e-3), (1e9, 1e13), (1.0, 1e6)])
def test_size_and_place_do_not_matter(scale, away):
    points, normals = on_torus(np.random.default_rng(7), 2000)
    usual = Shape.from_points(points, normals)
    other = Shape.from_points(points * scale + away, normals * 3.0)
    assert other.imported[0].spacing == pytest.approx(usual.imported[0].spacing * scale, rel=1e-6)
    assert other.imported[0].mean == pytest.approx(usual.imported[0].mean * scale, rel=1e-2)


def test_holes_are_closed():
    points, normals = on_sphere(np.random.default_rng(8), 4000)
    kept = points[:, 1] < 0.6
    solid = Shape.from_points(points[kept], normals[kept], spacing=0.05)
    report = solid.imported[0]
    assert not report.is_closed and "with holes, which are closed" in str(report)
    assert Shape.from_points(points, normals).imported[0].is_closed
    # The lid lies between the hole's plane and the sphere.
    assert solid((0.0, 0.55, 0.0)) < 0.0 < solid((0.0, 1.05, 0.0))
    places = np.random.default_rng(9).uniform(-1.0, 1.0, (5000, 3))
    below = places[(places[:, 1] < 0.3) & (np.abs(of_sphere(places)) > 0.03)]
    assert ((solid(below) < 0.0) == (of_sphere(below) < 0.0)).all()


def warned(*arrays, **options):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solid = Shape.from_points(*arrays, **options)
    assert all(w.filename == __file__ for w in caught)
    return solid, [str(w.message) for w in caught]


def test_normals_that_point_inwards_are_turned_with_a_warning():
    points, normals = on_torus(np.random.default_rng(10), 2000)
    usual, none = warned(points, normals)
    solid, said = warned(points, -normals)
    assert none == []
    assert said == [
        "the normals of 'arrays' point inwards: they were turned around; flip them in the file"
    ]
    assert solid.imported[0].turned and solid((1.0, 0.0, 0.0)) == usual((1.0, 0.0, 0.0)) < 0.0


def test_single_wrong_normals_are_left_out_with_a_warning():
    points, normals = on_sphere(np.random.default_rng(11), 3000)
    flipped = normals.copy()
    flipped[:90] *= -1.0
    solid, said = warned(points, flipped)
    assert said == [
        "90 of the 3,000 normals of 'arrays' point away from those about them: these points are "
        "left out; orient them alike"
    ]
    assert np.abs(solid(points)).max() < 0.01


POINTS, NORMALS = on_sphere(np.random.default_rng(12), 600)


def with_row(array, row, value):
    changed = array.copy()
    changed[row] = value
    return changed


WRONG = [
    ((POINTS[:9], NORMALS[:9]), {}, "9 points are too few: give 10 or more"),
    ((POINTS, NORMALS[:-1]), {}, "there are 600 points and 599 normals"),
    ((POINTS[:, :2], NORMALS), {}, "points are numbers (n, 3), not float64 (600, 2)"),
    ((POINTS, with_row(NORMALS, 7, 0.0)), {}, "normal 7 is zero: leave the point out, or give"),
    ((POINTS, with_row(NORMALS, 8, np.nan)), {}, "normal 8 is (nan, nan, nan), which is no dir"),
    ((with_row(POINTS, 9, np.inf), NORMALS), {}, "point 9 is (inf, inf, inf), which is no place"),
    ((POINTS * 0.0, NORMALS), {}, "all points are in one place: there is no surface"),
    ((with_row(POINTS, 0, 1e12), NORMALS), {}, "the points are too near to each other for the"),
    (
        (POINTS * (1.0, 0.0, 1.0), NORMALS * 0.0 + (0.0, 1.0, 0.0)),
        {},
        "the points enclose nothing: are there points on all sides of the solid?",
    ),
    ((POINTS, NORMALS), {"spacing": 3.0}, "the spacing 3 is not smaller than the cloud, "),
    ((POINTS, NORMALS), {"spacing": 0.001}, "a spacing of 0.001 needs 14,"),
    ((POINTS, NORMALS), {"spacing": -1.0}, "a spacing is above 0, not -1"),
    ((POINTS, NORMALS), {"radius": "wide"}, "'radius' takes a number, not str 'wide'"),
    ((POINTS, NORMALS), {"up": "x"}, "up is 'y' or 'z', not 'x'"),
    ((POINTS, NORMALS), {"unit": "yard"}, "a unit is one of um, mm, cm, m, inch, ft, not 'yard'"),
    (("none.ply",), {}, "cannot read 'none.ply': No such file or directory"),
    (("a.las",), {}, "cannot read 'a.las': points with normals are in one of .ply, .obj, .xyz"),
]


@pytest.mark.parametrize(("arguments", "options", "message"), WRONG)
def test_wrong_points_are_refused_at_the_line(arguments, options, message):
    with pytest.raises(SceneValueError) as caught:
        Shape.from_points(*arguments, **options)
    assert str(caught.value).startswith(f"error: {message}")
    assert "test_points.py" in str(caught.value)


def test_normals_without_an_order_are_refused():
    normals = np.random.default_rng(13).normal(size=POINTS.shape)
    with pytest.raises(SceneValueError, match=r"\d+% of the normals point away from those about"):
        Shape.from_points(POINTS, normals)


def test_what_is_no_cloud_is_refused():
    with pytest.raises(SceneTypeError, match="points are a file or two arrays, not int"):
        Shape.from_points(7)
    with pytest.raises(SceneTypeError, match="not ndarray without normals"):
        Shape.from_points(POINTS)


def ply(rows, order="ascii"):
    head = f"ply\nformat {order} 1.0\nelement vertex {len(rows)}\n"
    head += "".join(f"property float {n}\n" for n in ("x", "y", "z", "nx", "ny", "nz"))
    head += "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    if order == "ascii":
        return head.encode() + "\n".join(" ".join(map(str, row)) for row in rows).encode() + b"\n"
    kind = "<f4" if "little" in order else ">f4"
    return head.encode() + rows.astype(kind).tobytes()


ROWS = np.concatenate([POINTS, NORMALS], axis=1).astype(np.float32)
OBJ = "".join(
    f"v {a} {b} {c}\nvn {d} {e} {f}\n" for a, b, c, d, e, f in ROWS.astype(float).tolist()
)
XYZ = "# x y z nx ny nz\n" + "".join(
    f"{' '.join(map(str, row))} 255 0 0\n" for row in ROWS.tolist()
)
FILES = {
    "text.ply": ply(ROWS.astype(float)),
    "little.ply": ply(ROWS, "binary_little_endian"),
    "big.ply": ply(ROWS, "binary_big_endian"),
    "a.obj": OBJ.encode(),
    "a.xyz": XYZ.encode(),
    "commas.xyz": XYZ.replace(" ", ", ").encode(),
}


@pytest.mark.parametrize("name", FILES)
def test_files_are_read(tmp_path, name):
    (tmp_path / name).write_bytes(FILES[name])
    found = read_points(tmp_path / name)
    np.testing.assert_allclose(found.points, ROWS[:, :3], atol=1e-7)
    np.testing.assert_allclose(found.normals, ROWS[:, 3:], atol=1e-6)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.ply", FILES["text.ply"].replace(b"nx", b"mx"), "its points have no nx"),
        ("a.ply", FILES["little.ply"][:-2000], "it is truncated: 'vertex' has 600 rows"),
        ("a.xyz", b"1 2 3\n", "line 1 has 3 numbers: x, y, z and a normal are 6"),
        ("a.xyz", b"1 2 3 0 0 up\n", "line 1 has no numbers: b'1 2 3 0 0 up'"),
        ("a.xyz", b"# nothing\n", "0 points are too few: give 10 or more"),
        ("a.obj", b"v 1 2 3\nvn 1 2\n", "line 2: vn needs three numbers"),
        ("a.obj", b"v 1 2 3\n" * 12, "there are 12 points and 0 normals"),
    ],
)
def test_wrong_files_are_refused_with_their_reason(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(LoadError) as caught:
        read_points(tmp_path / name)
    assert f"{name}' is no file of points that can be read: {message}" in caught.value.message


def test_units_and_axes_of_a_file(tmp_path):
    points, normals = on_torus(np.random.default_rng(14), 1500)
    rows = np.concatenate([points * 10.0, normals], axis=1)[:, [0, 2, 1, 3, 5, 4]]
    rows[:, [1, 4]] *= -1.0  # z is up: the torus lies
    (tmp_path / "a.xyz").write_text("\n".join(" ".join(map(str, row)) for row in rows.tolist()))
    solid = Shape.from_points(tmp_path / "a.xyz", unit="cm", up="z")
    assert solid((1.0, 0.0, 0.0)) < -0.15 and solid((0.0, 1.0, 0.0)) > 0.5


def test_a_command_is_told(monkeypatch):
    lines = []
    monkeypatch.setattr(notices, "_hosts", [lines.append])
    monkeypatch.setattr(notices, "_given", set())
    report = Shape.from_points(POINTS, NORMALS).imported[0]
    assert lines == [
        f"'arrays' is sampled every {report.spacing:.4g}: its points are off the surface by up to "
        f"{report.largest:.2g}, {report.mean:.2g} on average, measured at 600 points; parts "
        f"thinner than {report.radius:.4g} may be missing; spacing={report.spacing / 2:.3g} is "
        "finer"
    ]


def test_a_radius_smooths_more():
    rng = np.random.default_rng(15)
    points, normals = on_sphere(rng, 3000)
    points = points + 0.03 * rng.normal(size=(3000, 1)) * normals
    usual, wide = (Shape.from_points(points, normals, radius=r) for r in (None, 0.4))
    off = [np.abs(s(on_sphere(rng, 3000)[0])).mean() for s in (usual, wide)]
    assert off[1] < 0.7 * off[0]


def test_distances_are_the_same_each_time():
    cloud = checked_points(POINTS, NORMALS)
    once, again = cloud_distances(cloud), cloud_distances(cloud)
    assert np.array_equal(once.values, again.values)


@pytest.fixture(scope="module")
def scene() -> Scene:
    ring = Shape.from_points(*on_torus(np.random.default_rng(16), 2000))
    camera = Camera(position=(1.5, 1.8, 2.5), target=(0.0, 0.0, 0.0))
    return Scene(ring.round(0.02), camera=camera)


@pytest.mark.parametrize("target", TARGETS)
def test_drivers_draw_the_cpu_picture(scene, target):
    cpu = scene.render(size=(96, 72), samples=1).array
    assert cpu[..., :3].std() > 0.05
    found = difference(drawn(scene, target), cpu)
    assert found.is_agreement, found


def test_it_compiles_to_every_target(scene):
    for target in ("glsl-es300", "wgsl", "llvm", "glsl-330"):
        assert len(compile(scene, target=target).text) > 200
