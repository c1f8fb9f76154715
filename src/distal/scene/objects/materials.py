"""Materials of shapes.

Input: colors, weights and numbers, each a constant, a parameter, an expression, or a pattern.
Output: a ``Material``, which computes the ``Surface`` at a place of the shape that it paints. The
formulas are scene code of ``render.material``; this module checks the values and records what the
choice of a renderer depends on: whether the material reflects or refracts rays.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar, Final, cast

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC3, Struct
from distal.lang import func, log, max, vec3
from distal.lang.expressions import Expression, Symbolic
from distal.lang.functions import Func
from distal.lang.source_places import author_place
from distal.lang.values import VectorValue
from distal.render import material as library
from distal.render import named_materials, own_scattering
from distal.render.bump import raised
from distal.render.declarations import MATERIALS, Declaration
from distal.scene.objects.declared import declared_function, scene_call
from distal.scene.objects.scene_object import CalledObject
from distal.scene.tree.arguments import arguments
from distal.scene.tree.calls import FunctionCall, Pattern
from distal.scene.tree.conversion import Asked, number, unwrapped
from distal.scene.tree.conversion import Number as CheckedNumber
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.own_functions import DENSITY, EVALUATE, SAMPLE, OwnBsdf
from distal.scene.tree.value import CallRecord, recorded, value_of

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Color, Number, Varying
    from distal.scene.tree.texts import TextWriter

_WEIGHTS: Final = ("diffuse", "specular", "transmission")
# The sum of weights like 0.85, 0.05 and 0.1 is slightly above 1 in floats.
_SLACK: Final = 1e-6
# The least transmittance of glass, so that its logarithm is finite.
_DARKEST: Final = 1e-4


@recorded
class Material(CalledObject):
    """The appearance of a shape. A material never changes after construction.

    ``diffuse``, ``specular`` and ``transmission`` are shares of the incoming light and add up to at
    most 1. Each argument is a number (or a color), a parameter, an expression, or a pattern.

    Args:
        color: Color of scattered light, and of a metal's reflections: "#rrggbb", a CSS name
            ("tomato"), or linear red, green, blue.
        diffuse: Share of light that is scattered in all directions.
        specular: Share of light that is reflected.
        transmission: Share of light that is transmitted.
        ior: Index of refraction.
        roughness: From 0 for sharp reflections to 1 for very blurred ones.
        metal: From 0 for white reflections to 1 for reflections with the material's color.
        emission: Emitted light, a color.
        absorption: Absorption coefficient inside per scene unit, for each color channel.
        fresnel: Whether reflection increases towards grazing angles as in glass; False keeps the
            weights constant.
        dispersion: How much the index depends on the wavelength: 20 divided by Abbe's number (crown
            glass 0.3, flint 0.6, diamond 0.36). Only mode "path" shows it.

    Raises:
        ValueError: A number is out of its range, or the weights add up to more than 1.
        TypeError: An argument has the wrong type.

    Attributes:
        call: The scene function ``(places…) -> Surface`` and its values.
        reflects: Whether rays may be reflected.
        refracts: Whether rays may enter the inside.
        emits: Whether it may emit light.
        priority: Which of two overlapping solids displaces the other; set by ``paint``.
    """

    __slots__ = ("emits", "priority", "reflects", "refracts")

    noun: ClassVar[str] = "material"
    reflects: bool
    refracts: bool
    emits: bool
    priority: int

    def __init__(
        self,
        color: Color | Varying = (1.0, 1.0, 1.0),
        diffuse: Number | Varying = 1.0,
        specular: Number | Varying = 0.0,
        transmission: Number | Varying = 0.0,
        ior: Number | Varying = 1.5,
        roughness: Number | Varying = 0.0,
        metal: Number | Varying = 0.0,
        emission: Color | Varying = (0.0, 0.0, 0.0),
        absorption: Color | Varying = (0.0, 0.0, 0.0),
        *,
        fresnel: Number | Varying = False,
        dispersion: Number | Varying = 0.0,
    ) -> None:
        given = {
            "color": color,
            "diffuse": diffuse,
            "specular": specular,
            "transmission": transmission,
            "ior": ior,
            "roughness": roughness,
            "metal": metal,
            "emission": emission,
            "absorption": absorption,
            "fresnel": float(fresnel) if isinstance(fresnel, bool) else fresnel,
            "dispersion": dispersion,
        }
        place = author_place()
        call = _call("Material", surface, given, place)
        reflects = _may_be(call.values["specular"]) or _may_be(call.values["fresnel"])
        refracts = _may_be(call.values["transmission"])
        emits = _may_be(call.values["emission"])
        self._keep(call=call, reflects=reflects, refracts=refracts, emits=emits, priority=0)

    @classmethod
    def of(
        cls,
        call: FunctionCall,
        *,
        reflects: bool,
        refracts: bool,
        emits: bool,
        priority: int = 0,
    ) -> Material:
        """Return the material of a scene function.

        Args:
            call: The function, which returns a ``Surface``, and its values.
            reflects: Whether it reflects mirror images.
            refracts: Whether light passes through it.
            emits: Whether it may emit light.
            priority: Which of two overlapping solids displaces the other.
        """
        made = cls.__new__(cls)
        made._keep(call=call, reflects=reflects, refracts=refracts, emits=emits, priority=priority)
        return made

    def _replaced(self, changes: dict[str, Any]) -> Material:
        """Return the material with other arguments; ``priority`` too, as ``paint`` sets it."""
        priority = changes.pop("priority", self.priority)
        made = super()._replaced(changes) if changes else self
        return made if made.priority == priority else made._with(made.call, priority)

    def with_call(self, call: FunctionCall) -> Material:
        """Return the material with other values of the same function."""
        return self._with(call, self.priority)

    def _with(self, call: FunctionCall, priority: int) -> Material:
        made = Material.of(
            call,
            reflects=self.reflects,
            refracts=self.refracts,
            emits=self.emits,
            priority=priority,
        )
        return made._with_origin_of(self)

    def _written(self, writer: TextWriter) -> str:
        text = super()._written(writer)
        return f"{text}.replace(priority={self.priority})" if self.priority else text

    def _compared(self) -> tuple[Any, ...]:
        rays = (self.reflects, self.refracts, self.emits)
        return self.noun, self.call, rays, self.priority

    @property
    def uses(self) -> frozenset[str]:
        """Which of ``declarations.PLACE_NAMES`` the material depends on."""
        return self.call.uses

    def bump(self, height: Number | Varying) -> Material:
        """Return the material with a relief that is seen in its shading, not in its outline.

        ``matte("grey").bump(0.02 * np.sin(40 * place.y))``. The shape and its shadows do not
        change, so it costs no steps. In mode "path", light that the relief mirrors into the surface
        is lost; glass is refracted by the shape itself in direct light.

        Args:
            height: The height in scene units, outwards: an expression of ``place`` and ``cell``, a
                pattern of numbers, or a ``@func`` of a place that returns a float.

        Raises:
            TypeError: The height is a color or another object.
        """
        given = {"surface": self, "height": height}
        made = Material.of(
            _call("bump", raised, given, author_place(), limits={}),
            reflects=self.reflects,
            refracts=self.refracts,
            emits=self.emits,
            priority=self.priority,
        )
        made._record(CallRecord(_bumped, (), given, Material))
        return made

    def bsdf(
        self, evaluate: Func, sample: Func | None = None, density: Func | None = None
    ) -> Material:
        """Return the material with light scattered by a function of your own in mode "path".

        Other modes show the material itself. Its color and numbers, patterns included, are the
        first argument of each function: ``surface.color``, ``surface.roughness``; but for its
        weights, which are 0, for the library scatters nothing. All directions are unit vectors of
        space and lead away from the surface; ``n`` is on the side of the view. ``surface.ior`` is
        the index beyond the surface, relative to the side of the view; light that is refracted
        has no factor for it, because radiance counts divided by the square of the index. Of two
        functions in one mixture, that of the larger share has the light of both. Try it with
        ``furnace``.

        Args:
            evaluate: ``(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3``, the
                fraction of light from a direction that goes to the view, per solid angle (1 / sr),
                without the cosine. It may be above 0 on the other side of the surface.
            sample: ``(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3``, a direction to
                the light for three random numbers in [0, 1); of length 0 where there is none. By
                default as dense as the cosine, on the side of the view.
            density: ``(surface: Surface, n: vec3, view: vec3, light: vec3) -> float``, the density
                of these directions (1 / sr).

        Raises:
            TypeError: A function takes or returns something else, or one of ``sample`` and
                ``density`` is missing.
        """
        place = author_place()
        if (sample is None) is not (density is None):
            missing = "density" if density is None else "sample"
            refuse_kind(
                f"bsdf needs '{missing}': sample and density belong together",
                "density is that of the directions of sample, by solid angle; or leave out both",
                place,
            )
        own = OwnBsdf(
            EVALUATE.checked(evaluate, place),
            own_scattering.even_sample if sample is None else SAMPLE.checked(sample, place),
            own_scattering.even_density if density is None else DENSITY.checked(density, place),
        )
        values = {"surface": self, "bsdf": own}
        made = Material.of(
            FunctionCall("bsdf", own_scattering.with_bsdf, values, place),
            reflects=self.reflects,
            refracts=self.refracts,
            emits=self.emits,
            priority=self.priority,
        )
        chosen = {} if sample is None else {"sample": sample, "density": density}
        given = {"surface": self, "evaluate": evaluate, **chosen}
        made._record(CallRecord(_scattered, (), given, Material))
        return made

    @property
    def has_bump(self) -> bool:
        """Whether a relief is painted on it, or on a part of it."""
        return any(function is raised for function in self.call.functions())

    def mix(
        self,
        other: Material | Color | Varying,
        t: Number | Varying = 0.5,
    ) -> Material:
        """Return a mixture: this material at t = 0, another at t = 1.

        All numbers are interpolated.

        Args:
            other: A material or a color.
            t: From 0 to 1; may be a pattern.
        """
        return mixed(self, as_material(other), t, "mix", author_place())


def _bumped(surface: Material, height: Number | Varying) -> Material:
    """Return ``surface.bump(height)``: its arguments are named as those of its function."""
    return surface.bump(height)


cast("Any", _bumped).written_as = ".bump"


def _scattered(
    surface: Material, evaluate: Func, sample: Func | None = None, density: Func | None = None
) -> Material:
    """Return ``surface.bsdf(evaluate, …)``."""
    return surface.bsdf(evaluate, sample, density)


cast("Any", _scattered).written_as = ".bsdf"


@func
def surface(
    color: vec3,
    diffuse: float,
    specular: float,
    transmission: float,
    ior: float,
    roughness: float,
    metal: float,
    emission: vec3,
    absorption: vec3,
    fresnel: float,
    dispersion: float,
) -> library.Surface:
    """Make a ``Surface`` from its numbers."""
    return library.Surface(
        color,
        diffuse,
        specular,
        transmission,
        ior,
        roughness,
        metal,
        emission,
        absorption,
        fresnel,
        dispersion,
    )


@func
def grey(amount: float) -> vec3:
    """Return an amount as a grey color."""
    return vec3(amount)


def accept(value: Any, asked: Asked) -> Any:
    """Return a pattern, function or material for a parameter; None for other values."""
    if isinstance(value, Func):
        value = own_pattern(value, (), {}, asked.place)
    if isinstance(asked.type, Struct):
        return as_material(value, asked.place) if asked.type.name == "Surface" else None
    if isinstance(value, Material):
        refuse_kind(f"'{asked.label}' takes no material", place=asked.place)
    if not isinstance(value, Pattern):
        return None
    if value.result is asked.type:
        return value
    if asked.type is VEC3 and value.result is FLOAT:
        grays = Pattern("grey", grey, {"amount": value}, value.place)
        return grays._with_origin_of(value)
    refuse_kind(
        f"'{asked.label}' takes a {asked.type}; {value.what} gives a {value.result}",
        place=asked.place,
    )


def own_pattern(
    function: Func, args: tuple[Any, ...], kwargs: Mapping[str, Any], place: Span | None
) -> Pattern | Material:
    """Make a pattern from an author's function; a material if it returns a ``Surface``.

    Args:
        function: The author's ``@func`` of a place.
        args: Its numbers by position.
        kwargs: Its numbers by name.
        place: The author's line.
    """
    what = function.name
    call = _call(what, function, kwargs, place, args, {})
    result = call.result
    made: Pattern | Material | None = None
    if isinstance(result, Struct) and result.name == "Surface":
        made = Material.of(call, reflects=True, refracts=True, emits=True)
    elif result is FLOAT or result is VEC3:
        made = Pattern(what, function, call.values, place)
    if made is not None:
        numbers = {name: value_of(value) for name, value in call.values.items()}
        made._record(CallRecord(pattern_of, (function,), numbers, type(made)))
        return made
    gives = "nothing that is known" if result is None else f"a {result}"
    refuse_kind(
        f"'{what}' is no pattern: it gives {gives}",
        f"def {what}(p: vec3) -> vec3, or -> float, or -> Surface",
        place,
    )


def pattern_of(function: Func, **numbers: Any) -> Pattern | Material:
    """Make a pattern from an author's function and its numbers by name."""
    return own_pattern(function, (), numbers, author_place())


cast("Any", pattern_of).written_as = "pattern"


def mixed(a: Material, b: Material, t: Any, what: str, place: Span | None) -> Material:
    """Return a mixture of two materials.

    Args:
        a: The material at t = 0.
        b: The material at t = 1.
        t: The share of ``b``: a number or a pattern.
        what: The name in messages.
        place: The author's line.
    """
    share = arguments(
        library.mix_surfaces,
        (),
        {"t": t},
        what=what,
        limits={"t": Limit.FRACTION},
        place=place,
        accept=accept,
    )
    call = FunctionCall(what, library.mix_surfaces, {"a": a, "b": b, **share}, place)
    made = Material.of(
        call,
        reflects=a.reflects or b.reflects,
        refracts=a.refracts or b.refracts,
        emits=a.emits or b.emits,
    )
    made._record(CallRecord(_mixed_again, (), {"a": a, "b": b, "t": t}, Material))
    return made


def _mixed_again(a: Material, b: Material, t: Number | Varying) -> Material:
    return a.mix(b, t)


cast("Any", _mixed_again).written_as = ".mix"


def as_material(value: Any, place: Span | None = None) -> Material:
    """Return the material of a value: a material, a color, a pattern, a ``@func`` of a place.

    Raises:
        TypeError: The value is none of these.
        ValueError: The value is not a valid color.
    """
    place = place or author_place()
    if isinstance(value, Func):
        value = own_pattern(value, (), {}, place)
    if isinstance(value, Material):
        return value
    plain = unwrapped(value)
    is_color = isinstance(plain, str | tuple | list | Symbolic | VectorValue | Pattern)
    if not is_color:
        hint = 'write matte("#rrggbb"), glass(), metal() or Material(color=…)'
        if isinstance(value, FunctionType) and value.__module__.startswith("distal."):
            hint = f"call it: {value.__name__}()"
        refuse_kind(
            f"a material or a color is wanted, not {type(value).__name__} {value!r:.40}",
            hint,
            place,
        )
    made = _declared(MATERIALS.members["matte"], {"color": value}, place)
    made._record(CallRecord(FUNCTIONS["matte"], (), {"color": value}, Material))
    return made


# Materials with a name


def _declared(declaration: Declaration, given: Mapping[str, Any], place: Span | None) -> Material:
    call = _call(declaration.name, declaration.function, given, place, limits=declaration.limits)
    return Material.of(
        call,
        reflects=declaration.reflects,
        refracts=declaration.refracts,
        emits=declaration.emits,
    )


assert named_materials  # importing it declares the materials by name
FUNCTIONS: Final = {
    name: declared_function(found, _declared, __name__, "Material")
    for name, found in MATERIALS.members.items()
}
globals().update(FUNCTIONS)


@recorded
def glass(
    ior: Number | Varying = 1.5,
    color: Color | None = None,
    *,
    absorption: Color | Varying | None = None,
    dispersion: Number | Varying = 0.0,
) -> Material:
    """Make a transparent material (glass, water, ice) with refraction and Fresnel reflection.

    Args:
        ior: Index of refraction: 1.33 water, 1.5 glass, 2.42 diamond.
        color: Color of white light after one scene unit inside; instead of ``absorption``.
        absorption: Absorption coefficient inside per scene unit, for each color channel.
        dispersion: How much the index depends on the wavelength: 20 divided by Abbe's number (crown
            glass 0.3, flint 0.6, diamond 0.36). Only mode "path" shows it.

    Raises:
        ValueError: The index is not above 0, or a number is out of its range.
        TypeError: An argument has the wrong type, or both color and absorption are given.
    """
    place = author_place()
    if color is not None and absorption is not None:
        refuse_kind(
            "glass takes color or absorption, not both", "each follows from the other", place
        )
    given: dict[str, Any] = {"ior": ior, "dispersion": dispersion}
    if color is not None:
        given["absorption"] = _absorption(color, place)
    elif absorption is not None:
        given["absorption"] = absorption
    call = _call("glass", library.glass, given, place)
    return Material.of(call, reflects=True, refracts=True, emits=False)


# What is changed of these displaces the other.
cast("Any", glass).alternatives = (("color", "absorption"),)


def _absorption(color: Any, place: Span | None) -> Any:
    """Return the absorption that turns white light into a color in one unit (Beer-Lambert)."""
    asked = Asked("color", "glass", VEC3, Limit.FRACTION, is_color=True, place=place)
    left: Any = number(color, asked).value
    if not isinstance(left, Expression):
        left = vec3(*left)
    return -log(max(left, _DARKEST))


def _call(
    what: str,
    function: Func,
    given: Mapping[str, Any],
    place: Span | None,
    args: tuple[Any, ...] = (),
    limits: Mapping[str, Limit] | None = None,
) -> FunctionCall:
    call = scene_call(
        MATERIALS, function, given, what, place, args=args, limits=limits, accept=accept
    )
    _check_weights(what, call.values, place)
    return call


def _may_be(value: Any) -> bool:
    """Return whether a weight is, or may become, larger than 0."""
    return not isinstance(value, CheckedNumber) or value.may_exceed(0.0)


def _check_weights(what: str, values: Mapping[str, Any], place: Span | None) -> None:
    known = {n: values[n].plain for n in _WEIGHTS if isinstance(values.get(n), CheckedNumber)}
    total = sum(weight for weight in known.values() if weight is not None)
    if total > 1.0 + _SLACK:
        listed = " + ".join(f"{name} {known[name]:g}" for name in known if known[name])
        refuse(
            f"the weights of {what} add up to {total:g}: {listed}",
            "give away at most all of the light: a sum of 1",
            place,
        )
