"""Declare scene functions as the lights, cameras, materials, patterns and backgrounds of the API.

Input: ``@func`` functions and the limits of their parameters. Output: a ``Declaration`` for each,
stored in its family in the order of declaration. Does not depend on the object model, which makes
the public classes and functions from the declarations.

The public object has the parameters of its scene function, in their order and with their defaults,
except those that the scene passes for each ray or point (``Family.site``). The scene function's
docstring is the object's docstring.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any, Final, TypeVar

from distal.fields.guarantees import Limit, Requirement
from distal.lang.functions import Func

F = TypeVar("F", bound=Func)


class Move(Enum):
    """How an argument changes if its object is translated, rotated, scaled or reflected.

    Arguments without a move, such as colors and intensities, stay.
    """

    POSITION = auto()
    """A point."""
    DIRECTION = auto()
    """A direction, of any length: translations do not change it."""
    LENGTH = auto()
    """A length: only a scale changes it; by the geometric mean of its factors if they differ."""
    SIDE = auto()
    """Whether left and right are swapped: a reflection changes it."""


@dataclass(frozen=True, slots=True)
class ExtraParameter:
    """A parameter of the public object that its scene function does not have.

    Attributes:
        name: Its name.
        default: Its default.
        annotation: Its type, in terms of ``scene.objects.argument_types``.
        doc: Its line in the docstring.
        keyword_only: Whether it is passed by name only, after the function's own parameters;
            otherwise it is positional and comes before them.
    """

    name: str
    default: Any
    annotation: str
    doc: str
    keyword_only: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Declaration:
    """A public class or function, defined by a scene function.

    Attributes:
        name: The public name: "PointLight".
        function: The scene function.
        family: Its family.
        limits: The allowed range of each number; a number that is not listed can be any finite
            one.
        requires: Returns why arguments are not valid together, or None.
        extras: Parameters besides those of the function.
        moves: How arguments change if the object is placed, besides those of the family.
        pose: For a camera of angles: ``(camera, …)`` makes the same of the class ``Camera``, which
            can be placed in any way.
        widest: For a camera: ``fov`` is below this angle, or at most this if it is a full turn.
        reflects: For a material: whether reflected rays may start from it.
        refracts: For a material: whether refracted rays may enter it.
        emits: For a material: whether it may emit light.
        sample: For a background that is also a light: ``(p, …) -> LightSample``.
        ambient: For a background that is also a light: ``(n, …) -> vec3``.
        radiance: For light from all sides: ``(direction, …) -> vec3``, the light of a direction,
            of which ``ambient`` is the mean that a surface receives.
    """

    name: str
    function: Func
    family: Family
    limits: Mapping[str, Limit]
    requires: Requirement | None = None
    extras: tuple[ExtraParameter, ...] = ()
    moves: Mapping[str, Move] = field(default_factory=dict)
    pose: Callable[..., Any] | None = None
    widest: float = math.pi
    reflects: bool = False
    refracts: bool = False
    emits: bool = False
    sample: Func | None = None
    ambient: Func | None = None
    radiance: Func | None = None


class Family:
    """The declarations of one kind of object, and their common rules.

    Attributes:
        site: The parameters that the scene passes, not the author.
        limits: The allowed range of a number, by its name.
        colors: Parameters that accept "#rrggbb" and names; ``color`` and ``…_color`` always do.
        keyword_only: Parameters that are passed by name only.
        optional: Parameters that may be None, which selects the default.
        varies: Whether arguments may be patterns.
        moves: How arguments change if their object is placed, by name.
        members: The declarations by name.
    """

    def __init__(
        self,
        site: Collection[str],
        limits: Mapping[str, Limit],
        *,
        colors: Collection[str] = (),
        keyword_only: Collection[str] = (),
        optional: Collection[str] = (),
        varies: bool = False,
        moves: Mapping[str, Move] | None = None,
    ) -> None:
        self.site: Final = frozenset(site)
        self.limits: Final = limits
        self.colors: Final = colors
        self.keyword_only: Final = keyword_only
        self.optional: Final = optional
        self.varies: Final = varies
        self.moves: Final = moves or {}
        self.members: Final[dict[str, Declaration]] = {}

    def declare(
        self, name: str, *, limits: Mapping[str, Limit] | None = None, **declared: Any
    ) -> Callable[[F], F]:
        """Return a decorator that declares a ``@func``; see ``Declaration``.

        Args:
            name: The public name.
            limits: Replaces the family's limits.
            declared: The other attributes of the ``Declaration``.
        """

        def keep(function: F) -> F:
            assert name not in self.members, f"two objects are called {name}"
            own = self.limits if limits is None else limits
            self.members[name] = Declaration(name, function, self, own, **declared)
            return function

        return keep


# The inputs of a function of a place on a surface: the point, the normal and the footprint of the
# pixel in the coordinates of the painted shape, the index of the repetition that contains the
# point, and the cosine of the angle between the normal and the direction to the eye.
PLACE_NAMES: Final = frozenset(("p", "n", "cell", "footprint", "facing"))

LIGHTS: Final = Family(
    ("p", "n"),
    {
        "intensity": Limit.NOT_NEGATIVE,
        "radius": Limit.NOT_NEGATIVE,
        "angle": Limit.NOT_NEGATIVE,
        "softness": Limit.FRACTION,
    },
    colors=("sky", "ground"),
    moves={
        "position": Move.POSITION,
        "target": Move.POSITION,
        "direction": Move.DIRECTION,
        "up": Move.DIRECTION,
        "radius": Move.LENGTH,
    },
)
BACKGROUNDS: Final = Family(
    ("direction", "p", "n"),
    {
        "intensity": Limit.NOT_NEGATIVE,
        "sun_intensity": Limit.NOT_NEGATIVE,
        "sun_angle": Limit.POSITIVE,
    },
    colors=("bottom", "top", "zenith", "horizon", "ground"),
    moves={"sun": Move.DIRECTION},
)
CAMERAS: Final = Family(
    ("uv", "resolution"),
    {
        "aperture": Limit.NOT_NEGATIVE,
        **dict.fromkeys(
            ("fov", "distance", "height", "screen_height", "screen_distance", "focus_distance"),
            Limit.POSITIVE,
        ),
    },
    keyword_only=("mirrored",),
    optional=("fov",),
    moves={
        "position": Move.POSITION,
        "target": Move.POSITION,
        "up": Move.DIRECTION,
        "height": Move.LENGTH,
        "aperture": Move.LENGTH,
        "focus_distance": Move.LENGTH,
        "mirrored": Move.SIDE,
    },
)
MATERIALS: Final = Family(
    PLACE_NAMES,
    {
        "color": Limit.FRACTION,
        "diffuse": Limit.FRACTION,
        "specular": Limit.FRACTION,
        "transmission": Limit.FRACTION,
        "ior": Limit.POSITIVE,
        "roughness": Limit.FRACTION,
        "metal": Limit.FRACTION,
        "fresnel": Limit.FRACTION,
        "dispersion": Limit.NOT_NEGATIVE,
        "amount": Limit.FRACTION,
        "absorption": Limit.NOT_NEGATIVE,
        "dark_color": Limit.FRACTION,
        "vein_color": Limit.FRACTION,
        "tone": Limit.FRACTION,
        "size": Limit.POSITIVE,
        "depth": Limit.POSITIVE,
        "meter": Limit.POSITIVE,
    },
    colors=("emission", "absorption"),
    varies=True,
)
PATTERNS: Final = Family(
    PLACE_NAMES,
    {
        "size": Limit.POSITIVE,
        "octaves": Limit.POSITIVE,
        "radius": Limit.POSITIVE,
        "power": Limit.POSITIVE,
    },
    colors=("a", "b"),
    varies=True,
)

light: Final = LIGHTS.declare
background: Final = BACKGROUNDS.declare
camera: Final = CAMERAS.declare
material: Final = MATERIALS.declare
pattern: Final = PATTERNS.declare
