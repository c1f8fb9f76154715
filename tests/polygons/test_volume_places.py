"""Where the samples of NIfTI and NRRD are: a marked sample against the affine of its header."""

import bz2
import gzip
import itertools
import struct

import numpy as np
import pytest

from distal import Shape
from distal.diagnostics import LoadError
from distal.polygons.volumes import matrix_of, read_volume
from distal.scene.tree.errors import SceneValueError

COUNTS = (5, 6, 7)  # along x, y and z
MARK = (1, 4, 2)
STEPS = np.array((1.0, 1.5, 2.0))
ORIGIN = np.array((-3.0, 40.0, 7.5))
INDICES = np.stack(np.meshgrid(*map(np.arange, COUNTS), indexing="ij"), -1).reshape(-1, 3)
VALUES = np.zeros(COUNTS[::-1], np.float32)
VALUES[MARK[::-1]] = 1.0


def signed_permutations():
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            yield np.eye(3)[list(order)] * signs


def turned(seed, mirrored):
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    q *= np.linalg.det(q)
    return q @ np.diag((1.0, 1.0, -1.0)) if mirrored else q


ALL = [*signed_permutations(), *(turned(i, i % 2) for i in range(6))]


def quaternion(turn):
    """Return b, c and d of a rotation, by the largest of its four squares."""
    rows = np.array(
        [
            [turn[0, 0] - turn[1, 1] - turn[2, 2], 0, 0, 0],
            [turn[1, 0] + turn[0, 1], turn[1, 1] - turn[0, 0] - turn[2, 2], 0, 0],
            [
                turn[2, 0] + turn[0, 2],
                turn[2, 1] + turn[1, 2],
                turn[2, 2] - turn[0, 0] - turn[1, 1],
                0,
            ],
            [
                turn[2, 1] - turn[1, 2],
                turn[0, 2] - turn[2, 0],
                turn[1, 0] - turn[0, 1],
                np.trace(turn),
            ],
        ]
    )
    vector = np.linalg.eigh(rows)[1][:, -1]
    return vector[:3] * np.sign(vector[3] or 1.0)


def nifti1(turn, *, way="sform", units=2, order="<", values=VALUES, shear=None):
    head = bytearray(352)
    columns = turn * STEPS if shear is None else turn * STEPS @ shear
    struct.pack_into(f"{order}i", head, 0, 348)
    struct.pack_into(f"{order}8h", head, 40, 3, *values.shape[::-1], 1, 1, 1, 1)
    struct.pack_into(f"{order}h", head, 70, 16)
    sign = np.sign(np.linalg.det(turn))
    struct.pack_into(f"{order}8f", head, 76, sign, *STEPS, 0, 0, 0, 0)
    struct.pack_into(f"{order}3f", head, 108, 352.0, 0.0, 0.0)
    head[123] = units
    if way == "sform":
        struct.pack_into(f"{order}2h", head, 252, 1, 2)
        rows = np.concatenate([columns, ORIGIN[:, None]], axis=1)
        struct.pack_into(f"{order}12f", head, 280, *rows.ravel())
    elif way == "qform":
        struct.pack_into(f"{order}2h", head, 252, 1, 0)
        proper = turn @ np.diag((1.0, 1.0, sign))
        struct.pack_into(f"{order}6f", head, 256, *quaternion(proper), *ORIGIN)
    head[344:348] = b"n+1\0"
    return bytes(head) + values.astype(f"{order}f4").tobytes()


def nifti2(turn, order=">"):
    head = bytearray(544)
    struct.pack_into(f"{order}i8sh", head, 0, 540, b"n+2\0\r\n\x1a\n", 16)
    struct.pack_into(f"{order}8q", head, 16, 3, *COUNTS, 1, 1, 1, 1)
    struct.pack_into(f"{order}8d", head, 104, 1.0, *STEPS, 0, 0, 0, 0)
    struct.pack_into(f"{order}q2d", head, 168, 544, 0.0, 0.0)
    struct.pack_into(f"{order}2i", head, 344, 0, 4)
    rows = np.concatenate([turn * STEPS, ORIGIN[:, None]], axis=1)
    struct.pack_into(f"{order}12d", head, 400, *rows.ravel())
    struct.pack_into(f"{order}i", head, 500, 2)
    return bytes(head) + VALUES.astype(f"{order}f4").tobytes()


def nrrd(turn, space="left-posterior-superior", more="", encoding="raw", data=None):
    sides = {"l": -1.0, "p": -1.0}
    signs = [sides.get(word[0], 1.0) for word in space.lower().split("-")]
    if len(space) == 3:
        signs = [sides.get(letter, 1.0) for letter in space.lower()]
    columns = (turn * STEPS).T * signs
    vectors = " ".join(f"({','.join(map(repr, map(float, c)))})" for c in columns)
    origin = ",".join(map(repr, map(float, ORIGIN * signs)))
    head = (
        f"NRRD0005\ntype: float\ndimension: 3\nspace: {space}\nsizes: 5 6 7\n"
        f"space directions: {vectors}\nkinds: domain domain domain\nendian: little\n"
        f"encoding: {encoding}\nspace origin: ({origin})\nnote:=spacings: 9 9 9\n{more}\n"
    )
    return head.encode() + (VALUES.tobytes() if data is None else data)


def worlds(turn, scale=1.0):
    return scale * (INDICES @ (turn * STEPS).T + ORIGIN)


def check_marked(path, places):
    """The marked sample, and no other, is inside where the header says."""
    shape = Shape.from_volume(path, level=0.5)
    inside = shape(places) < 0.0
    assert INDICES[inside].tolist() == [list(MARK)]


FORMS = {
    "a.nii": nifti1,
    "q.nii": lambda turn: nifti1(turn, way="qform", order=">"),
    "b.nii": nifti2,
    "lps.nrrd": nrrd,
    "ras.nrrd": lambda turn: nrrd(turn, "RAS"),
    "las.nrrd": lambda turn: nrrd(turn, "left-anterior-superior"),
}


@pytest.mark.parametrize("name", FORMS)
def test_every_orientation_is_that_of_the_header(tmp_path, name):
    for turn in ALL:
        (tmp_path / name).write_bytes(FORMS[name](turn))
        samples = read_volume(tmp_path / name)
        matrix = np.array(matrix_of(samples, None))
        middle = (np.array(COUNTS) - 1) / 2.0
        places = ((INDICES - middle) * samples.spacing) @ matrix[:, :3].T + matrix[:, 3]
        assert places == pytest.approx(worlds(turn), abs=1e-4)
        assert samples.values[MARK[::-1]] == 1.0


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("number", [0, 1, 13, 47, 48, 49])
def test_a_marked_sample_is_where_its_header_says(tmp_path, name, number):
    (tmp_path / name).write_bytes(FORMS[name](ALL[number]))
    check_marked(tmp_path / name, worlds(ALL[number]))


@pytest.mark.parametrize(("units", "scale"), [(1, 1000.0), (2, 1.0), (3, 0.001), (0, 1.0)])
def test_units_become_millimeters(tmp_path, units, scale):
    (tmp_path / "a.nii").write_bytes(nifti1(ALL[5], units=units))
    check_marked(tmp_path / "a.nii", worlds(ALL[5], scale))
    names = {1: "m", 2: "mm", 3: "um", 0: "pixels"}
    more = "space units: " + " ".join([f'"{names[units]}"'] * 3) + "\n"
    (tmp_path / "a.nrrd").write_bytes(nrrd(ALL[5], more=more))
    check_marked(tmp_path / "a.nrrd", worlds(ALL[5], scale))


def test_a_sheared_volume_is_where_its_header_says(tmp_path):
    shear = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    (tmp_path / "a.nii").write_bytes(nifti1(ALL[50], shear=shear))
    check_marked(tmp_path / "a.nii", INDICES @ (ALL[50] * STEPS @ shear).T + ORIGIN)


def test_distances_are_true_in_the_world(tmp_path):
    counts = np.array((20, 14, 10))
    indices = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), -1)
    turn = ALL[49]
    middle = turn * STEPS @ ((counts - 1) / 2.0) + ORIGIN
    places = indices @ (turn * STEPS).T + ORIGIN
    values = np.linalg.norm(places - middle, axis=-1) - 6.0
    (tmp_path / "a.nii").write_bytes(nifti1(turn, values=values.T.astype(np.float32)))
    ball = Shape.from_volume(tmp_path / "a.nii")
    assert ball(places) == pytest.approx(values, abs=1e-4)
    low, high = ball.bounds()
    assert (np.array(low) < middle - 6.0).all() and (np.array(high) > middle + 6.0).all()


def test_without_an_orientation_the_middle_is_the_origin(tmp_path):
    (tmp_path / "a.nii").write_bytes(nifti1(np.eye(3), way="none"))
    check_marked(tmp_path / "a.nii", (INDICES - (np.array(COUNTS) - 1) / 2.0) * STEPS)


def test_a_spacing_of_the_author_keeps_the_directions(tmp_path):
    (tmp_path / "a.nii").write_bytes(nifti1(ALL[7]))
    shape = Shape.from_volume(tmp_path / "a.nii", level=0.5, spacing=0.5)
    places = 0.5 * (INDICES - (np.array(COUNTS) - 1) / 2.0) @ ALL[7].T
    assert INDICES[shape(places) < 0.0].tolist() == [list(MARK)]


def test_a_header_with_its_samples_beside_it(tmp_path):
    (tmp_path / "a.nhdr").write_bytes(nrrd(ALL[3], more="data file: a.raw\n", data=b""))
    (tmp_path / "a.raw").write_bytes(VALUES.tobytes())
    check_marked(tmp_path / "a.nhdr", worlds(ALL[3]))
    (tmp_path / "b.nhdr").write_bytes(nrrd(ALL[3], more="data file: ../a.raw\n", data=b""))
    with pytest.raises(LoadError, match="which is no single file beside it"):
        read_volume(tmp_path / "b.nhdr")


@pytest.mark.parametrize(("encoding", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress)])
def test_packed_samples(tmp_path, encoding, pack):
    data = pack(VALUES.tobytes())
    (tmp_path / "a.nrrd").write_bytes(nrrd(ALL[3], encoding=encoding, data=data))
    check_marked(tmp_path / "a.nrrd", worlds(ALL[3]))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (nrrd(np.eye(3), "3D-left-handed"), "its space '3D-left-handed' is not read"),
        (nrrd(np.diag((1.0, 1.0, 0.0))), "the vectors from sample to sample are 0"),
        (nrrd(np.array([[1.0, 1, 0], [0, 0, 0], [0, 0, 1]])), "lie in a plane"),
        (nrrd(np.eye(3), more="byte skip: 16\n"), "it has a 'byte skip' before its samples"),
    ],
)
def test_places_that_are_refused(tmp_path, data, message):
    (tmp_path / "a.nrrd").write_bytes(data)
    with pytest.raises(LoadError, match=message):
        read_volume(tmp_path / "a.nrrd")


def test_a_mask_is_inside_where_it_is_true(tmp_path):
    mask = VALUES > 0.5
    np.save(tmp_path / "a.npy", mask)
    places = INDICES - (np.array(COUNTS) - 1) / 2.0
    for source in (mask, mask.tolist(), tmp_path / "a.npy"):
        shape = Shape.from_volume(source)
        assert INDICES[shape(places) < 0.0].tolist() == [list(MARK)]
        # Half a sample beside the marked one is the surface.
        beside = np.array(MARK) + np.array((0.5, 0.0, 0.0)) - (np.array(COUNTS) - 1) / 2.0
        assert shape(beside) == pytest.approx(0.0, abs=1e-6)
        with pytest.raises(SceneValueError, match=r"no level: .* mask\.astype\(float\)"):
            Shape.from_volume(source, level=0.5)


@pytest.mark.parametrize(
    ("ends", "centers"), [((0.5, 0.75, 1.0), "cell cell cell"), ((0.0, 0.0, 0.0), "node node node")]
)
def test_nrrd_has_spacings_by_the_ends_of_its_axes(tmp_path, ends, centers):
    high = [(n - 1) * step + end for n, step, end in zip(COUNTS, STEPS, ends, strict=True)]
    head = (
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 5 6 7\nendian: little\nencoding: raw\n"
        f"axis mins: {' '.join(str(-end) for end in ends)}\naxis maxs: {' '.join(map(str, high))}\n"
    )
    file = tmp_path / "a.nrrd"
    file.write_bytes(f"{head}centers: {centers}\n\n".encode() + VALUES.astype("<f4").tobytes())
    assert read_volume(file).spacing == pytest.approx(tuple(STEPS))
    file.write_bytes(f"{head}\n".encode() + VALUES.astype("<f4").tobytes())
    with pytest.raises(LoadError, match="whether samples are at the ends"):
        read_volume(file)
