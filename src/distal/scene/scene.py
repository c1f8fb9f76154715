"""The scene: shapes, lights and a camera, from which a picture is rendered.

Input: the author's objects. Output: a function from a pixel to linear light, which calls the
cameras, marchers and shaders of the library and the functions of the shapes; and a second function
that encodes light for display. The cheapest renderer that supports all materials is chosen.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, Final

from distal.at_once import cached_property
from distal.fields.guarantees import Limit
from distal.frontend import Assembly
from distal.ir.collection import paused_collection
from distal.ir.nodes import EntryKind
from distal.ir.types import FRAME, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.lang.option_methods import RenderedScene
from distal.lang.presentable import Presentable
from distal.lang.render_options import MODES, Cancel, Progress, RenderOptions
from distal.lang.runtime_access import meshing, scene_parts
from distal.lang.source_places import author_place
from distal.loading import copy_loaded_from
from distal.render import film, filters, tonemap, views
from distal.scene.looks.dressed import Dressed, GivenArguments
from distal.scene.looks.rows import NAMES as LOOKS
from distal.scene.looks.rows import as_look
from distal.scene.lowering.cells import check_cells
from distal.scene.lowering.layers import Layer, PathLayer
from distal.scene.lowering.photon_functions import casts_caustics
from distal.scene.lowering.picture import NORMALS, SceneLowering
from distal.scene.lowering.section import sectioned
from distal.scene.lowering.view import DisplayEncoding, View
from distal.scene.objects.field import BaseShape
from distal.scene.scene_arguments import (
    checked_exposure,
    checked_glow,
    checked_numbers,
    checked_shutter,
    checked_tone_map,
    one_of,
    whole,
)
from distal.scene.scene_values import SceneValue

if TYPE_CHECKING:
    from distal.diagnostics import Span
    from distal.images.picture import Picture
    from distal.mesh.scene_parts import SceneParts
    from distal.scene import rendering
    from distal.scene.groups import Solid
    from distal.scene.looks.look import Look
    from distal.scene.objects import shape_rows
    from distal.scene.objects.argument_types import Color, Number, ParameterValues, Varying
    from distal.scene.objects.backgrounds import Background, Surroundings
    from distal.scene.objects.cameras import BaseCamera
    from distal.scene.objects.lights import Light
    from distal.scene.objects.materials import Material
    from distal.scene.objects.shape import Shape
else:
    shape_rows = LazyModule("distal.scene.objects.shape_rows")
    rendering = LazyModule("distal.scene.rendering")  # needs NumPy


# The arguments of a scene that take one of a few words.
WORDS: Final[Mapping[str, tuple[str, ...]]] = {
    "look": LOOKS,
    "tone_map": tonemap.NAMES,
    "normals": NORMALS,
    "march": ("sphere", "heightfield"),
    "mode": MODES,
}

# Arguments that only the encoding for display reads.
_OF_DISPLAY: Final = frozenset({"exposure", "tone_map"})


# What a scene computes of its arguments when it is first asked, and what marks it as complete.
_COMPUTED: Final = ("_whole", "_kept_digest", "sectioned", "renderer")


class Scene(RenderedScene, SceneValue, Composed, Presentable):
    """Shapes, lights and a camera.

    What is not given comes from a look: lights, background, camera, floor, exposure, tone map,
    material and fog. Each argument replaces that part of the look alone.

    Args:
        shape: One solid shape, or several, which are united; a ``group`` with lights and a camera;
            another scene, for its shapes and its author's lights.
        lights: One light or several, besides those of groups. None uses the look's, if there are
            no others and the background is no light.
        camera: The camera. None: that of a group, else one that frames the finite parts.
        background: What rays that hit nothing show: a color, a ``Sky``, an ``Environment``, or a
            ``@func`` of the direction.
        look: "studio" (the default), "outdoor", "sunset", "night" or "blueprint"; or one of these
            with other numbers: ``outdoor(exposure=1.2)``.
        floor: Whether the scene stands on the look's floor. None: if it has no infinite part,
            no camera below the floor, and a look is named or neither lights nor background are
            given.
        exposure: A factor on all light, applied before the tone map.
        tone_map: How light beyond the display's range is shown: "none", "reinhard", "aces", "agx"
            or "neutral"; or a ``@func`` of linear light (vec3), after the exposure, that returns
            linear light from 0 to 1.
        default_material: The material of shapes without ``paint``.
        fog: The color of fog. None: that of the background at the horizon, in each direction.
        fog_density: Density of the fog per scene unit: after a distance of 1/density, 1/e of the
            light is left. 0 disables fog.
        glow: How much of a halo surrounds what is brighter than white, 0 to 1, in pictures and
            videos; windows that draw on a GPU, pages and texts of shaders show none.
        shadows: Whether lights cast shadows.
        ambient_occlusion: How far, in scene units, to search for surfaces that block ambient light;
            0 disables it. None: half the radius of the finite parts.
        mode: How light is computed: "direct", from each light to the first surface, with mirrors
            and glass; or "path", along random paths, which is exact and takes many samples.
        bounces: The maximum number of reflections and refractions that a ray follows; paths have no
            limit.
        shutter: In mode "path": seconds that the shutter is open, from the picture's time on; what
            moves is blurred.
        normals: How normals are computed: "exact", or by finite differences: "six_taps",
            "tetrahedron" or "forward".
        march: "sphere" for sphere tracing, or "heightfield" for terrain and water: long steps over
            the surface, then a search for the hit.
        stride: For the "heightfield" march: the shortest step at the start of a ray, for each unit
            of distance.
        stride_growth: For the "heightfield" march: the factor by which ``stride`` grows from step
            to step.
        steps: The maximum number of steps of a ray. None: 160, and more where the Lipschitz bound
            (slope) of a field is above 1.
        acceleration: Whether many parts (16 or more members of a union) are drawn through a tree of
            boxes, and 16 or more shapes that are joined in other ways as boxes with short programs.
            False evaluates every part at every step, which shows the same picture.
        near: The distance at which rays begin, in scene units.
        far: The distance at which rays end, in scene units. None: rays end beyond the last surface;
            in an infinite scene at 40 times the larger of the size of what is finite and of the
            camera's distance from its middle. Planes have no limit.
        name: The name in messages and emitted texts.

    Raises:
        CompileError: At the author's line, if an argument is invalid or arguments contradict each
            other.
    """

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(
        self,
        shape: Solid | Iterable[Solid],
        lights: Light | Iterable[Light] | None = None,
        camera: BaseCamera | None = None,
        background: Background | Surroundings | Color | Func | None = None,
        *,
        look: str | Look | None = None,
        floor: bool | None = None,
        exposure: Number | None = None,
        tone_map: str | Func | None = None,
        default_material: Material | Color | Varying | None = None,
        fog: Color | None = None,
        fog_density: Number | None = None,
        glow: float = 0.0,
        shadows: bool = True,
        ambient_occlusion: Number | None = None,
        mode: str = "direct",
        bounces: int = 6,
        shutter: float = 0.0,
        normals: str = "exact",
        march: str = "sphere",
        stride: Number = 0.03,
        stride_growth: Number = 1.05,
        steps: int | None = None,
        acceleration: bool = True,
        near: Number = 0.0,
        far: Number | None = None,
        name: str = "scene",
    ) -> None:
        # Set before by ``of_shape`` and ``_remade``.
        place = self.place = self.__dict__.get("place") or author_place()
        self.name = name
        numbers = {
            "exposure": exposure,
            "fog": fog,
            "fog_density": fog_density,
            "ambient_occlusion": ambient_occlusion,
            "near": near,
            "far": far,
        }
        given = GivenArguments(
            shape, lights, camera, background, default_material, tone_map, numbers
        )
        self.look = as_look(look, place)
        made = Dressed(given, self.look, place, self.__dict__.get("staged"))
        with paused_collection():  # it would traverse all parts
            standing = floor if floor is not None else made.wants_floor(named=look is not None)
            self.has_floor = standing
            self.shape = made.shown_shape(floor=standing)
            self.subject = made.shape  # without the look's floor
            check_cells(self.shape.node)
        self.lights, self.background, self.camera = made.lights, made.background, made.camera
        self.material = made.material
        self.tone_map = checked_tone_map(made.tone_map, place)
        self.normals = one_of("way to find normals", normals, WORDS["normals"], place)
        self.march = one_of("march", march, WORDS["march"], place)
        self.glow = checked_glow(glow, place)
        self.shadows = bool(shadows)
        self.mode = one_of("mode", mode, WORDS["mode"], place)
        self.bounces = whole("bounces", bounces, Limit.NOT_NEGATIVE, place)
        self.shutter = checked_shutter(shutter, place)
        self.acceleration = bool(acceleration)
        self.steps = None if steps is None else whole("steps", steps, Limit.POSITIVE, place)
        self.numbers = checked_numbers(
            place, **made.numbers, stride=stride, stride_growth=stride_growth
        )
        self.display = DisplayEncoding(self)
        # Recorded in pictures: the arguments of ``with_display`` and of ``of_shape``.
        self.asked_display: Mapping[str, Any] = {}
        self.staged: tuple[Mapping[str, Any], float] | None = self.__dict__.get("staged")
        self._pictures: dict[tuple[Any, ...], Composed] = {}
        self._given: dict[str, Any] = {
            "shape": made.contents.given,  # not ``shape``, which may be a generator
            "lights": None if lights is None else made.given_lights,
            "camera": camera,
            "background": background,
            "look": look,
            "floor": floor,
            **numbers,
            "tone_map": tone_map,
            "default_material": default_material,
            "glow": glow,
            "shadows": shadows,
            "mode": mode,
            "bounces": bounces,
            "shutter": shutter,
            "normals": normals,
            "march": march,
            "stride": stride,
            "stride_growth": stride_growth,
            "steps": steps,
            "acceleration": acceleration,
            "name": name,
        }
        self._whole = True

    @classmethod
    def of_shape(
        cls, shape: Shape, params: ParameterValues, time: float, look: str | None = None
    ) -> Scene:
        """Return ``Scene(shape)``, framed for other values of the shape's parameters.

        Args:
            shape: A solid.
            params: Values of parameters by name.
            time: Time in seconds.
            look: The name of a look; None for the default.
        """
        made = cls.__new__(cls)
        made.__dict__.update(staged=(params, time), place=shape.node.place)
        cls.__init__(made, shape, look=look, name=shape.name)
        made.__dict__["asked_display"] = {} if look is None else {"look": look}
        copy_loaded_from(shape, made)
        return made

    def with_display(
        self,
        *,
        look: str | None = None,
        exposure: float | None = None,
        tone_map: str | None = None,
    ) -> Scene:
        """Return the scene as a command shows it, which its pictures record; None keeps its own.

        Args:
            look: The name of a look.
            exposure: A factor of the light.
            tone_map: The name of a tone map.
        """
        given = {"look": look, "exposure": exposure, "tone_map": tone_map}
        asked = {name: value for name, value in given.items() if value is not None}
        if not asked:
            return self
        made = self._remade(asked, self.place)
        made.__dict__["asked_display"] = {**self.asked_display, **asked}
        return made

    def _remade(self, changes: Mapping[str, Any], place: Span | None) -> Scene:
        if changes.keys() <= _OF_DISPLAY and None not in changes.values():
            return self._developed(changes, place)
        made = Scene.__new__(Scene)
        made.__dict__.update(staged=self.staged, place=place)
        Scene.__init__(made, **{**self._given, **changes})
        made.__dict__["asked_display"] = self.asked_display
        copy_loaded_from(self, made)
        return made

    def _pickled(self) -> Any:
        computed = (*_COMPUTED, "display", "_pictures")
        state = {n: v for n, v in self.__dict__.items() if n not in computed}
        return _scene_of, (type(self), shape_rows.packed(state))

    # The kernel is compiled once: a later change would have no effect.

    def __setattr__(self, name: str, value: object) -> None:
        if "_whole" in self.__dict__:
            raise AttributeError("a scene does not change; make another: Scene(shape, …)")
        object.__setattr__(self, name, value)

    @cached_property
    def renderer(self) -> str:
        """The name of the cheapest renderer that supports all materials."""
        if self.bounces == 0:
            return "plain"
        given = (m for n in self.shape.node.walk() for m in (n.material, n.cut_material))
        found = [self.material, *(m for m in given if m is not None)]
        if any(m.refracts for m in found):
            return "refracted"
        return "mirrored" if any(m.reflects for m in found) else "plain"

    def _rendered(self, options: RenderOptions) -> Picture:
        """Render the picture.

        Raises:
            CompileError: The scene has mistakes, or its camera is inside a solid.
            DeviceError: The device is missing or was lost. With "auto" this is a warning instead.
            TypeError: A value has the wrong type.
            ValueError: A value is out of range, or the view, parameter or device does not exist.
        """
        return rendering.render_scene(self, options)

    def view(
        self,
        name: str,
        *,
        transparent: bool = False,
        sampled: bool = False,
        encoded: bool = False,
        steered: bool = False,
        adaptive: bool = False,
        paths: bool = False,
        filter: str = filters.NAMES[0],
        caustics: bool = False,
    ) -> Composed:
        """Return another view of the scene ("normal", "depth" …); the scene itself for "color".

        Args:
            name: The name of the view.
            transparent: Whether alpha is 0 where a ray hits nothing.
            sampled: Whether a pixel is the mean of ``Samples`` rays.
            encoded: Whether pixels are display values instead of linear light.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
            adaptive: Whether it is rendered in two passes: one sample in each pixel, then more
                where pixels differ from their neighbors; with ``paths`` in as many as are needed;
                for "color" as linear light.
            paths: Whether the light is that of random paths; for "color" as linear light.
            filter: The reconstruction filter of random paths.
            caustics: Whether photons find the caustics of these paths, if the scene has any.

        Raises:
            ValueError: There is no such view.
        """
        if name != "color" and name not in views.VIEWS:
            known = ", ".join(["color", *views.VIEWS])
            hint = "; locals are shown of an @image" if name.startswith("local:") else ""
            raise ValueError(f"there is no view '{name:.40}'; views: {known}{hint}")
        photons = paths and caustics and casts_caustics(self)
        key = (name, transparent, sampled, encoded, steered, adaptive, paths, filter, photons)
        if key == ("color", *[False] * 6, filter, False):
            return self
        if key not in self._pictures:
            self._pictures[key] = View(self, *key)
        return self._pictures[key]

    def program(
        self,
        view: str,
        samples: int | None,
        *,
        encoded: bool = False,
        mode: str | None = None,
        filter: str | None = None,
        caustics: bool = True,
        **shown: Any,
    ) -> tuple[Composed, Mapping[str, Any]]:
        """Return a view with several samples in each pixel, and its settings.

        Args:
            view: The name of the view.
            samples: Number of samples. None: adaptive for "color", one for other views.
            encoded: Whether pixels are display values instead of linear light; not if adaptive, or
                in mode "path".
            mode: "direct" or "path"; None: as the scene says.
            filter: The reconstruction filter in mode "path"; None for the default.
            caustics: In mode "path": whether photons find caustics.
            shown: ``transparent`` and ``steered`` of ``view``.

        Raises:
            ValueError: There is no such view.
        """
        if view == "color" and (mode or self.mode) == "path":
            asked: dict[str, Any] = {"filter": filter or filters.NAMES[0], "caustics": caustics}
            return self.view(view, paths=True, adaptive=True, **asked, **shown), {}
        if samples is None and view == "color":
            return self.view(view, adaptive=True, **shown), {}
        if samples is None or samples == 1:
            return self.view(view, encoded=encoded, **shown), {}
        made = self.view(view, sampled=True, encoded=encoded, **shown)
        return made, {film.SAMPLES: samples}

    def layer(self, name: str, *, steered: bool = False) -> Composed:
        """Return an image of one layer's values at the middle of each pixel (``render.layers``).

        Args:
            name: "depth", "normal", "albedo" or "material".
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        key = ("layer", name, steered)
        if key not in self._pictures:
            self._pictures[key] = Layer(self, name, steered=steered)
        return self._pictures[key]

    def path_layer(
        self, name: str, filter: str | None = None, *, steered: bool = False
    ) -> Composed:
        """Return an image of the mean of a layer over random paths (``render.path_layers``).

        Args:
            name: "normal" or "albedo".
            filter: The reconstruction filter; None for the default.
            steered: Whether the camera is moved by the numbers of a ``Steering``.
        """
        chosen = filter or filters.NAMES[0]
        key = ("path layer", name, chosen, steered)
        if key not in self._pictures:
            self._pictures[key] = PathLayer(self, name, chosen, steered=steered)
        return self._pictures[key]

    def save(
        self,
        path: str | PathLike[str],
        tolerance: float | None = None,
        feature: float | None = None,
        params: ParameterValues | None = None,
        time: float = 0.0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        *,
        unit: str = "mm",
        bed: bool = False,
        angle: float | None = None,
    ) -> SceneParts:
        """Save the scene's parts as meshes in one file, with their names, colors and materials.

        Each shape with a name (``.named()``) in a union is a part; what has none is one more. What
        has no end is left out. The result has the ``meshes``, and what is ``endless``.

        Args:
            path: The file: ``.glb`` (with materials), ``.3mf``, ``.obj``, ``.ply`` or ``.stl``.
            tolerance: How far a mesh may be from its surface, in scene units. None: 0.002 of the
                largest side of each part.
            feature: The diameter of the smallest parts and gaps that must be found.
            params: Values of parameters by name; the others have their defaults.
            time: Time in seconds.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.
            unit: The length of one scene unit: "um", "mm", "cm", "m", "inch" or "ft".
            bed: Move all parts together, so that they stand on 0 and are centered there.
            angle: How much a surface may turn within a triangle, in radians, as for ``mesh``.

        Raises:
            CompileError: No part has an end, or a part cannot be meshed.
            SaveError: The suffix or the unit is unknown, or the file cannot be written.
        """
        request = meshing.MeshRequest(
            tolerance=tolerance,
            feature=feature,
            params=params or {},
            time=time,
            progress=progress,
            cancel=cancel,
            angle=angle,
        )
        return scene_parts.saved(self, path, request, unit=unit, bed=bed)

    def _developed(self, changes: Mapping[str, Any], place: Span | None) -> Scene:
        """Return the scene with another exposure or tone map, without dressing it again."""
        made = self._copied()
        if "exposure" in changes:
            exposure = checked_exposure(changes["exposure"], place)
            made.numbers = {**self.numbers, "exposure": exposure}
        if "tone_map" in changes:
            made.tone_map = checked_tone_map(changes["tone_map"], place)
        made._given = {**self._given, **changes}
        made._whole = True
        return made

    @cached_property
    def sectioned(self) -> Scene:
        """The same scene, with solids that end at the plane of a ``CutPlane``.

        Its programs read the uniforms of ``CutPlane.settings``; camera and light are those of the
        whole scene.
        """
        made = self._copied()
        made.shape = BaseShape._of(sectioned(self.shape.node))
        made._whole = True
        return made

    def _copied(self) -> Scene:
        """Return a copy that can be changed, without what was computed of this scene."""
        made = Scene.__new__(Scene)
        made.__dict__.update({n: v for n, v in self.__dict__.items() if n not in _COMPUTED})
        made.display = DisplayEncoding(made)
        made._pictures = {}
        copy_loaded_from(self, made)
        return made

    def emitted(self) -> Composed:
        """Return the object that text targets compile: the scene, encoded for display."""
        return self.view("color", encoded=True)

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to linear light, and return its name."""
        made = SceneLowering(assembly, self)
        return made.main("color", transparent=False, sampled=False, encoded=False)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        yield from self.shape.functions()
        parts: list[Any] = [*self.lights, self.camera, self.background, self.material]
        for part in parts:
            yield from part.functions()
        if isinstance(self.tone_map, Func):
            yield self.tone_map


def _scene_of(kind: type[Scene], packed: shape_rows.PackedShapes) -> Scene:
    """Return a scene from a pickle."""
    made = kind.__new__(kind)
    made.__dict__.update(shape_rows.unpacked(packed))
    made.__dict__.update(display=DisplayEncoding(made), _pictures={}, _whole=True)
    return made
