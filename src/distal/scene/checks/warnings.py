"""Warnings while a scene is rendered: functions that violate their bounds, black pictures.

Input: a scene, the values of its parameters, the picture. Output: a warning at the author's line,
or an error if nothing can be seen. A few hundred points are evaluated, enough for mistakes that
spoil a picture; ``validation`` measures more precisely.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple
from weakref import WeakSet

import numpy as np
from numpy.typing import NDArray

from distal.fields.boxes import given_slope
from distal.fields.guarantees import Primitive
from distal.frontend import Assembly
from distal.ir.build import field as field_of
from distal.ir.build import number
from distal.ir.nodes import Call, Return
from distal.ir.types import FLOAT, VEC2
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.checks.bounds_report import bounds_of_nodes
from distal.scene.lowering.picture import SceneLowering
from distal.scene.lowering.shapes import ZERO_CELL
from distal.scene.lowering.slope_limit import loses_slope, may_be_endless, refuse_steepness
from distal.scene.objects.field import BaseShape
from distal.scene.tree.errors import refuse, warn
from distal.scene.tree.node import Node
from distal.session import SESSION

Points = NDArray[np.float64]

PLACES: Final = 512
# A function without a box is evaluated within this distance of the origin.
REACH: Final = 2.0
# Step of finite differences, as a fraction of the box's size.
STEP: Final = 1e-4
# Tolerance, so that a slope written with two digits is accepted.
SLACK: Final = 1.05
# Tolerance for a slope that is only an estimate: a normalized function may be steeper than 1 deep
# inside, where rays rarely are.
LOOSE: Final = 1.5

# The largest share of pixels with lost rays that gives no warning.
MOST_LOST: Final = 1e-3


class _Suspects(NamedTuple):
    """The nodes of a tree that are checked before a picture.

    Attributes:
        own: The author's functions without a known slope.
        endless: Moving operators that have a slope only for some children.
    """

    own: list[Node]
    endless: list[Node]


_looked_at: WeakSet[Node] = SESSION.keep("checked nodes", WeakSet())


def _suspects_of(root: Node) -> _Suspects:
    # A tree of 100,000 parts takes longer to walk than to draw.
    return root.derived("suspects", lambda: _found_suspects(root))


def _found_suspects(root: Node) -> _Suspects:
    found = _Suspects([], [])
    for node in root.walk():
        if isinstance(node.rule, Primitive) and node.rule.slope is given_slope:
            found.own.append(node)
        if may_be_endless(node) and _moves(node):
            found.endless.append(node)
    return found


def warn_of_functions(shape: BaseShape, params: Mapping[str, Any], time: float) -> None:
    """Check each of the author's functions in a shape, once per function.

    Args:
        shape: The shape.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.

    Raises:
        SceneValueError: A function returns NaN at all points.
    """
    for node in _suspects_of(shape.node).own:
        if node not in _looked_at:
            _look(node, params, time)
            _looked_at.add(node)


def check_slopes(shape: BaseShape, params: Mapping[str, Any], time: float) -> None:
    """Refuse a shape if parameters or the time leave an operator without a bound on its slope.

    Operators whose numbers do not change were checked on construction.

    Args:
        shape: The shape.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.

    Raises:
        SceneValueError: At the line of the first operator whose children still have a bound.
    """
    risky = _suspects_of(shape.node).endless
    if not risky:
        return
    declared = bounds_of_nodes(shape.node, _read(shape, params), time)
    for node in risky:
        own = declared[id(node)].slope
        inner = [declared[id(child)] for child in node.children]
        if loses_slope(own, [box.slope for box in inner]):
            refuse_steepness(node, [(box.low, box.high) for box in inner])


def _moves(node: Node) -> bool:
    """Return whether a number in a tree depends on parameters or the time."""
    return any(n.plain is None for part in node.walk() for n in part.numbers.values())


def _look(node: Node, params: Mapping[str, Any], time: float) -> None:
    shape: BaseShape = BaseShape._of(node)
    known = _read(shape, params)

    def value(p: Points) -> Points:
        found = executor().call(shape, (p,), {}, params=known, time=time, device="reference")
        return np.asarray(found, np.float64)

    low, high = _box(node, known, time)
    p = np.random.default_rng(0).uniform(low, high, (PLACES, len(low)))
    values = value(p)
    if not np.isfinite(values).any():
        hint = f"look at its values: Shape.from_function({node.name}, …)(points)"
        refuse(f"'{node.name}' gives no number at any of {PLACES} places", hint, node.place)
    if not np.isfinite(values).all():
        at = _shown(p[~np.isfinite(values)][0])
        warn(f"'{node.name}' gives no number at {at}; rays that come there see nothing", node.place)
    _look_at_slope(node, value, p, values, float(np.max(high - low)))


def _read(obj: Composed, params: Mapping[str, Any]) -> dict[str, Any]:
    """Select those values, by parameter name or label, that an object reads."""
    asked = {key for p in executor().parameters(obj) for key in (p.name, p.label)}
    return {name: value for name, value in params.items() if name in asked}


def _look_at_slope(node: Node, value: Any, p: Points, here: Points, size: float) -> None:
    claimed = node.numbers["slope"].plain
    if not isinstance(claimed, float):  # computed from parameters: only ``validation`` checks it
        return
    h = STEP * size
    # In the direction of the fastest change, the change per distance is at most the slope.
    way = np.stack([value(p + h * axis) - here for axis in np.eye(p.shape[1])], axis=1)
    way = np.nan_to_num(way, posinf=0.0, neginf=0.0)
    way /= np.maximum(np.linalg.norm(way, axis=1), 1e-30)[:, None]
    change = np.nan_to_num(np.abs(value(p + h * way) - here) / h, posinf=0.0)
    at = int(np.argmax(change))
    slack, kind = (LOOSE, "estimated") if node.estimate else (SLACK, "declared")
    if change[at] > slack * claimed:
        found = f"'{node.name}' changes by {change[at]:.3g} per unit near {_shown(p[at])}"
        hint = f"rays may pass through it; give slope={1.05 * change[at]:.2g} or more"
        warn(f"{found}, more than its {kind} slope {claimed:g}: {hint}", node.place)


def _box(node: Node, params: Mapping[str, Any], time: float) -> tuple[Points, Points]:
    """Return the declared box, whose corners may depend on parameters and the time."""
    if "low" not in node.numbers:
        n = 2 if node.flat else 3
        return np.full(n, -REACH), np.full(n, REACH)
    declared = bounds_of_nodes(node, params, time)[id(node)]
    n = 2 if node.flat else 3
    low, high = np.array(declared.low[:n]), np.array(declared.high[:n])
    # An infinite side is cut near the origin, or near the opposite side.
    cut_low = np.where(np.isfinite(low), low, np.minimum(-REACH, high - 2.0 * REACH))
    cut_high = np.where(np.isfinite(high), high, np.maximum(REACH, low + 2.0 * REACH))
    return cut_low, cut_high


def warn_of_light(scene: Any, picture: Any, params: Mapping[str, Any], time: float) -> None:
    """Warn of light that is not a number, and of a completely black picture with its likely cause.

    Args:
        scene: The scene.
        picture: The rendered picture.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.

    Raises:
        SceneValueError: The camera is inside a solid.
    """
    if picture.linear is None:
        return
    light = picture.linear[..., :3]
    if np.isnan(light.min()):
        share = np.isnan(light).any(axis=-1).mean()
        warn(
            f"in {share:.1%} of the pixels the light is not a number: look for a division by 0 "
            "or a number that overflows in the scene's own functions",
            scene.place,
        )
    if shows(light):
        return
    eye = _Eye(scene)
    shut = scene.renderer != "refracted"  # from inside glass a camera can see out
    if shut and executor().call(eye, (), {}, params=_read(eye, params), time=time) < 0.0:
        where, hint = hidden_camera(scene)
        refuse(f"the camera is {where}, and all around it is dark", hint, scene.place)
    if not _is_dark(scene):  # which is said already
        warn("the picture is black: no light comes from what the camera sees", scene.place)


def hidden_camera(scene: Any) -> tuple[str, str]:
    """Return where a camera is that is inside of a solid, and what to do.

    Args:
        scene: The scene.
    """
    where = f"inside '{scene.subject.name}'"
    hint = "move the camera, or look at the shape with view='slice'"
    if scene.has_floor:
        return f"{where} or below the floor", f"give floor=False, {hint}"
    return where, hint


def warn_of_camera(scene: Any) -> None:
    """Warn that direct light shows neither the camera's lens nor the scene's shutter.

    Args:
        scene: The scene, rendered in mode "direct".
    """
    if scene.camera.lens is not None:
        warn("the camera's aperture blurs in mode='path' only: everything is sharp", scene.place)
    if scene.shutter > 0.0:
        warn("the scene's shutter blurs in mode='path' only: nothing moves", scene.place)


def warn_of_darkness(scene: Any) -> None:
    """Warn of a scene without lights whose shapes neither emit, mirror nor refract light.

    Args:
        scene: The scene.
    """
    if _is_dark(scene):
        warn(
            "the scene has no lights: its shapes are black; leave out lights= for usual ones",
            scene.place,
        )


def _is_dark(scene: Any) -> bool:
    if scene.lights or scene.renderer != "plain":
        return False
    given = (m for n in scene.shape.node.walk() for m in (n.material, n.cut_material))
    return not any(m.emits for m in (scene.material, *given) if m is not None)


def warn_of_lost_rays(scene: Any, lost: Mapping[str, float]) -> None:
    """Warn if more than 0.1 % of a picture's pixels have rays that ended without an answer.

    Args:
        scene: The scene.
        lost: The share of such pixels, by reason (``runtime.lost_rays``).
    """
    if lost.get("inside", 0.0) >= 1.0:
        where, hint = hidden_camera(scene)
        warn(f"the camera is {where}: {hint}", scene.place)
    found = {why: share for why, share in lost.items() if share > MOST_LOST and why != "inside"}
    if not found:
        return
    steps = "their steps" if scene.steps is None else f"their {scene.steps} steps"
    causes = {
        "steps": (f"rays used up {steps} before they met a surface", "steps"),
        "shadow steps": ("rays to a light used up their steps", "steps"),
        "far": ("rays ended at the far limit on their way to a surface", "far"),
    }
    causes_found = "; ".join(
        f"in {share:.1%} of the pixels {causes[w][0]}" for w, share in found.items()
    )
    more = []
    if found.keys() & {"steps", "shadow steps"}:
        more.append(f"steps={2 * (scene.steps or 160)} or more")
    if "far" in found:
        more.append("a larger far, or fog that hides what is far away")
    warn(f"{causes_found}: give {' and '.join(more)}", scene.place)


def shows(values: NDArray[np.float32]) -> bool:
    """Return whether any value is not 0; most pictures show it in a few pixels."""
    return bool(values[::16, ::16].any() or values.any())


class _Eye(Composed):
    """The distance of a scene's shape at its camera, as a function without arguments."""

    name, signature, result = "eye", (), FLOAT

    def __init__(self, scene: Any) -> None:
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name.

        It evaluates the shape at the origin of the ray in the middle of the picture.
        """
        made = SceneLowering(assembly, self._scene)
        node = made.node
        field = made.composer.field(node, made.composer.values.all(node), ZERO_CELL)
        site = {"uv": number(0.0, VEC2), "resolution": number(1.0, VEC2)}
        origin = field_of(self._scene.camera.emit(made.composer, site), "origin")
        value = Call(field.name, (origin, *field.captures), FLOAT)
        return assembly.define("eye", (), FLOAT, (Return(value),), self._scene.place)


def _shown(p: Points) -> str:
    return f"({', '.join(f'{c:.3g}' for c in p)})"
