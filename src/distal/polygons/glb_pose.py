"""Moves the points of a GLB's meshes as morph targets and skins say, in the pose of the file.

Input: a primitive, weights, matrices of joints. Output: its points.

Source: glTF 2.0 Specification, Khronos, 3.7.2.2 and 3.7.3.
"""

from __future__ import annotations

from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need
from distal.polygons.glb_numbers import (
    GlbFile,
    accessor,
    entry,
    list_of,
    scaled,
)

Matrices = NDArray[np.float64]
_POINT_BYTES = 400  # of a point of a skin, at the peak


def joint_matrices(file: GlbFile, number: Any, worlds: dict[int, Matrices]) -> Matrices:
    """Return the matrix of each joint of a skin, (n, 4, 4): from the mesh to the scene.

    Args:
        file: The file.
        number: The skin.
        worlds: The matrix of each node of the scene.

    Raises:
        LoadError: The skin is damaged, or a joint is not in the scene.
    """
    skin = entry(file.content, "skins", number)
    joints = list_of(skin, "joints")
    if not joints:
        raise LoadError(f"its skin {number} has no joints")
    missing = [joint for joint in joints if not isinstance(joint, int) or joint not in worlds]
    if missing:
        raise LoadError(f"joint {missing[0]!r:.20} of its skin {number} is not in the scene")
    need(len(joints) * 256, f"{len(joints):,} joints")
    matrices = np.stack([worlds[joint] for joint in joints])
    if "inverseBindMatrices" not in skin:
        return matrices
    inverse = scaled(file, skin["inverseBindMatrices"], "MAT4")
    if len(inverse) < len(joints):
        raise LoadError(f"its skin {number} has {len(joints)} joints and {len(inverse)} matrices")
    # Columns come first in the file.
    found: Matrices = matrices @ inverse[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    return found


def morphed(
    file: GlbFile, primitive: dict[str, Any], points: Matrices, weights: tuple[float, ...]
) -> Matrices:
    """Return the points of a primitive with its targets added.

    Args:
        file: The file.
        primitive: Its entry.
        points: Its points, (n, 3).
        weights: That of each target.

    Raises:
        LoadError: A target is missing or damaged.
    """
    targets = list_of(primitive, "targets")
    for number, weight in enumerate(weights):
        if not weight:
            continue
        target = targets[number] if number < len(targets) else None
        if not isinstance(target, dict):
            raise LoadError(f"it has a weight for morph target {number}, which is not there")
        if "POSITION" in target:
            moves = scaled(file, target["POSITION"], "VEC3")
            if len(moves) != len(points):
                raise LoadError(f"morph target {number} has {len(moves)} of {len(points)} points")
            points = points + weight * moves
    return points


def skinned(
    file: GlbFile, attributes: dict[str, Any], points: Matrices, joints: Matrices
) -> Matrices:
    """Return points, each moved by its joints.

    Args:
        file: The file.
        attributes: Those of the primitive.
        points: (n, 3).
        joints: The matrices of the joints, (m, 4, 4).

    Raises:
        LoadError: Points have no joints, or joints that are not there.
    """
    need(len(points) * _POINT_BYTES, f"{len(points):,} points with joints")
    moved = np.zeros((len(points), 3))
    total = np.zeros(len(points))
    for number in count():
        names = f"JOINTS_{number}", f"WEIGHTS_{number}"
        if not all(name in attributes for name in names):
            break
        which = accessor(file, attributes[names[0]], "VEC4")
        weights = scaled(file, attributes[names[1]], "VEC4")
        if which.dtype.kind != "u" or not len(which) == len(weights) == len(points):
            raise LoadError(f"its {names[0]} are no joints for {len(points)} points")
        for place in range(4):
            joint, weight = which[:, place], weights[:, place]
            used = np.flatnonzero(weight != 0.0)
            if len(used) and joint[used].max() >= len(joints):
                raise LoadError(f"a point names joint {joint[used].max()} of {len(joints)}")
            matrices = joints[joint[used]]
            turned = np.einsum("nij,nj->ni", matrices[:, :3, :3], points[used])
            moved[used] += weight[used, None] * (turned + matrices[:, :3, 3])
            total[used] += weight[used]
    if not (total > 0.0).all():
        raise LoadError("a point of its skin has no joints")
    return moved / total[:, None]
