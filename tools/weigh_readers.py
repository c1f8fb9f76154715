"""Compares readers of meshes on all variants of the tests: distal's own and those of libraries.

    python tools/weigh_readers.py [--all]

Prints for each reader and format how many variants it reads right, refuses where that is right,
refuses where they could be read, or reads wrong without a word. ``--all`` prints each variant that
is not right. Libraries that are not installed are left out; decision 106 has the table.
"""

# ruff: noqa: PLC0415 -- a library that is not there is left out

from __future__ import annotations

import re
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tests.readers.mesh_variants import VARIANTS, Triangles, is_right

SUFFIXES = (".stl", ".obj", ".ply", ".glb", ".3mf")


class RefusedError(Exception):
    """The reader says that it cannot read a file."""


def own(path: Path) -> Triangles:
    """Read by distal."""
    from distal.diagnostics import LoadError
    from distal.polygons.reading import read_mesh

    try:
        mesh = read_mesh(path)
    except LoadError as error:
        raise RefusedError(str(error)) from None
    return mesh.points[mesh.triangles]


def by_trimesh(path: Path) -> Triangles:
    """Read by trimesh, each geometry in its place."""
    import trimesh

    scene = trimesh.load_scene(str(path), process=False)
    found = [g for g in scene.dump() if isinstance(g, trimesh.Trimesh)]
    if not found:
        raise RefusedError("nothing")
    return np.concatenate([np.asarray(each.triangles, np.float64) for each in found])


def by_meshio(path: Path) -> Triangles:
    """Read by meshio; polygons as fans."""
    import meshio

    mesh = meshio.read(str(path))
    rows = []
    for block in mesh.cells:
        cells = np.asarray(block.data)
        for i in range(1, cells.shape[1] - 1):
            rows.append(cells[:, [0, i, i + 1]])
    if not rows:
        raise RefusedError("nothing")
    points = np.asarray(mesh.points, np.float64)
    if points.shape[1] != 3:
        raise RefusedError("points of two numbers")
    return points[np.concatenate(rows)]


def by_plyfile(path: Path) -> Triangles:
    """Read by plyfile; polygons as fans."""
    from plyfile import PlyData

    data = PlyData.read(str(path))
    points = np.stack([np.asarray(data["vertex"][a], np.float64) for a in "xyz"], axis=1)
    face = data["face"]
    names = [p.name for p in face.properties]
    lists = face["vertex_indices" if "vertex_indices" in names else "vertex_index"]
    rows = [(f[0], f[i], f[i + 1]) for f in lists for i in range(1, len(f) - 1)]
    if not rows:
        raise RefusedError("nothing")
    return points[np.array(rows)]


def by_lib3mf(path: Path) -> Triangles:
    """Read by lib3mf, each object of the build in its place."""
    from lib3mf import get_wrapper

    wrapper = get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader({".3mf": "3mf", ".stl": "stl"}[path.suffix])
    reader.SetStrictModeActive(False)
    reader.ReadFromFile(str(path))
    rows: list[Triangles] = []

    def place(resource: Any, matrix: np.ndarray, deep: int) -> None:
        if deep > 32:
            raise RefusedError("ring")
        if resource.IsComponentsObject():
            thing = model.GetComponentsObjectByID(resource.GetResourceID())
            for i in range(thing.GetComponentCount()):
                component = thing.GetComponent(i)
                inner = np.array(component.GetTransform().Fields)
                place(component.GetObjectResource(), after(inner, matrix), deep + 1)
        elif resource.IsMeshObject():
            mesh = model.GetMeshObjectByID(resource.GetResourceID())
            count = mesh.GetVertexCount()
            points = np.array([list(mesh.GetVertex(i).Coordinates) for i in range(count)])
            faces = [list(mesh.GetTriangle(i).Indices) for i in range(mesh.GetTriangleCount())]
            if faces:
                placed = points @ matrix[:3] + matrix[3]
                found = placed[np.array(faces)]
                rows.append(found[:, ::-1] if np.linalg.det(matrix[:3]) < 0 else found)

    def after(inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
        return np.concatenate([inner[:3] @ outer[:3], inner[3:] @ outer[:3] + outer[3:]])

    items = model.GetBuildItems()
    while items.MoveNext():
        item = items.GetCurrent()
        matrix = (
            np.array(item.GetObjectTransform().Fields)
            if item.HasObjectTransform()
            else np.eye(4, 3)
        )
        place(item.GetObjectResource(), matrix, 0)
    if not rows:
        raise RefusedError("nothing")
    return np.concatenate(rows)


READERS: dict[str, tuple[Callable[[Path], Triangles], tuple[str, ...]]] = {
    "distal": (own, SUFFIXES),
    "trimesh": (by_trimesh, SUFFIXES),
    "meshio": (by_meshio, (".stl", ".obj", ".ply")),
    "plyfile": (by_plyfile, (".ply",)),
    "lib3mf": (by_lib3mf, (".3mf", ".stl")),
}
MODULES = {
    "distal": "distal",
    "trimesh": "trimesh",
    "meshio": "meshio",
    "plyfile": "plyfile",
    "lib3mf": "lib3mf",
}
KINDS = (
    "reads right",
    "refuses right",
    "refuses what could be read",
    "wrong reason",
    "reads wrong silently",
)


def verdict(
    read: Callable[[Path], Triangles], variant: Any, folder: Path, *, is_own: bool
) -> tuple[str, str]:
    """Return one of ``KINDS``, and what was said."""
    path = folder / f"a{variant.suffix}"
    path.write_bytes(variant.data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = read(path)
        if not len(found):
            raise RefusedError("nothing")
    except (Exception, SystemExit) as error:
        said = f"{type(error).__name__}: {error}".replace("\n", " ")
        if variant.right is not None and not variant.reason:
            return KINDS[2], said
        if is_own and variant.reason and not re.search(variant.reason, said):
            return KINDS[3], said
        return KINDS[1], said
    if variant.right is not None and is_right(found, variant.right):
        return KINDS[0], ""
    return KINDS[4], f"{len(found)} triangles"


def main() -> None:
    """Print the comparison."""
    shows = "--all" in sys.argv
    only = [a for a in sys.argv[1:] if not a.startswith("-")]
    with tempfile.TemporaryDirectory() as folder:
        for name, (read, suffixes) in READERS.items():
            if only and name not in only:
                continue
            try:
                __import__(MODULES[name])
            except ImportError:
                print(f"{name}: not installed")
                continue
            for suffix in suffixes:
                counts: Counter[str] = Counter()
                lines = []
                for variant in (v for v in VARIANTS if v.suffix == suffix):
                    kind, said = verdict(read, variant, Path(folder), is_own=name == "distal")
                    counts[kind] += 1
                    if kind not in KINDS[:2]:
                        lines.append(f"    {kind}: {variant.name}: {said[:150]}")
                print(f"{name} {suffix}: " + ", ".join(f"{counts[k]} {k}" for k in KINDS))
                if shows:
                    print("\n".join(lines))


if __name__ == "__main__":
    main()
