"""What each method of a flat shape means, as a formula or as places of copies."""

from __future__ import annotations

import numpy as np

from tests.scene.method_cases import SOLIDS
from tests.scene.method_fields import (
    FLAT_AROUND,
    FLAT_BESIDE,
    FLAT_NORMAL,
    HIGH,
    SMALL,
    WIDE,
    Case,
    Child,
    Z,
    about,
    arr,
    at_steps,
    block,
    first_piece,
    flat_around,
    folded,
    joined,
    kaleidoscope,
    loft_share,
    mirror_signs,
    on_way,
    reflected,
    reversed_axes,
    revolved_part,
    within_ends,
    wrapped,
)

FLATS = [
    # A parameter as the condition: ``test_alternatives``.
    Case(
        "shown",
        {"condition": True},
        lambda a, b, p, condition: a(p) if condition else np.full(len(p), 1e12),
        changed={"condition": [False]},
    ),
    Case("translate", {"offset": (0.3, -0.2)}, lambda a, b, p, offset: a(p - arr(offset))),
    Case("rotate", {"angle": 0.7}, lambda a, b, p, angle: a(p @ about(Z, angle)[:2, :2])),
    Case("scale", {"factors": (1.3,)}, lambda a, b, p, factors: factors[0] * a(p / factors[0])),
    Case(
        "scale",
        {"factors": (1.3, 0.7)},
        lambda a, b, p, factors: min(factors) * a(p / arr(factors)),
        child=HIGH,
    ),
    Case(
        "scale",
        {"parts": {"y": 1.3}},
        lambda a, b, p, parts: a(p / [1.0, parts["y"]]),
        child=HIGH,
    ),
    Case(
        "translate",
        {"parts": {"y": 0.3}},
        lambda a, b, p, parts: a(p - [0.0, parts["y"]]),
    ),
    Case(
        "scale",
        {"factors": (-1.3,)},
        lambda a, b, p, factors: 1.3 * a(p / -1.3),
        fixed=("factors",),
    ),
    Case(
        "mirror",
        {"axes": "x", "offset": 0.0},
        lambda a, b, p, axes, offset: a(reversed_axes(p, axes) + arr([2.0 * offset, 0.0])),
        changed={"axes": ["y", "xy"], "offset": [0.4]},
    ),
    Case(
        "mirror",
        {"offset": 0.15, "across": FLAT_NORMAL},
        lambda a, b, p, offset, across: a(reflected(p, across, offset)),
        unit=("across",),
    ),
    Case(
        "symmetry",
        {"offset": 0.15, "across": FLAT_NORMAL},
        lambda a, b, p, offset, across: a(folded(p, across, offset)),
        unit=("across",),
    ),
    Case(
        "symmetry",
        {"axes": "y"},
        lambda a, b, p, axes: a(np.where([c in axes for c in "xy"], np.abs(p), p)),
        changed={"axes": ["x", "xy"]},
    ),
    Case(
        "kaleidoscope",
        {"count": 5},
        lambda a, b, p, count: a(joined(*kaleidoscope(p[:, 0], p[:, 1], count))),
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3)},
        copies=lambda q, spacing: at_steps(q, spacing, FLAT_AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "neighbors": 1},
        copies=lambda q, spacing, neighbors: at_steps(q, spacing, FLAT_AROUND),
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "count": (2, 3)},
        copies=lambda q, spacing, count: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3), (2, 2)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "count": (2, 3), "neighbors": 1},
        copies=lambda q, spacing, count, neighbors: at_steps(q, spacing, block(count)),
        changed={"count": [(3, 3), (2, 2)]},
        child=SMALL,
    ),
    Case(
        "repeat",
        {"spacing": (1.1, 1.3), "mirrored": True},
        copies=lambda q, spacing, mirrored: [
            mirror_signs(q, spacing, i) if mirrored else q + arr(spacing) * arr(i)
            for i in FLAT_AROUND
        ],
        child=SMALL,
    ),
    Case("repeat_polar", {"count": 5}, copies=flat_around, child=FLAT_BESIDE),
    Case(
        "repeat_polar",
        {"count": 5, "neighbors": 1},
        copies=lambda q, count, neighbors: flat_around(q, count),
        child=FLAT_BESIDE,
    ),
    Case(
        "repeat_polar",
        {"count": 5, "neighbors": "all"},
        lambda a, b, p, count, neighbors: np.min(
            [a(p @ about(Z, 2.0 * np.pi * i / count)[:2, :2]) for i in range(count)], axis=0
        ),
        fixed=("neighbors",),
    ),
    Case(
        "split",
        {"normal": FLAT_NORMAL, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), p @ arr(normal) - offset),
        unit=("normal",),
        part=0,
    ),
    Case(
        "split",
        {"normal": FLAT_NORMAL, "offset": 0.15},
        lambda a, b, p, normal, offset: np.maximum(a(p), offset - p @ arr(normal)),
        unit=("normal",),
        part=1,
    ),
    *(case for case in SOLIDS if case.method in ("round", "offset", "complement", "shell")),
    *(case for case in SOLIDS if case.method in ("union", "intersection", "difference", "xor")),
    Case(
        "apply",
        {"operator": "flat shear", "xy": 0.4},
        lambda a, b, p, operator, xy: a(joined(p[:, 0] - xy * p[:, 1], p[:, 1])),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "flat symmetry diagonal"},
        lambda a, b, p, operator: a(joined(p.max(1), p.min(1))),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat symmetry octant"},
        lambda a, b, p, operator: a(joined(np.abs(p).max(1), np.abs(p).min(1))),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat elongate", "lengths": (0.4, 0.7)},
        lambda a, b, p, operator, lengths: a(
            np.sign(p) * np.maximum(np.abs(p) - 0.5 * arr(lengths), 0.0)
        ),
        fixed=("operator",),
    ),
    Case(
        "apply",
        {"operator": "flat bend", "rate": 0.4},
        lambda a, b, p, operator, rate: a(
            np.array([about(Z, rate * q[0])[:2, :2].T @ q for q in p])
        ),
        fixed=("operator",),
        child=HIGH,
    ),
    Case(
        "apply",
        {"operator": "flat repeat at", "positions": [(0.0, 0.3), (1.5, -0.2), (-0.3, 1.4)]},
        lambda a, b, p, operator, positions: np.min([a(p - arr(at)) for at in positions], axis=0),
        changed={"positions": [[(0.0, 0.3), (1.5, -0.2), (-0.9, 1.4)]]},
        fixed=("operator",),
    ),
    # To solids
    Case(
        "extrude",
        {"height": 0.8},
        lambda a, b, p, height: within_ends(a(p[:, :2]), np.abs(p[:, 2]) - 0.5 * height),
        lands=False,
    ),
    Case(
        "extrude",
        {"height": 0.8, "along": "y"},
        lambda a, b, p, height, along: (
            within_ends(a(p[:, [0, 2]] * (1.0, -1.0)), np.abs(p[:, 1]) - 0.5 * height)
            if along == "y"
            else within_ends(a(p[:, :2]), np.abs(p[:, 2]) - 0.5 * height)
        ),
        changed={"along": ["z"]},
        lands=False,
    ),
    Case(
        "extrude",
        {"height": 0.8, "rounding": 0.2},
        lambda a, b, p, height, rounding: (
            within_ends(a(p[:, :2]) + rounding, np.abs(p[:, 2]) - 0.5 * height + rounding)
            - rounding
        ),
        lands=False,
    ),
    Case(
        "extrude",
        {"height": 0.8, "chamfer": 0.2},
        lambda a, b, p, height, chamfer: np.maximum(
            within_ends(a(p[:, :2]), np.abs(p[:, 2]) - 0.5 * height),
            (a(p[:, :2]) + np.abs(p[:, 2]) - 0.5 * height + chamfer) / np.sqrt(2.0),
        ),
        lands=False,
    ),
    Case(
        "extrude",
        {"height": None},
        lambda a, b, p, height: a(p[:, :2]),
        fixed=("height",),
        lands=False,
    ),
    Case(
        "revolve",
        {"offset": 0.3},
        lambda a, b, p, offset: a(joined(np.hypot(p[:, 0], p[:, 2]) - offset, p[:, 1])),
        lands=False,
    ),
    Case(
        "revolve",
        {"offset": 0.3, "angle": 2.1},
        lambda a, b, p, offset, angle: revolved_part(a, p, offset, angle),
        lands=False,
    ),
    Case(
        "loft",
        {"height": 1.1, "ease": "slow start"},
        lambda a, b, p, height, ease: within_ends(
            a(p[:, :2]) + loft_share(p, height, ease) * (b(p[:, :2]) - a(p[:, :2])),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        changed={"ease": ["linear", "smooth"]},
        lands=False,
    ),
    Case(
        "twist_extrude",
        {"height": 1.6, "angle": 0.9},
        lambda a, b, p, height, angle: within_ends(
            a(
                np.array(
                    [
                        about(Z, angle * np.clip(z / height, -0.5, 0.5))[:2, :2].T @ (x, y)
                        for x, y, z in p
                    ]
                )
            ),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        child=HIGH,
        lands=False,
    ),
    Case(
        "taper_extrude",
        {"height": 1.6, "top": 0.7},
        lambda a, b, p, height, top: within_ends(
            (lambda s: s * a(p[:, :2] / s[:, None]))(
                np.interp(p[:, 2], [-0.5 * height, 0.5 * height], [1.0, top])
            ),
            np.abs(p[:, 2]) - 0.5 * height,
        ),
        child=Child(1.5, 0.4, WIDE[0][:2], WIDE[1][:2]),
        lands=False,
    ),
    Case(
        "sweep",
        {"points": [(0.2, -0.3, 0.1), (1.4, 0.6, 1.0)], "up": (0.2, 1.0, -0.3)},
        copies=lambda q, points, up: [on_way(q, *points, up)],
        changed={
            "points": [
                [(0.5, -0.3, 0.1), (1.4, 0.6, 1.0)],
                [(0.2, -0.3, 0.1), (1.4, 0.9, 1.0)],
            ]
        },
        child=SMALL,
        lands=False,
    ),
    Case(
        "sweep_bezier",
        {"start": (0.2, -0.3, 0.1), "control": (2.4, 0.6, 1.0), "end": (5.0, 1.3, -1.0)}
        | {"up": (0.2, 1.0, -0.3), "pieces": 3},
        copies=lambda q, **k: [first_piece(q, **k)],
        child=SMALL,
        lands=False,
    ),
    Case(
        "wrap_cylinder",
        {"radius": 1.2, "height": 0.3},
        # On the surface in the middle of the relief; values as they are at its inner side.
        copies=lambda q, radius, height: [
            (wrapped(joined(*q.T, 0.0), radius), (radius - 0.5 * height) / radius)
        ],
        child=SMALL,
        lands=False,
    ),
    Case(
        "wrap_cylinder",
        {"radius": 1.2, "height": 0.3, "count": 5},
        copies=lambda q, radius, height, count: [
            (
                wrapped(joined(q[:, 0] + 2.0 * np.pi * radius * i / count, q[:, 1], 0.0), radius),
                (radius - 0.5 * height) / radius,
            )
            for i in range(count)
        ],
        child=SMALL,
        lands=False,
    ),
    Case(
        "relief",
        {},
        # The child's slope is 2: the vertical way, shortened to a plane's distance.
        lambda a, b, p: (p[:, 1] - a(joined(p[:, 0], -p[:, 2]))) / np.sqrt(5.0),
        lands=False,
    ),
]
