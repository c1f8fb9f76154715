"""What each method of a solid means, as a formula or as places of copies (``method_fields``)."""

from __future__ import annotations

import itertools

import numpy as np

from distal.fields.deform import folds
from tests.scene.method_fields import (
    AROUND,
    AXIS,
    BESIDE,
    HIGH,
    OTHER_AXIS,
    OTHER_QUATERNION,
    QUATERNION,
    SMALL,
    Case,
    X,
    Y,
    Z,
    about,
    along,
    around_y,
    arr,
    at_steps,
    block,
    folded,
    folded_sphere,
    joined,
    kaleidoscope,
    mirror_signs,
    outwards,
    plane_places,
    pulled,
    reflected,
    reversed_axes,
    ring_places,
    slices,
    tapered,
    turn_towards,
    turned_back,
    wrapped,
)

SOLIDS = [
    # Placing
    # A parameter as the condition: ``test_alternatives``.
    Case(
        "shown",
        {"condition": True},
        lambda a, b, p, condition: a(p) if condition else np.full(len(p), 1e12),
        changed={"condition": [False]},
    ),
    Case("translate", {"offset": (0.3, -0.2, 0.5)}, lambda a, b, p, offset: a(p - arr(offset))),
    Case(
        "translate",
        {"parts": {"x": 0.3, "z": -0.4}},
        lambda a, b, p, parts: a(p - [parts["x"], 0.0, parts["z"]]),
    ),
    Case("scale", {"factors": (1.3,)}, lambda a, b, p, factors: factors[0] * a(p / factors[0])),
    Case(
        "scale",
        {"factors": (1.3, 0.7, 1.9)},
        lambda a, b, p, factors: min(factors) * a(p / arr(factors)),
        changed={"factors": [(1.6, 0.7, 1.9), (1.3, 0.9, 1.9), (1.3, 0.7, 1.5)]},
        child=HIGH,
    ),
    Case(
        "scale",
        {"parts": {"y": 1.3, "z": 1.5}},
        lambda a, b, p, parts: a(p / [1.0, parts["y"], parts["z"]]),
        child=HIGH,
    ),
    # Factors below 0 reflect.
    Case(
        "scale",
        {"factors": (-1.3,)},
        lambda a, b, p, factors: 1.3 * a(p / -1.3),
        fixed=("factors",),
    ),
    Case(
        "scale",
        {"factors": (1.3, -0.7, 1.9)},
        lambda a, b, p, factors: 0.7 * a(p / arr(factors)),
        fixed=("factors",),
        child=HIGH,
    ),
    Case(
        "mirror",
        {"axes": "x", "offset": 0.0},
        lambda a, b, p, axes, offset: a(reversed_axes(p, axes) + arr([2.0 * offset, 0.0, 0.0])),
        changed={"axes": ["y", "z", "xy", "zyx"], "offset": [0.4]},
    ),
    Case(
        "mirror",
        {"offset": 0.15, "across": AXIS},
        lambda a, b, p, offset, across: a(reflected(p, across, offset)),
        unit=("across",),
    ),
    Case(
        "symmetry",
        {"offset": 0.15, "across": AXIS},
        lambda a, b, p, offset, across: a(folded(p, across, offset)),
        unit=("across",),
    ),
    Case(
        "symmetry",
        {"axes": "xz"},
        lambda a, b, p, axes: a(np.where([c in axes for c in "xyz"], np.abs(p), p)),
        changed={"axes": ["x", "y", "z", "xy", "zyx"]},
    ),
    Case(
        "kaleidoscope",
        {"count": 5},
        # About the y axis, from x towards -z.
        lambda a, b, p, count: a(
            (lambda x, z: joined(x, p[:, 1], -z))(*kaleidoscope(p[:, 0], -p[:, 2], count))
        ),
    ),
    *(
        Case(
            "rotate",
            {axis: 0.7},
            lambda a, b, p, row=row, **k: a(turned_back(p, about(row, *k.values()))),
        )
        for axis, row in zip("xyz", np.eye(3), strict=True)
    ),
    Case(
        "rotate",
        {"x": 0.7, "y": -0.4, "z": 1.1},
        lambda a, b, p, x, y, z: a(turned_back(p, about(Z, z) @ about(Y, y) @ about(X, x))),
    ),
    Case(
        "rotate",
        {"angle": 0.7, "axis": AXIS},
        lambda a, b, p, angle, axis: a(turned_back(p, about(axis, angle))),
        unit=("axis",),
    ),
    Case(
        "rotate",
        {"quaternion": QUATERNION},
        lambda a, b, p, quaternion: a(
            turned_back(
                p,
                about(
                    arr(quaternion[:3]) / np.linalg.norm(quaternion[:3]),
                    2.0 * np.arctan2(np.linalg.norm(quaternion[:3]), quaternion[3]),
                ),
            )
        ),
        changed={"quaternion": [OTHER_QUATERNION]},
    ),
    Case(
        "rotate",
        {"matrix": about(AXIS, 0.7).tolist()},
        lambda a, b, p, matrix: a(turned_back(p, arr(matrix))),
        changed={"matrix": [about(OTHER_AXIS, 0.7).tolist()]},
    ),
    Case(
        "orient",
        {"source": (1.0, 0.2, -0.4), "target": (-0.3, 0.9, 0.6)},
        lambda a, b, p, source, target: a(turned_back(p, turn_towards(source, target))),
    ),
    Case(
        "orient",
        {"source": (-0.3, 0.9, 0.6)},
        lambda a, b, p, source: a(turned_back(p, turn_towards((0.0, 1.0, 0.0), source))),
    ),
    Case(
        "transform",
        {"matrix": [[0.0, -1.5, 0.0, 0.2], [-1.5, 0.0, 0.0, 0.1], [0.0, 0.0, 1.5, -0.3]]},
        lambda a, b, p, matrix: 1.5 * a((p - arr(matrix)[:, 3]) @ arr(matrix)[:, :3] / 2.25),
        changed={"matrix": [[[1.5, 0.0, 0.0, 0.4], [0.0, -1.5, 0.0, 0.3], [0.0, 0.0, 1.5, 0.2]]]},
    ),
    Case(
        "shear",
        {"xy": 0.3, "xz": -0.4, "yz": 0.5},
        lambda a, b, p, xy, xz, yz: a(
            p @ np.linalg.inv([[1.0, xy, xz], [0.0, 1.0, yz], [0.0, 0.0, 1.0]]).T
        ),
        child=HIGH,
    ),
    # Copies
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9)},
        copies=lambda q, spacing: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.2,)},
        copies=lambda q, spacing: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "neighbors": 1},
        copies=lambda q, spacing, neighbors: at_steps(q, spacing, AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "count": (2, 3, 4)},
        copies=lambda q, spacing, count: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3, 4), (2, 2, 4), (2, 3, 5)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "count": (2, 3, 4), "neighbors": 1},
        copies=lambda q, spacing, count, neighbors: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3, 4), (2, 2, 4), (2, 3, 5)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3, 0.9), "mirrored": True},
        copies=lambda q, spacing, mirrored: [
            mirror_signs(q, spacing, i) if mirrored else q + arr(spacing) * arr(i) for i in AROUND
        ],
        child=SMALL,
    ),
    Case(
        "repeat_half",
        {"spacing": (1.1, 1.3, 0.9)},
        copies=lambda q, spacing: at_steps(q, spacing, [(0, 0, 0), (1, 0, 0), (0, 2, 1)]),
        child=SMALL,
    ),
    Case(
        "repeat_polar",
        {"count": 5},
        copies=lambda q, count: around_y(q, count),
        child=BESIDE,
    ),
    Case(
        "repeat_polar",
        {"count": 5, "neighbors": 1},
        copies=lambda q, count, neighbors: around_y(q, count),
        child=BESIDE,
    ),
    Case(
        "repeat_polar",
        {"count": 5, "neighbors": "all"},
        lambda a, b, p, count, neighbors: np.min(
            [a(p @ about(Y, 2.0 * np.pi * i / count)) for i in range(count)], axis=0
        ),
        fixed=("neighbors",),
    ),
    Case(
        "repeat_ring",
        {"spacing": (1.1, 0.9), "count": (4, 3)},
        copies=lambda q, spacing, count: at_steps(
            q, (spacing[0], 0.0, spacing[1]), ring_places(count)
        ),
        changed={"count": [(3, 3), (4, 4)]},
        child=SMALL,
    ),
    Case(
        "array",
        {"positions": [(0.0, 0.3, -0.4), (1.5, -0.2, 0.7), (-0.3, 1.4, 2.0)]},
        lambda a, b, p, positions: np.min([a(p - arr(at)) for at in positions], axis=0),
        changed={"positions": [[(0.0, 0.3, -0.4), (1.5, -0.2, 0.7), (-0.9, 1.4, 2.0)]]},
    ),
    Case(
        "array",
        {
            "positions": [(0.0, 0.3, -0.4), (0.5, -0.2, 0.7)],
            "scale": (1.3, 0.8),
            "rotation": [(0.7, -0.4, 1.1), (-0.5, 0.3, 0.2)],
            "align": [(0.3, 1.0, -0.4), (1.0, 0.2, 0.5)],
            "axis": (0.2, -0.3, 1.0),
        },
        lambda a, b, p, positions, scale, rotation, align, axis: np.min(
            [
                s
                * a(
                    turned_back(
                        turned_back(p - arr(at), turn_towards(axis, to)),
                        about(Z, z) @ about(Y, y) @ about(X, x),
                    )
                    / s
                )
                for at, s, (x, y, z), to in zip(positions, scale, rotation, align, strict=True)
            ],
            axis=0,
        ),
    ),
    Case(
        "array",
        {
            "positions": [(0.0, 0.3, -0.4), (0.5, -0.2, 0.7)],
            "scale": [(1.3, 0.7, 1.9), (0.8, 1.1, 0.9)],
            "rotation": (0.7, -0.4),
        },
        lambda a, b, p, positions, scale, rotation: np.min(
            [
                min(s) * a(turned_back(p - arr(at), about(Y, angle)) / arr(s))
                for at, s, angle in zip(positions, scale, rotation, strict=True)
            ],
            axis=0,
        ),
        changed={"scale": [[(1.6, 0.7, 1.9), (0.8, 1.1, 0.9)], [(1.3, 0.7, 1.9), (0.8, 1.4, 0.7)]]},
        child=HIGH,
    ),
    Case(
        "array",
        {"positions": [(0.0, 0.3, -0.4), (0.5, -0.2, 0.7)], "scale": 1.3, "rotation": 0.7},
        lambda a, b, p, positions, scale, rotation: np.min(
            [scale * a(turned_back(p - arr(at), about(Y, rotation)) / scale) for at in positions],
            axis=0,
        ),
    ),
    Case(
        "array",
        {
            "positions": [(0.0, 0.3, -0.4), (0.5, -0.2, 0.7)],
            "rotation": [QUATERNION, OTHER_QUATERNION],
        },
        lambda a, b, p, positions, rotation: np.min(
            [
                a(
                    turned_back(
                        p - arr(at),
                        about(
                            arr(q[:3]) / np.linalg.norm(q[:3]),
                            2.0 * np.arctan2(np.linalg.norm(q[:3]), q[3]),
                        ),
                    )
                )
                for at, q in zip(positions, rotation, strict=True)
            ],
            axis=0,
        ),
        changed={"rotation": [[OTHER_QUATERNION, OTHER_QUATERNION], [QUATERNION, QUATERNION]]},
    ),
    Case(
        "array",
        {"start": (0.3, -0.4, 0.2), "end": (3.0, 2.5, -2.0), "count": 4},
        copies=lambda q, start, end, count: [
            q + arr(start) + (arr(end) - arr(start)) * i / (count - 1) for i in range(count)
        ],
        child=SMALL,
    ),
    Case(
        "split",
        {"normal": AXIS, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), p @ arr(normal) - offset),
        unit=("normal",),
        part=0,
    ),
    Case(
        "split",
        {"normal": AXIS, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), offset - p @ arr(normal)),
        unit=("normal",),
        part=1,
    ),
    # The value alone
    Case("round", {"radius": 0.2}, lambda a, b, p, radius: a(p) - radius),
    Case("offset", {"distance": 0.2}, lambda a, b, p, distance: a(p) - distance),
    Case("complement", {}, lambda a, b, p: -a(p)),
    *(
        Case(
            "shell",
            {"thickness": 0.3, "where": where},
            # A wall from so far inside to so far outside of the old surface.
            lambda a, b, p, thickness, where: np.maximum(
                a(p) - thickness * {"inner": 0.0, "center": 0.5, "outer": 1.0}[where],
                -a(p) - thickness * {"inner": 1.0, "center": 0.5, "outer": 0.0}[where],
            ),
            changed={"where": [w for w in ("inner", "center", "outer") if w != where]},
        )
        for where in ("inner", "center", "outer")
    ),
    # Bent out of shape
    Case(
        "elongate",
        {"lengths": (0.4, 0.7, 1.0)},
        lambda a, b, p, lengths: a(np.sign(p) * np.maximum(np.abs(p) - 0.5 * arr(lengths), 0.0)),
    ),
    Case(
        "twist",
        {"rate": 0.8},
        lambda a, b, p, rate: a(
            np.array([about(Y, rate * q[1]).T @ q for q in p])  # each height by its own angle
        ),
        child=HIGH,
    ),
    Case(
        "bend",
        {"rate": 0.4},
        lambda a, b, p, rate: a(np.array([about(Z, rate * q[0]).T @ q for q in p])),
        child=HIGH,
    ),
    Case(
        "bend_linear",
        {"start": (-0.5, 0.1, 0.2), "end": (0.6, 0.9, -0.3), "shift": (0.2, -0.3, 0.5)}
        | {"ease": "slow start"},
        lambda a, b, p, start, end, shift, ease: a(
            p - along(p, start, end, ease)[:, None] * arr(shift)
        ),
        changed={"ease": ["linear", "smooth"]},
        child=HIGH,
    ),
    Case(
        "bend_radial",
        {"inner": 0.2, "outer": 0.9, "rise": 0.4, "ease": "slow start"},
        lambda a, b, p, inner, outer, rise, ease: a(
            p - joined(0.0, rise * outwards(p, inner, outer, ease), 0.0)
        ),
        changed={"ease": ["linear", "smooth"]},
        child=HIGH,
    ),
    Case(
        "taper",
        {"bottom": -0.6, "top": 0.5, "factor": 0.7},
        lambda a, b, p, **k: a(tapered(p, **k)),
        child=HIGH,
    ),
    Case(
        "warp",
        {"amount": 0.3, "frequency": 1.4, "seed": 2},
        # Noise has no closed form: the library's own, its arguments by name.
        lambda a, b, p, amount, frequency, seed: a(
            np.asarray(folds.warped(p, amount=amount, frequency=frequency, seed=seed))
        ),
        child=HIGH,
    ),
    Case(
        "wrap",
        {"radius": 1.2},
        copies=lambda q, radius: [wrapped(q, radius)],
        child=SMALL,
    ),
    Case(
        "attract",
        {"center": (0.2, -0.1, 0.3), "radius": 0.9, "strength": 0.6},
        lambda a, b, p, center, radius, strength: a(pulled(p, center, radius, strength)),
        child=HIGH,
    ),
    Case(
        "repel",
        {"center": (0.2, -0.1, 0.3), "radius": 0.9, "strength": 0.6},
        lambda a, b, p, center, radius, strength: a(pulled(p, center, radius, -strength)),
        child=HIGH,
    ),
    # With another
    Case(
        "transition_linear",
        {"start": (-0.5, 0.1, 0.2), "end": (0.6, 0.9, -0.3), "ease": "slow start"},
        lambda a, b, p, start, end, ease: a(p) + along(p, start, end, ease) * (b(p) - a(p)),
        changed={"ease": ["linear", "smooth"]},
    ),
    Case(
        "transition_radial",
        {"inner": 0.2, "outer": 0.9, "ease": "slow start"},
        lambda a, b, p, inner, outer, ease: a(p) + outwards(p, inner, outer, ease) * (b(p) - a(p)),
        changed={"ease": ["linear", "smooth"]},
    ),
    Case("clearance", {"gap": 0.2}, lambda a, b, p, gap: np.maximum(a(p), gap - b(p))),
    # Carved: the shape without what is in the other and less than ``depth`` deep.
    Case(
        "carve",
        {"depth": 0.2},
        lambda a, b, p, depth: np.maximum(a(p), -np.maximum(-a(p) - depth, b(p))),
    ),
    # Embossed: and with what is in the other and less than ``height`` outside.
    Case(
        "emboss",
        {"height": 0.2},
        lambda a, b, p, height: np.minimum(a(p), np.maximum(a(p) - height, b(p))),
    ),
    Case("morph", {"t": 0.3}, lambda a, b, p, t: (1.0 - t) * a(p) + t * b(p)),
    Case(
        "displace",
        {"height": 0.3},
        lambda a, b, p, height: a(p) - height * np.clip(b(p), -1.0, 1.0),
    ),
    Case(
        "engrave",
        {"depth": 0.3},
        # A right angle, its edge ``depth`` below the surface.
        lambda a, b, p, depth: np.maximum(a(p), (a(p) + depth - np.abs(b(p))) / np.sqrt(2.0)),
    ),
    Case("pipe", {"radius": 0.3}, lambda a, b, p, radius: np.hypot(a(p), b(p)) - radius),
    Case(
        "groove",
        {"depth": 0.3, "width": 0.5},
        lambda a, b, p, depth, width: np.maximum(
            a(p), -np.maximum(-a(p) - depth, np.abs(b(p)) - width)
        ),
    ),
    Case(
        "tongue",
        {"depth": 0.3, "width": 0.5},
        lambda a, b, p, depth, width: np.minimum(
            a(p), np.maximum(a(p) - depth, np.abs(b(p)) - width)
        ),
    ),
    Case("union", {}, lambda a, b, p: np.minimum(a(p), b(p))),
    Case("intersection", {}, lambda a, b, p: np.maximum(a(p), b(p))),
    Case("difference", {}, lambda a, b, p: np.maximum(a(p), -b(p))),
    Case(
        "xor",
        {},
        lambda a, b, p: np.where(a(p) * b(p) < 0, -1, 1) * np.minimum(*np.abs((a(p), b(p)))),
    ),
    # To the plane
    Case(
        "slice",
        {"origin": (0.2, -0.3, 0.4), "normal": AXIS},
        lambda a, b, p, origin, normal: a(plane_places(p, origin, normal)),
        unit=("normal",),
        lands=True,
    ),
    Case("project", {"count": 5}, lambda a, b, p, count: slices(a, p, count), lands=True),
    # Operators without a method
    Case(
        "apply",
        {"operator": "symmetry diagonal"},
        lambda a, b, p, operator: a(
            joined(np.maximum(p[:, 0], p[:, 2]), p[:, 1], np.minimum(p[:, 0], p[:, 2]))
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "symmetry octant"},
        lambda a, b, p, operator: a(
            joined(np.abs(p[:, ::2]).max(1), p[:, 1], np.abs(p[:, ::2]).min(1))
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "dilate", "distance": 0.2},
        lambda a, b, p, operator, distance: a(p) - distance,
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "erode", "distance": 0.2},
        lambda a, b, p, operator, distance: a(p) + distance,
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "repeat interval", "spacing": (1.1, 1.3, 0.9)}
        | {"first_x": -1, "first_y": 0, "first_z": -2, "last_x": 1, "last_y": 1, "last_z": 0},
        copies=lambda q, operator, spacing, first_x, first_y, first_z, last_x, last_y, last_z: (
            at_steps(
                q,
                spacing,
                itertools.product(
                    range(first_x, last_x + 1),
                    range(first_y, last_y + 1),
                    range(first_z, last_z + 1),
                ),
            )
        ),
        fixed=("operator",),
        child=SMALL,
    ),
    Case(
        "apply",
        {"operator": "sphere fold", "inner": 0.4, "outer": 0.7},
        lambda a, b, p, operator, inner, outer: a(folded_sphere(p, inner, outer)),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "repeat scaled", "ratio": 2.5},
        copies=lambda q, operator, ratio: [
            (ratio**i * (q + arr((1.5, 0.0, 0.0))), ratio**i) for i in (-2, 0, 1)
        ],
        fixed=("operator",),
        child=BESIDE,
    ),
    Case(
        "apply",
        {"operator": "thicken by", "near_thickness": 0.3, "far_thickness": 0.5, "span": 0.7},
        lambda a, b, p, operator, near_thickness, far_thickness, span: (
            np.abs(a(p)) - 0.5 * np.interp(b(p), [0.0, span], [near_thickness, far_thickness])
        ),
        fixed=("operator",),
        joins=True,
    ),
    Case(
        "apply",
        {"operator": "union power", "exponent": 3.0},
        # The inverse powers add up; the level 0 is that of a plain union.
        lambda a, b, p, operator, exponent: (
            (a(p) ** -exponent + b(p) ** -exponent) ** (-1.0 / exponent)
        ),
        fixed=("operator",),
        child=HIGH,
        joins=True,
    ),
]
