"""A material in a white furnace: how much light it gives back, and whether its sampling is right.

Input: a material. Output: a ``Furnace``: what a surface scatters of light from all sides, once by
its random directions and once by counting over all directions, and every contradiction between its
functions. Meant for scattering functions of authors (``Material.bsdf``); right for every material.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.ir.build import boolean, builtin, number
from distal.ir.nodes import Apply, Expr, Param, Read, Return
from distal.ir.types import VEC3, FunctionType, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.lang.source_places import author_place
from distal.render import scatter
from distal.render.footprint import point_footprint
from distal.render.sampling.warps import in_cone
from distal.scene.lowering.ray_functions import function_in
from distal.scene.lowering.scattering import number_bsdfs, scattering_functions
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.objects.materials import Material, as_material
from distal.scene.tree.errors import refuse
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.frontend import Assembly
    from distal.scene.objects.argument_types import Color, Varying

COSINES: Final = (1.0, 0.8, 0.5, 0.25, 0.1)
# Random directions, and directions that are counted over, for each view.
SAMPLES: Final = 1 << 14
COUNTED: Final = 1 << 20
# Cells of the sphere, by height and turn, in which directions are counted.
ROWS: Final = 16
COLUMNS: Final = 24
# Deviations beyond these are faults: of chi-square in standard deviations, of shares in light.
SURPRISING: Final = 5.0
NOTICED: Final = 0.05
SLACK: Final = 0.01
# A scattering function differs from its mirrored one by this share of its mean.
RECIPROCAL: Final = 0.02
# The axes along a surface and its normal, as columns.
UPRIGHT: Final = np.eye(3)


@dataclass(frozen=True, slots=True)
class FurnaceView:
    """What a material does with light from all sides, of brightness 1, seen at one angle.

    Attributes:
        cosine: The cosine of the angle to the normal.
        albedo: The red, green and blue light that goes to the view, by random directions.
        counted: The same without perfect mirrors and smooth glass, by all directions.
        specular: The part of ``albedo`` that perfect mirrors and smooth glass make.
        density: The integral of the density over all directions.
        sampled: The share of random directions that have a density.
    """

    cosine: float
    albedo: tuple[float, float, float]
    counted: tuple[float, float, float]
    specular: tuple[float, float, float]
    density: float
    sampled: float


@dataclass(frozen=True, slots=True)
class Furnace:
    """What a material does with light, and what is wrong with it.

    Attributes:
        views: The light at each angle.
        reciprocity: How far the function changes if view and light change places, as a share of
            its mean; 0 for a reciprocal one.
        faults: What is wrong, one sentence for each kind, at the first angle that shows it.
        notes: What may be meant.
    """

    views: tuple[FurnaceView, ...]
    reciprocity: float
    faults: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        rows = ["cosine  albedo               counted              density"]
        for view in self.views:
            albedo = " ".join(f"{share:6.4g}" for share in view.albedo)
            counted = " ".join(f"{share:6.4g}" for share in view.counted)
            rows.append(f"{view.cosine:<6.2g}  {albedo}  {counted}  {view.density:6.4g}")
        rows += [f"fault: {fault}" for fault in self.faults]
        rows += [f"note: {note}" for note in self.notes]
        return "\n".join(rows)


def furnace(
    material: Material | Color | Varying,
    cosines: float | Iterable[float] = COSINES,
    *,
    inside: bool = False,
    params: Mapping[str, Any] | None = None,
) -> Furnace:
    """Return how much light a material gives back, and what is wrong with its functions.

    The surface is lit from all sides by light of brightness 1 (a white furnace). No material may
    give back more; a white one that loses nothing gives back 1. ``print(furnace(m))`` shows a
    table; a test asserts that ``furnace(m).faults`` is empty. Each angle is tried with the normal
    (0, 0, 1), whose light is in ``views``, and with another one.

    Args:
        material: The material, with a scattering function of your own (``bsdf``) or without; its
            patterns are seen at the origin.
        cosines: The angles of the view: one or several cosines to the normal, above 0, at most 1.
        inside: Whether the view is on the inside of the solid.
        params: Values of parameters by name; the others have their defaults.

    Raises:
        CompileError: A function of the material has mistakes.
        ValueError: A cosine is out of its range.
        TypeError: It is no material.
    """
    place = author_place()
    tried = as_material(material, place)
    angles = (cosines,) if isinstance(cosines, int | float) else tuple(cosines)
    if not angles:
        refuse("furnace needs a cosine", "furnace(material, [1.0, 0.5])", place)
    for cosine in angles:
        if not 0.0 < cosine <= 1.0:
            refuse(f"furnace: cosine {cosine:g} is out of range", "above 0, at most 1", place)
    trial = _Trial(tried, params or {}, inside=inside)
    with np.errstate(all="ignore"):
        found = [trial.seen_at(cosine, UPRIGHT) for cosine in angles]
        turned = [trial.seen_at(cosine, _turn(k)) for k, cosine in enumerate(angles)]
        reciprocity = trial.reciprocity()
    notes = []
    if reciprocity > RECIPROCAL:
        share = f"{100 * reciprocity:.1f} %"
        notes.append(f"view and light change places: the function differs by {share} of its mean")
    faults: dict[str, str] = {}
    for _, of_view in (*found, *turned):
        faults = {**of_view, **faults}
    views = tuple(view for view, _ in found)
    return Furnace(views, reciprocity, tuple(faults.values()), tuple(notes))


class _Trial:
    """A material whose functions are evaluated at many directions."""

    def __init__(self, material: Material, params: Mapping[str, Any], *, inside: bool) -> None:
        self._params = params
        self._respond = _ScatteringProgram(material, "respond", "light", inside=inside)
        self._scatter = _ScatteringProgram(material, "scatter", "u", inside=inside)
        # The middles of cells, and random places in them: two halves, which tell how well a narrow
        # lobe is counted.
        middles = _middles(round(math.sqrt(COUNTED / 4)))
        rng = np.random.default_rng(7)
        spread = (rng.random(middles.shape, np.float32) - 0.5) * np.float32(2.0 * middles[0, 0])
        places: Any = np.concatenate([middles, middles + spread])
        upper = np.asarray(in_cone(places, 1.0), np.float32)
        self._around = np.concatenate([upper, upper * np.array([1, 1, -1], np.float32)])
        first = np.arange(len(self._around)) % len(upper) < len(middles)
        self._halves = (first, ~first)

    def _called(self, program: _ScatteringProgram, view: Any, other: Any, n: Any) -> Any:
        views = np.broadcast_to(np.asarray(view, np.float32), other.shape)
        normals = np.broadcast_to(np.asarray(n, np.float32), other.shape)
        given = (views.copy(), other, normals.copy())
        return executor().call(program, given, {}, params=self._params)

    def seen_at(self, cosine: float, turn: Any) -> tuple[FurnaceView, dict[str, str]]:
        """Return what is seen at an angle, and what is wrong there, by kind.

        Args:
            cosine: The cosine of the angle.
            turn: The axes along the surface and the normal, as columns.
        """
        view = turn @ (math.sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine)
        n = turn[:, 2]
        onward = self._called(self._scatter, view, self._numbers(), n)
        weight = np.asarray(onward.weight, float)
        density = np.asarray(onward.density, float)
        specular = np.asarray(onward.specular, bool)
        around = (self._around @ turn.T).astype(np.float32)
        response = self._called(self._respond, view, around, n)
        value, dense = np.asarray(response.value, float), np.asarray(response.density, float)
        area = 4.0 * math.pi / len(self._around)
        spread = np.where(specular[:, None], 0.0, weight)
        seen = FurnaceView(
            cosine,
            _color(weight.mean(0)),
            _color(value.sum(0) * area),
            _color((weight - spread).mean(0)),
            float(dense.sum() * area),
            float(np.mean((density > 0.0) & ~specular)),
        )
        numbers = {"evaluate": value, "density": dense, "sample": np.c_[weight, density]}
        for name, found in numbers.items():
            if not np.isfinite(found).all():
                return seen, {"finite": f"{name} gives a value that is not finite {_at(seen)}"}
        directions = np.asarray(onward.direction, float)[(density > 0.0) & ~specular] @ turn
        halves = [np.c_[value, dense][half].sum(0) * 2.0 * area for half in self._halves]
        error = 4.0 * spread.std(0).max() / math.sqrt(len(spread))
        error += 3.0 * float(np.abs(halves[0] - halves[1]).max())
        faults = _faults_of(seen, error, least=min(found.min() for found in numbers.values()))
        missed = float(value[dense <= 0.0].sum(0).max() * area)
        if missed > SLACK:
            share = f"{missed:.3f} of the light"
            faults = {k: text for k, text in faults.items() if k not in ("sample", "density")}
            faults["missed"] = f"{share} comes from directions of density 0 {_at(seen)}"
        elif not faults:
            faults = self._misplaced(seen, directions, dense * area * len(spread))
        return seen, faults

    def _misplaced(self, seen: FurnaceView, directions: Any, expected: Any) -> dict[str, str]:
        """Return whether random directions are as dense as they say, by cells of the sphere."""
        cells = self._cells(self._around)
        most = ROWS * COLUMNS
        halves = [np.bincount(cells[h], 2.0 * expected[h], minlength=most) for h in self._halves]
        counts = np.bincount(self._cells(directions), minlength=most).astype(float)
        wanted = 0.5 * (halves[0] + halves[1])
        whole = max(2.0 * counts.sum(), 1.0)
        differ = float(np.abs(counts - wanted).sum()) / whole
        unknown = float(np.abs(halves[0] - halves[1]).sum()) / whole
        # Of a narrow lobe few directions are counted, and each falls into one cell or another.
        few = float((expected**2).sum()) / max(float(expected.sum()) ** 2, 1e-30)
        unknown += 0.5 * math.sqrt(most * few)
        if differ <= NOTICED + unknown or deviation(counts, wanted) <= SURPRISING:
            return {}
        share = f"{100 * differ:.0f} %"
        return {"dense": f"sample and density disagree in {share} of directions {_at(seen)}"}

    def _cells(self, directions: Any) -> Any:
        row = np.clip(0.5 * ROWS * (directions[:, 2] + 1.0), 0, ROWS - 1).astype(int)
        turn = np.arctan2(directions[:, 1], directions[:, 0]) / (2.0 * math.pi) % 1.0
        return row * COLUMNS + np.minimum((turn * COLUMNS).astype(int), COLUMNS - 1)

    def reciprocity(self) -> float:
        """Return how far the function changes if view and light change places, on one side."""
        count = 1 << 12
        flat = (np.random.default_rng(3).random((2, count, 2))).astype(np.float32)
        a, b = (np.asarray(in_cone(side, 0.95), np.float32) for side in flat)
        there = self._called(self._respond, a, b, UPRIGHT[:, 2]).value
        back = self._called(self._respond, b, a, UPRIGHT[:, 2]).value
        one = np.asarray(there, float) / b[:, 2:]
        other = np.asarray(back, float) / a[:, 2:]
        mean = float(np.abs(one).mean())
        return float(np.abs(one - other).mean()) / mean if mean > 0.0 else 0.0

    def _numbers(self) -> Any:
        """Return random triples; the first two spread evenly."""
        side = round(math.sqrt(SAMPLES))
        rng = np.random.default_rng(5)
        flat = _middles(side) + (rng.random((side * side, 2)) - 0.5) / side
        return np.column_stack([flat, rng.random(side * side)]).astype(np.float32)


class _ScatteringProgram(Composed):
    """A function of one material, of a view, another vector and the normal."""

    def __init__(self, material: Material, function: str, other: str, *, inside: bool) -> None:
        self._material, self._function, self._inside = material, function, inside
        self.name = f"{material.call.what} ({function})"
        self.signature = (("view", VEC3), (other, VEC3), ("n", VEC3))
        self.result: Type = VEC3

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        body = StatementList(taken={name for name, _ in self.signature})
        composer = ShapeComposer(assembly, [])
        number_bsdfs(composer, [self._material])
        functions = scattering_functions(composer, partial(function_in, assembly))
        view, other, n = (Read(name, type) for name, type in self.signature)
        site: dict[str, Expr] = {
            "p": number(0.0, VEC3),
            "n": n,
            "cell": ZERO_CELL,
            "footprint": composer.call(point_footprint, {}),
            "facing": builtin("abs", builtin("dot", view, n)),
        }
        surface = body.let("surface", self._material.emit(composer, site))
        met = {"surface": surface, "view": view, "n": n, "inside": boolean(self._inside)}
        meeting = body.let("meeting", composer.call(scatter.meet, met))
        called = functions[self._function]
        assert isinstance(called.type, FunctionType)
        result = Apply(called, (meeting, other), called.type.result)
        self.result = result.type
        body.statements.append(Return(result))
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define("tried", params, self.result, body.statements)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the material calls."""
        return self._material.call.functions()


def _faults_of(seen: FurnaceView, error: float, *, least: float) -> dict[str, str]:
    """Return what is wrong with the light at an angle, by kind.

    Args:
        seen: The light.
        error: How far the light by random directions and by all of them may be apart.
        least: The least of all values.
    """
    slack = SLACK + error
    faults: dict[str, str] = {}
    if least < 0.0:
        faults["sign"] = f"a value is below 0 ({least:.3g}) {_at(seen)}"
    most = max(seen.albedo)
    if most > 1.0 + slack:
        faults["energy"] = f"gives back {most:.4g} of the light {_at(seen)}: more than it gets"
    whole = [a + b for a, b in zip(seen.counted, seen.specular, strict=True)]
    if max(abs(a - b) for a, b in zip(seen.albedo, whole, strict=True)) > slack:
        a, b = (" ".join(f"{share:.4g}" for share in color) for color in (seen.albedo, whole))
        faults["sample"] = f"sample finds {a} of the light {_at(seen)}, all directions have {b}"
    if abs(seen.density - seen.sampled) > NOTICED + error:
        whole_density = f"{seen.density:.4g} instead of {seen.sampled:.4g}"
        faults["density"] = f"the density adds up to {whole_density} {_at(seen)}"
    return faults


def deviation(counts: Any, expected: Any) -> float:
    """Return how far counts are from those expected, in standard deviations.

    Cells that expect less than five are counted together. Wilson and Hilferty's cube root makes a
    normal variable of chi-square.
    """
    few = expected < 5
    pairs = [(c, e) for c, e in zip(counts[~few], expected[~few], strict=True)]
    pairs.append((counts[few].sum(), expected[few].sum()))
    statistic = sum((c - e) ** 2 / e for c, e in pairs if e > 1e-9)
    freedom = max(len(pairs) - 1, 1)
    middle = 1 - 2 / (9 * freedom)
    return float(((statistic / freedom) ** (1 / 3) - middle) / math.sqrt(2 / (9 * freedom)))


def _turn(number: int) -> Any:
    """Return axes along a surface and its normal as columns, other ones for each number."""
    axes, _ = np.linalg.qr(np.random.default_rng(11 + number).normal(size=(3, 3)))
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return axes


def _middles(side: int) -> Any:
    """Return the middles of the cells of the unit square."""
    places = (np.arange(side, dtype=np.float32) + np.float32(0.5)) / np.float32(side)
    return np.stack(np.meshgrid(places, places, indexing="ij"), -1).reshape(-1, 2)


def _color(values: Any) -> tuple[float, float, float]:
    red, green, blue = (float(value) for value in values)
    return red, green, blue


def _at(seen: FurnaceView) -> str:
    return f"at cosine {seen.cosine:g}"
