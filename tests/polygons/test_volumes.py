"""Volumes of samples: what is read from files, and the solids that are made of them."""

import gzip
import io
import struct
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from distal import Shape
from distal.diagnostics import LoadError
from distal.polygons.nifti import read_nifti
from distal.polygons.nrrd import read_nrrd
from distal.polygons.volumes import read_npy, read_volume
from distal.scene.tree.errors import SceneValueError

COUNTS = (9, 11, 13)  # along x, y and z
SPACING = (0.3, 0.25, 0.2)
X, Y, Z = ((np.arange(n) - (n - 1) / 2.0) * s for n, s in zip(COUNTS, SPACING, strict=True))
# A ball of radius 0.8 about (0.1, 0, -0.2), as (z, y, x).
BALL = np.sqrt(
    (X[None, None] - 0.1) ** 2 + Y[None, :, None] ** 2 + (Z[:, None, None] + 0.2) ** 2
).astype(np.float32) - np.float32(0.8)


def nrrd(values=BALL, encoding="raw", more="spacings: 0.3 0.25 0.2", type="float") -> bytes:
    sizes = " ".join(map(str, values.shape[::-1]))
    head = f"NRRD0004\n# made by a test\ntype: {type}\ndimension: 3\nsizes: {sizes}\n"
    head += f"endian: little\nencoding: {encoding}\n{more}\n\n"
    data = values.tobytes()
    return head.encode() + (gzip.compress(data, mtime=0) if encoding == "gzip" else data)


def nifti(values=BALL, order="<", code=16, slope=0.0, shift=0.0) -> bytes:
    head = bytearray(352)
    struct.pack_into(f"{order}i", head, 0, 348)
    struct.pack_into(f"{order}8h", head, 40, 3, *values.shape[::-1], 1, 1, 1, 1)
    struct.pack_into(f"{order}h", head, 70, code)
    struct.pack_into(f"{order}8f", head, 76, 1.0, *SPACING, 0, 0, 0, 0)
    struct.pack_into(f"{order}3f", head, 108, 352.0, slope, shift)
    head[344:348] = b"n+1\0"
    return bytes(head) + values.astype(values.dtype.newbyteorder(order)).tobytes()


def npy(values=BALL) -> bytes:
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


READERS = {
    ".npy": read_npy,
    ".nrrd": lambda data: read_nrrd(data, Path("nowhere")),
    ".nii": read_nifti,
    ".nii.gz": read_nifti,
}
FILES = [
    ("a.npy", npy()),
    ("a.nrrd", nrrd()),
    ("a.nrrd", nrrd(encoding="gzip").replace(b"\n", b"\r\n", 9)),
    ("a.nrrd", nrrd(more="space directions: (0,0.3,0) (0.25,0,0) (0,0,-0.2)")),
    ("a.nii", nifti()),
    ("a.nii", nifti(order=">")),
    ("a.nii.gz", gzip.compress(nifti())),
]


@pytest.mark.parametrize(("name", "data"), FILES)
def test_samples_are_read_in_their_order(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    found = read_volume(tmp_path / name)
    assert np.array_equal(found.values, BALL)
    if name == "a.npy":
        assert found.spacing is None
    else:
        assert found.spacing == pytest.approx(SPACING)


def test_nifti_scales_its_integers(tmp_path):
    whole = np.rint(BALL * 1000.0).astype(np.int16)
    (tmp_path / "a.nii").write_bytes(nifti(whole, code=4, slope=0.001, shift=0.5))
    assert read_volume(tmp_path / "a.nii").values == pytest.approx(BALL + 0.5, abs=6e-4)


def of_ball(p):
    return np.linalg.norm(p - np.array((0.1, 0.0, -0.2)), axis=-1) - 0.8


PLACES = np.random.default_rng(8).uniform(-1.0, 1.0, (500, 3))


@pytest.mark.parametrize("axes", ["zyx", "xyz", "yzx"])
def test_the_axes_of_an_array_are_named(axes):
    array = np.transpose(BALL, ["zyx".index(axis) for axis in axes])
    ball = Shape.from_volume(array, spacing=SPACING, axes=axes)
    at = PLACES[of_ball(PLACES) > -0.4]
    at = at[(np.abs(at) < np.array(SPACING) * (np.array(COUNTS) - 1) / 2.0).all(axis=1)]
    # Spacing^2 / 8 times the curvature along each axis, which is at most 1 / radius; a cell
    # reaches half its diagonal, 0.22, farther in.
    most = sum(s * s for s in SPACING) / 8.0 / (of_ball(at) + 0.8 - 0.22)
    assert (np.abs(ball(at) - of_ball(at)) < most).all()
    assert ball.bounds()[1] == pytest.approx(
        [n * s / 2 for n, s in zip(COUNTS, SPACING, strict=True)]
    )


def test_a_file_gives_its_spacing(tmp_path):
    (tmp_path / "a.nrrd").write_bytes(nrrd())
    one = Shape.from_volume(tmp_path / "a.nrrd")
    other = Shape.from_volume(BALL, spacing=SPACING)
    assert np.array_equal(one(PLACES), other(PLACES))
    twice = Shape.from_volume(tmp_path / "a.nrrd", spacing=[2 * s for s in SPACING])
    assert twice.bounds()[1][0] == pytest.approx(2 * one.bounds()[1][0])


def test_a_level_is_where_the_surface_is():
    density = 100.0 - 40.0 * BALL  # 100 at the surface, more inside
    ball = Shape.from_volume(density, spacing=SPACING, level=100.0)
    assert np.abs(np.where(np.abs(of_ball(PLACES)) < 0.02, ball(PLACES), 0.0)).max() < 0.06
    away = np.abs(of_ball(PLACES)) > 0.06
    assert ((ball(PLACES) < 0.0) == (of_ball(PLACES) < 0.0))[away].all()
    assert np.linalg.norm(ball.gradient(PLACES), axis=1).max() < 3.0**0.5 + 1e-4


def test_samples_that_are_too_steep_are_divided_with_a_warning():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        steep = Shape.from_volume(3.0 * BALL, spacing=SPACING)
    (warning,) = caught
    assert str(warning.message).startswith("neighboring samples differ by up to ")
    assert warning.filename == __file__
    assert np.linalg.norm(steep.gradient(PLACES), axis=1).max() < 3.0**0.5 + 1e-4


WRONG = [
    (np.zeros((4, 4)), {}, "samples are numbers (z, y, x), 2 or more along each, not float64"),
    (np.full((4, 4, 4), np.nan), {}, "a sample is not finite"),
    (np.ones((4, 4, 4)), {}, "nothing is inside: the samples are 1 to 1; give level="),
    (np.ones((4, 4, 4)), {"level": 2}, "nothing is inside: the samples are 1 to 1; give another"),
    (-np.ones((4, 4, 4)), {}, "all samples are equal: there is no surface"),
    (BALL, {"axes": "xyy"}, "axes are 'zyx' or another order of the three, not 'xyy'"),
    (BALL, {"spacing": (1.0, 2.0)}, "a spacing is one number or three, not 2"),
    (BALL, {"spacing": 0.0}, "a spacing is above 0, not 0"),
    ("none.nrrd", {}, "cannot read 'none.nrrd': No such file or directory"),
    ("a.dcm", {}, "cannot read 'a.dcm': a volume's suffix is one of .npy, .nrrd, .nhdr, .nii, "),
]


@pytest.mark.parametrize(("source", "options", "message"), WRONG)
def test_wrong_volumes_are_refused_at_the_line(source, options, message):
    with pytest.raises(SceneValueError) as caught:
        Shape.from_volume(source, **options)
    assert str(caught.value).startswith(f"error: {message}")
    assert "test_volumes.py" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.nrrd", nrrd()[:-4], "it announces 1,287 samples and contains 1,286: it is truncated"),
        ("a.nrrd", nrrd(encoding="hex"), "its encoding 'hex' is not read: save it as raw, gzip"),
        ("a.nrrd", nrrd(more="data file: a/b.raw"), "its samples are in 'a/b.raw', which is no"),
        ("a.nrrd", nrrd(type="block"), "it is no volume of numbers with one component"),
        ("a.nii", nifti(code=128), "its samples are no real numbers"),
        ("a.nii.gz", gzip.compress(nifti())[:-40], "its compressed part is damaged"),
        ("a.npy", npy()[:60], "NumPy says: "),
        (
            "a.npy",
            npy(np.array([None])),
            "samples are numbers (z, y, x), 2 or more along each, not object",
        ),
    ],
)
def test_wrong_files_are_refused_with_their_reason(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(LoadError) as caught:
        read_volume(tmp_path / name)
    assert f"{name}' is no volume that can be read: {message}" in caught.value.message


@settings(max_examples=300, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_bytes_never_end_in_another_exception(data):
    name, content = FILES[data.draw(st.integers(0, len(FILES) - 1))]
    damaged = bytearray(content)
    for _ in range(data.draw(st.integers(0, 3))):
        at = data.draw(st.integers(0, min(len(damaged), 400) - 1))
        damaged[at] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        damaged = damaged[: data.draw(st.integers(0, len(damaged)))]
    try:
        found = READERS[name[1:]](bytes(damaged))
    except LoadError as error:
        assert error.message
    else:
        assert np.isfinite(found.values).all() and found.values.ndim == 3
