"""Construction of a scene's function from a pixel to its light.

Input: a scene. Output: functions in a program: distance, surface, lights, background, rays, and one
that connects them by a renderer of the library. Values are bound by parameter name.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, Final, cast

from distal.fields.guarantees import UNBOUNDED
from distal.frontend import Assembly
from distal.ir.build import boolean, compare, field, integer, number
from distal.ir.nodes import (
    Call,
    CompareOp,
    Expr,
    FunctionRef,
    If,
    Param,
    Read,
    Return,
)
from distal.ir.types import BOOL, FLOAT, FRAME, INT, IVEC4, VEC2, VEC3, VEC4, Type
from distal.lang.functions import Func
from distal.render import (
    bounce,
    film,
    filters,
    footprint,
    layers,
    legend,
    lettering,
    live_film,
    path_film,
    path_layers,
    paths,
    ranges,
    settings,
    sheets,
    tonemap,
    views,
)
from distal.render.camera import Ray
from distal.render.footprint import Cone, Footprint
from distal.render.sampling.points import Stream
from distal.scene.lowering.attributes import (
    Attribute,
    AttributePoint,
    MaterialNumber,
    SurfaceAttribute,
    attribute,
    of_part,
)
from distal.scene.lowering.bodies import BodyFunctions, bodies_of, is_clear, largest_of, members_of
from distal.scene.lowering.bumps import has_bump, tilted
from distal.scene.lowering.camera_functions import CameraFunctions
from distal.scene.lowering.glass_shadows import colored_shadow, split_glass
from distal.scene.lowering.light_functions import LightFunctions
from distal.scene.lowering.parts.table import (
    bricked_for,
    has_table,
    pieced_for,
    rolled_for,
    split_table,
)
from distal.scene.lowering.photon_functions import PhotonFunctions
from distal.scene.lowering.ray_functions import RayFunctions, function_in, step_limit
from distal.scene.lowering.scattering import number_bsdfs, scattering_functions
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.union_parts import united
from distal.scene.tree.node import Node
from distal.scene.tree.own_functions import TONE_MAP
from distal.scene.tree.values import StatementList
from distal.scene.tree.varying import expression_of

if TYPE_CHECKING:
    from distal.scene.scene import Scene

# Methods to compute normals, in the order of ``render.normals``.
NORMALS: Final = ("exact", "six_taps", "tetrahedron", "forward")

FALSE: Final = boolean(False)

RENDERERS: Final[dict[str, Func]] = {
    "plain": bounce.seen_plain,
    "mirrored": bounce.seen_mirrored,
    "refracted": bounce.seen_refracted,
}
PATHS: Final[Func] = paths.path_light
# The type checker infers only ``object`` for tables of different functions.
LAYERS: Final = cast(Mapping[str, Func], layers.LAYERS)
PATH_LAYERS: Final = cast(Mapping[str, Func], path_layers.PATH_LAYERS)
LEGENDS: Final = cast(Mapping[str, Func], legend.LEGENDS)
VIEWS: Final = cast(Mapping[str, Func], views.VIEWS)
# The views whose values have a range, and the numbers of the range (``render.ranges``).
RANGED: Final = ("depth", "signal")
RANGE: Final = ("low", "middle", "high")


class SceneLowering:
    """The lowering of one scene to functions of one program.

    Attributes:
        node: The scene's tree, with a table if it has many parts.
        camera: The functions of its camera.
    """

    def __init__(self, assembly: Assembly, scene: Scene, *, paths: bool = False) -> None:
        """Begin.

        Args:
            assembly: The program.
            scene: The scene.
            paths: Whether rays are followed from surface to surface in any scene.
        """
        self._assembly = assembly
        self._scene = scene
        self._function = partial(function_in, assembly)
        rolls = scene.acceleration and not self._hybrid
        node = scene.shape.node
        bodies, common = [node], 0
        is_glassy = paths or scene.renderer == "refracted"
        if is_glassy:
            apart = paths and not (rolls and has_table(assembly, node))
            bodies = bodies_of(node, scene.material, apart=apart)
            common = largest_of(bodies)
        if rolls:
            # Rays within glass ask for the value at any place; pieces have the surface alone.
            varies = bool(scene.material.uses)
            if not (is_glassy and is_clear(bodies[common], scene.material)):
                bodies[common] = pieced_for(assembly, bodies[common], default_varies=varies)
            bodies = [bricked_for(assembly, body, default_varies=varies) for body in bodies]
            bodies[common] = rolled_for(assembly, bodies[common])
        # A table is the first member of the union.
        members = [*members_of(bodies[common]), *bodies[:common], *bodies[common + 1 :]]
        self.node = united(node, members) if len(bodies) > 1 else bodies[0]
        self._rolls = rolls
        self.composer = ShapeComposer(assembly, [self.node])
        closed = paths and not self._hybrid
        self._rays = RayFunctions(self.composer, self.node, self._function, closed=closed)
        self._bodies = BodyFunctions(self.composer, bodies, common, self._function, closed=closed)
        self._view_numbers: dict[str, Expr] = {}
        self._has_photons = False
        self._numbers = {
            name: expression_of(assembly, value, name) for name, value in scene.numbers.items()
        }
        self.camera = CameraFunctions(self.composer, scene, self.node, self._function)
        self._lights = LightFunctions(self.composer, scene, self._numbers, self._function)
        if paths:
            nodes = scene.shape.node.walk()
            painted = (m for node in nodes for m in (node.material, node.cut_material))
            number_bsdfs(self.composer, [scene.material, *painted])

    def main(
        self,
        view: str,
        *,
        transparent: bool,
        sampled: bool,
        encoded: bool,
        steered: bool = False,
        adaptive: bool = False,
        paths: bool = False,
        filter: str = filters.NAMES[0],
        kept: bool = False,
        photons: bool = False,
    ) -> str:
        """Add the function that maps the frame to a pixel, and return its name.

        Args:
            view: The view of the scene.
            transparent: Whether alpha is 0 where a ray hits nothing.
            sampled: Whether a pixel is the mean of ``Samples`` rays.
            encoded: Whether pixels are display values instead of linear light.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
            adaptive: Whether it is rendered in several passes, of all pixels or of a list.
            paths: Whether the light is that of random paths.
            filter: The reconstruction filter of random paths.
            kept: Whether a pixel is that of a film, to which a pass by paths is added.
            photons: Whether these paths leave caustics to photons.
        """
        self._has_photons = photons
        frame = Read("frame", FRAME)
        body = StatementList(taken={"frame"})
        resolution = field(frame, "resolution")
        samples: Expr = integer(1)
        if sampled or adaptive or paths:
            samples = self._assembly.number(film.SAMPLES, INT, 1)
        again: dict[str, Expr] = {}
        if adaptive:
            again = self._second_pass(resolution)
            resolution = again["resolution"]
        given: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "resolution": resolution,
            "camera": self.camera.ray(resolution, steered=steered),
            "cone": self._cone(resolution, view, steered=steered),
            "transparent": boolean(transparent),
            "samples": samples,
            "step": integer(1),
            **again,
        }
        # Pictures of linear light carry marks, which the executor counts and removes.
        given["counted"] = boolean(view == "color" and not encoded and not kept)
        shown = PATHS if paths else self._shown(view)
        given["radiance"] = self._radiance(
            shown, resolution, view, steered=steered, counted=given["counted"]
        )
        if sampled or adaptive:
            given["step"] = self.composer.call(film.lattice_step, {"count": samples})
        exposed: Func = film.exposed_again if adaptive else film.exposed
        if paths:
            exposed = path_film.exposed_paths_again if adaptive else path_film.exposed_paths
            given |= self._exposure(frame, resolution, filter, steered=steered)
            if adaptive:
                given["largest"] = self._assembly.number(path_film.LARGEST, FLOAT, UNBOUNDED)
        color = body.let("color", self.composer.call(exposed, given))
        if kept:
            before = body.let("before", self._film_texel(given["coord"]))
            given |= {"before": before, "light": color}
            color = self.composer.call(live_film.film_after, given)
        if view in LEGENDS:
            title = self._assembly.constant(lettering.word(legend.TITLES[view]), IVEC4)
            asked = {**self.given(body, resolution, steered=steered), **given}
            asked |= {"color": color, "title": title}
            asked |= self._shown_numbers(view, body, asked)
            color = body.let("color", self.composer.call(LEGENDS[view], asked))
        if encoded:
            color = self.displayed(color)
        body.statements.append(Return(color))
        params = (Param("frame", FRAME),)
        return self._assembly.define("picture", params, VEC4, body.statements, self._scene.place)

    def _second_pass(self, grid: Expr) -> dict[str, Expr]:
        """Return what ``film.exposed_again`` takes besides the values of ``film.exposed``."""
        assembly, size = self._assembly, (640.0, 480.0)
        # Stubs describe a buffer by the type of its elements; here it is a resource.
        places, firsts = cast(Any, film.PLACES), cast(Any, film.FIRSTS)
        return {
            "grid": grid,
            "resolution": assembly.number(film.PICTURE_SIZE, VEC2, size),
            "again": assembly.number(film.AGAIN, BOOL, False),
            "places": assembly.resource(places, "Places"),
            "firsts": assembly.resource(firsts, "Firsts"),
        }

    def _exposure(
        self, frame: Expr, resolution: Expr, filter: str, *, steered: bool
    ) -> dict[str, Expr]:
        """Return what ``path_film.exposed_paths`` takes besides the values of ``film.exposed``.

        Args:
            frame: The frame.
            resolution: Size of the picture in pixels.
            filter: The name of the reconstruction filter.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        return {
            "camera": self.camera.exposed(resolution, steered=steered),
            "first_sample": self._assembly.number(film.FIRST_SAMPLE, INT, 0),
            "filter": integer(filters.NAMES.index(filter)),
            **{name: field(frame, name) for name in ("seed", "index")},
        }

    def path_layer(self, name: str, filter: str, *, steered: bool) -> str:
        """Add the function that maps the frame to the mean of a layer, and return its name.

        Args:
            name: A name of ``path_layers.PATH_LAYERS``.
            filter: The name of the reconstruction filter.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        frame = Read("frame", FRAME)
        resolution = field(frame, "resolution")
        given: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "resolution": resolution,
            "cone": self._cone(resolution, "color", steered=steered),
            "transparent": boolean(True),
            "samples": self._assembly.number(film.SAMPLES, INT, 1),
            "radiance": self._radiance(PATH_LAYERS[name], resolution, name, steered=steered),
            **self._exposure(frame, resolution, filter, steered=steered),
        }
        value = self.composer.call(path_film.exposed_paths, given)
        params = (Param("frame", FRAME),)
        return self._assembly.define("layer", params, VEC4, (Return(value),), self._scene.place)

    def layer(self, name: str, *, steered: bool) -> str:
        """Add the function that maps the frame to a layer's values, and return its name.

        The values are those at the middle of each pixel.
        """
        frame = Read("frame", FRAME)
        resolution = field(frame, "resolution")
        given: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "resolution": resolution,
            "camera": self.camera.ray(resolution, steered=steered),
            "radiance": self._radiance(LAYERS[name], resolution, name, steered=steered),
        }
        value = self.composer.call(layers.through_middle, given)
        params = (Param("frame", FRAME),)
        return self._assembly.define("layer", params, VEC4, (Return(value),), self._scene.place)

    def film(self) -> str:
        """Add the function that maps the frame to a pixel of a film, and return its name."""
        frame = Read("frame", FRAME)
        mean = self._film_texel(field(frame, "coord"))
        shown = self.displayed(self.composer.call(live_film.film_light, {"mean": mean}))
        params = (Param("frame", FRAME),)
        return self._assembly.define("film", params, VEC4, (Return(shown),), self._scene.place)

    def _film_texel(self, coord: Expr) -> Expr:
        """Return the texel of a pixel on the host's film."""
        offset = self._assembly.number(live_film.FILM_OFFSET, VEC2, (0.0, 0.0))
        # Stubs describe what authors declare; here it is a resource.
        film = self._assembly.resource(cast(Any, live_film.FILM), "Film")
        return self.composer.call(
            live_film.film_texel, {"film": film, "coord": coord, "offset": offset}
        )

    def displayed(self, color: Expr) -> Expr:
        """Return linear light encoded for display."""
        given = {"color": color, "exposure": self._numbers["exposure"]}
        chosen = self._scene.tone_map
        if isinstance(chosen, Func):
            given["curve"] = self._assembly.reference(chosen, TONE_MAP.type)
            return self.composer.call(tonemap.display_by, given)
        given["tone_map"] = integer(tonemap.NAMES.index(chosen))
        return self.composer.call(tonemap.display, given)

    def given(
        self,
        body: StatementList,
        resolution: Expr,
        *,
        steered: bool = False,
        paths: bool = False,
    ) -> dict[str, Expr]:
        """Return all values that a renderer may take, by name.

        Args:
            body: The statements to add to.
            resolution: Size of the picture in pixels.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
            paths: Whether rays are followed from surface to surface.
        """
        composer, scene, node = self.composer, self._scene, self.node
        values = composer.values.all(node)
        bounds_of_scene = composer.bounds.of(body, node, values)
        # The hybrid march searches the crossing of the author's field itself.
        own = self._hybrid or composer.parts.has_safe_values(node)
        given: dict[str, Expr] = {
            **self._numbers,
            "resolution": resolution,
            "divisor": bounds_of_scene.divisor if own else number(1.0),
            "steepest": number(1.0) if own else bounds_of_scene.divisor,
            "steep": boolean(not composer.parts.has_safe_values(node)),
            "slope": bounds_of_scene.slope,
            "field": composer.field(node, values, ZERO_CELL),
            "surface": self.surface(),
            "lights": self._lights.lights(),
            "ambient": self._lights.ambient("n"),
            "background": self._lights.background(),
            "fog": self._lights.fog(),
            "camera": self.camera.ray(resolution, steered=steered),
            "bounces": integer(scene.bounces),
            "hybrid": boolean(self._hybrid),
            "normals": integer(NORMALS.index(scene.normals)),
            "light_count": integer(self._lights.count),
        }
        given["steps"] = self._steps(body)
        box = {"bounds": bounds_of_scene.bounds}
        given["bounds"] = body.let("bounds", composer.call(settings.grown_bounds, box))
        given["farthest_plane"] = self._numbers.get("far", number(UNBOUNDED))
        if "far" not in self._numbers:
            given["far"] = body.let("far", composer.call(settings.automatic_far, given))
        given["threshold"] = body.let("threshold", composer.call(settings.hit_threshold, given))
        eye = body.let("eye", composer.call(sheets.eye_of, given))
        composer.sheets.seen = {"eye": eye, "threshold": given["threshold"]}
        given["bounds"] = body.let("bounds", composer.sheets.grown(node, given["bounds"]))
        given["numbers"] = body.let("numbers", composer.call(settings.march_numbers, given))
        given["stride"] = body.let("stride", composer.call(settings.stride_over, given))
        given["look"] = body.let("look", composer.call(settings.look, given))
        rays = self._rays
        # Paths know surfaces to a rounding error, from the first on.
        exact = {**given, "threshold": number(0.0)}
        exact["numbers"] = composer.call(settings.march_numbers, exact)
        first = exact if paths else given
        given["first_hit"] = rays.first_hit(body, first, hybrid=self._hybrid)
        given["shadow"] = self._shadow(body, given)
        if scene.renderer == "refracted" or paths:
            on_surface = {**exact, "near": number(0.0)}
            on_surface["numbers"] = composer.call(settings.march_numbers, on_surface)
            given["next_hit"] = self._bodies.next_hit(body, on_surface)
            given["first_within"] = self._bodies.first_within()
            given |= self._bodies.constants
        if paths:
            given |= {"around": self._lights.ambient("direction"), **self._lights.directions()}
            given |= self._lights.lamps(scene.shape.node)
            given |= scattering_functions(composer, self._function)
        return given

    def given_of_layers(
        self, body: StatementList, resolution: Expr, *, steered: bool
    ) -> dict[str, Expr]:
        """Return the values of ``given`` for programs that read the field at surfaces.

        Args:
            body: The statements to add to.
            resolution: Size of the picture in pixels.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        given = self.given(body, resolution, steered=steered)
        if self._shown_node is not self.node:
            given["field"] = self._shown_field()
        return given

    @property
    def _shown_node(self) -> Node:
        """The tree whose values views and layers show, also far away; made when it is needed."""
        if not self._rolls:
            return self.node
        return rolled_for(self._assembly, self._scene.shape.node, exact=True)

    def _shown_field(self) -> FunctionRef:
        """Return the author's field, which views and layers show."""
        values = self.composer.values.all(self._shown_node)
        return self.composer.field(self._shown_node, values, ZERO_CELL)

    def _occlusion(self, body: StatementList, given: Mapping[str, Expr]) -> FunctionRef:
        """The share of ambient light that reaches a point; 1 where the scene has none."""
        if any(light.ambient is not None for light in self._scene.lights):
            reach = self._scene.numbers["ambient_occlusion"].plain
            reach = reach if isinstance(reach, float) else None
            return self._rays.occlusion(body, given, reach=reach, hybrid=self._hybrid)
        place = (("p", VEC3), ("n", VEC3), ("slope", FLOAT))
        return self._function("unoccluded", place, lambda body, given: number(1.0))

    def _shadow(self, body: StatementList, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function ``(origin, light, sample, samples) -> Opening``."""
        scene, composer = self._scene, self.composer
        given = {**given, "some_sharp": boolean(self._lights.some_sharp)}
        clear: list[Node] = []
        if scene.renderer == "refracted" and scene.shadows:
            clear, others = split_glass(self.node, scene.material)
        if not clear:
            return self._rays.shadow(body, given, casts=scene.shadows, hybrid=self._hybrid)
        casts = bool(others)
        rest = united(self.node, others) if others else self.node
        rays = RayFunctions(composer, rest, self._function)
        own = composer.bounds.of(body, rest, composer.values.all(rest)).bounds
        box = body.let("bounds", composer.call(settings.grown_bounds, {"bounds": own}))
        opaque = rays.shadow(body, {**given, "bounds": box}, casts=casts, hybrid=False)
        return colored_shadow(composer, clear, self._surface_of_hit, self._function, opaque)

    @property
    def _hybrid(self) -> bool:
        """Whether the march for terrain and water is used; it does not follow rays inside glass."""
        return self._scene.march == "heightfield" and self._scene.renderer != "refracted"

    def _steps(self, body: StatementList) -> Expr:
        """Return the maximum number of steps of a ray."""
        if self._scene.steps is not None:
            return integer(self._scene.steps)
        values = self.composer.values.all(self.node)
        divisor = self.composer.bounds.of(body, self.node, values).divisor
        return body.let("steps", step_limit(divisor, in_glass=self._scene.renderer == "refracted"))

    def _shown(self, view: str) -> Func:
        """Return the library function that computes a view along a ray."""
        return RENDERERS[self._scene.renderer] if view == "color" else VIEWS[view]

    def _radiance(
        self,
        shown: Func,
        resolution: Expr,
        view: str,
        *,
        steered: bool,
        counted: Expr = FALSE,
    ) -> FunctionRef:
        """Return the function of a ray to its light, or to its value in a view or layer.

        Args:
            shown: The renderer, view or layer.
            resolution: Size of the picture in pixels.
            view: The name of the view.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
            counted: Whether alpha is marked with why rays were lost; a constant.
        """

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            known = self.given(body, given["resolution"], steered=steered, paths=follows)
            asked = {**known, **given}
            asked["counted"] = counted
            if follows:
                photons = PhotonFunctions(self.composer, self._function)
                asked |= photons.given(has_photons=self._has_photons)
            if shines and not follows:  # nothing else computes what occlusion reads
                asked["occlusion"] = self._occlusion(body, asked)
            if shines:
                asked |= self.given_at_hits()
            if shines and self._bodies.are_many:
                asked["first_hit"] = self._bodies.first_hit(body, asked)
            if shines and not self._hybrid:
                values = self.composer.values.all(self.node)
                asked["field"] = self.composer.safe_field(self.node, values, ZERO_CELL)
            elif self._shown_node is not self.node:
                asked["field"] = self._shown_field()
            if shown is VIEWS.get(view):
                asked |= self._shown_numbers(view, body, asked)
            if shown is layers.layer_material:
                kind = MaterialNumber(self.composer, self._scene.material)
                asked["identity"] = self._material_number(kind)
            if of_paths:
                asked["seen"] = self.composer.call(path_layers.first_scattering, asked)
            return self.composer.call(shown, asked)

        of_paths = shown in PATH_LAYERS.values()
        follows = shown is PATHS or of_paths
        shines = follows or shown in RENDERERS.values()
        struct = self._assembly.struct
        params: list[tuple[str, Type]] = [("ray", struct(Ray)), ("cone", struct(Cone))]
        if follows:
            params.append(("stream", struct(Stream)))
        params.append(("resolution", VEC2))
        return self._function("radiance", params, make, (resolution,))

    def _shown_numbers(
        self, view: str, body: StatementList, given: Mapping[str, Expr]
    ) -> dict[str, Expr]:
        """Return the numbers that only one view reads: a range of values, a plane and its lines.

        Args:
            view: The view.
            body: Takes the statements.
            given: The values of ``given``.
        """
        number_of = self._view_number
        if view in RANGED:
            asked = {f"view_{n}": number_of(f"View_{n}", FLOAT, 0.0) for n in RANGE}
            shown = self.composer.call(ranges.range_of_scene, {**given, **asked})
            return {"shown": body.let("shown", shown)}
        if view == "slice":
            plane = {
                "slice_normal": number_of("Slice_normal", VEC3, (0.0, 0.0, 1.0)),
                "slice_offset": number_of("Slice_offset", FLOAT, 0.0),
            }
        elif view == "distance":
            normal = body.let("slice_normal", self.composer.call(views.facing_plane, given))
            plane = {"slice_normal": normal, "slice_offset": number(0.0)}
        else:
            return {}
        lines = self.composer.call(views.lines_on, {**given, **plane})
        return {**plane, "lines": body.let("lines", lines)}

    def _view_number(self, name: str, type: Type, value: Any) -> Expr:
        """Return a number of a view; its picture and its legend read the same uniform."""
        if name not in self._view_numbers:
            self._view_numbers[name] = self._assembly.number(name, type, value)
        return self._view_numbers[name]

    def _cone(self, resolution: Expr, view: str, *, steered: bool) -> FunctionRef:
        """Return the function ``(uv, size) -> Cone``: thin if no pattern is averaged."""
        kind = SurfaceAttribute(self.composer, self._scene.material)
        is_averaged = view == "color" and kind.averages(self.node)

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if not is_averaged:
                return self.composer.call(footprint.thin, given)
            camera = self.camera.ray(given["resolution"], steered=steered)
            asked = {**given, "camera": camera}
            return self.composer.call(footprint.pixel_cone, asked)

        params = (("uv", VEC2), ("size", FLOAT), ("resolution", VEC2))
        return self._function("cone", params, make, (resolution,))

    def surface(self) -> FunctionRef:
        """Return the function of the material at a place, ``(p) -> Surface``."""
        kind = SurfaceAttribute(self.composer, self._scene.material)
        return self.known_of_place("surface", kind)

    def known_of_place(self, name: str, kind: Attribute) -> FunctionRef:
        """Return an attribute of the place nearest to a point, as a function.

        Args:
            name: The preferred name of the function.
            kind: The attribute.
        """

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return attribute(body, kind, self.node, self._site(self.node, given))

        return self._function(name, (("p", VEC3),), make)

    def _site(self, node: Node, given: Mapping[str, Expr]) -> AttributePoint:
        values = self.composer.values.all(node)
        return AttributePoint(given["p"], ZERO_CELL, values, given.get("footprint"))

    def given_at_hits(self) -> dict[str, Expr]:
        """Return the functions of what a ray has hit, by name of ``vertices.vertex_at``."""
        if self._bodies.are_many:
            surface = self._bodies.surface(self._surface_of_hit)
            return {"surface": surface, "field_of": self._bodies.field_of()}
        field = self._rays.field_of(hybrid=self._hybrid)
        return {"surface": self._surface_of_hit(self.node), "field_of": field}

    def _surface_of_hit(self, node: Node) -> FunctionRef:
        """Return the function ``(p, footprint, part) -> Surface`` of a tree."""
        kind = SurfaceAttribute(self.composer, self._scene.material)
        parts, beside = split_table(node)

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if parts is None:
                return attribute(body, kind, node, self._site(node, given))
            of = of_part(kind, parts, self._site(parts, given), given["part"])
            if beside is None:
                return of
            is_part = compare(CompareOp.GE, given["part"], integer(0))
            body.statements.append(If(is_part, (Return(of),), ()))
            return attribute(body, kind, beside, self._site(beside, given))

        footprint = self._assembly.struct(Footprint)
        params = (("p", VEC3), ("footprint", footprint), ("part", INT))
        found = self._function("surface_of_hit", params, make)
        if not has_bump(node, self._scene.material):
            return found
        return tilted(self._assembly, self._function, found, params)

    def _material_number(self, kind: MaterialNumber) -> FunctionRef:
        """Return the function ``(p) -> float``: the number of the material at a place."""
        listed = self.known_of_place("material_place", kind)

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return kind.found(Call(listed.name, (given["p"],), FLOAT))

        return self._function("material_number", (("p", VEC3),), make)
