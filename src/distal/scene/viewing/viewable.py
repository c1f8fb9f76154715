"""One interface to scenes, shapes and images, for windows, pages, notebooks and videos.

Input: any object that is a picture. Output: its programs by view, with a movable camera if it has
one, and its parameters. Does not depend on windows or pages.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.at_once import cached_property
from distal.diagnostics import LoadError
from distal.frontend import Assembly, lower
from distal.ir.nodes import Module
from distal.ir.types import FLOAT
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.parameters import Parameter
from distal.lang.render_options import MODES, RenderOptions
from distal.lang.runtime_access import executor
from distal.loading import copy_loaded_from
from distal.render.views import VIEWS
from distal.scene.groups import Group
from distal.scene.lowering.live_film import FilmPass, ShownFilm
from distal.scene.lowering.local_views import PREFIX, locals_of, view_of_image
from distal.scene.lowering.local_views import VIEWS as IMAGE_VIEWS
from distal.scene.lowering.picture import SceneLowering
from distal.scene.lowering.section import is_sectionable
from distal.scene.objects.field import BaseShape
from distal.scene.scene import Scene
from distal.scene.section import CutPlane
from distal.scene.steering import STILL, Steering
from distal.scene.view_options import refinement_of, steering_settings
from distal.scene.view_ranges import with_range
from distal.scene.viewing.guide import Guide
from distal.scene.viewing.ruler import Ruler
from distal.scene.viewing.stage import stage

if TYPE_CHECKING:
    from distal.images.picture import Picture

COLOR: Final = "color"


class Viewable:
    """A picture that can be shown in several views.

    Attributes:
        name: The author's name for it.
        scene: The scene; the default scene of a single shape; None for an ``@image``.
        views: The names of the views; "color" is the first.
        mode: How the light of the view "color" is computed: "direct" or "path".
        caustics: Whether photons find the caustics of paths.
    """

    def __init__(self, name: str, source: Scene | Image) -> None:
        self.name = name
        self._source = source
        self.scene = source if isinstance(source, Scene) else None
        self.mode = "direct" if self.scene is None else self.scene.mode
        self.caustics = True
        self._images: dict[str, Image | Composed] = {}

    def in_mode(self, mode: str | None, *, caustics: bool | None = None) -> Viewable:
        """Return the same object whose light is computed in another way.

        Args:
            mode: "direct" or "path"; None: as the scene says.
            caustics: Whether photons find the caustics of paths; None keeps it.

        Raises:
            ValueError: There is no such mode.
            LoadError: It is an ``@image``, which has no light.
        """
        if mode is not None and mode not in MODES:
            raise ValueError(f"there is no mode '{mode!s:.40}'; modes: {', '.join(MODES)}")
        mode = self.mode if mode is None else mode
        caustics = self.caustics if caustics is None else caustics
        if (mode, caustics) == (self.mode, self.caustics):
            return self
        if self.scene is None and mode != self.mode:
            raise LoadError(f"modes are for scenes and shapes; '{self.name}' is an @image")
        made = copy.copy(self)
        made.mode, made.caustics = mode, caustics
        made.__dict__.pop("film", None)  # it depends on both
        return made

    @cached_property
    def views(self) -> tuple[str, ...]:
        """The names of the views, of an ``@image`` also of its locals that differ among pixels."""
        if self.scene is not None:
            return (COLOR, *VIEWS)
        assert isinstance(self._source, Image)
        if self._source.shown is not self._source:  # a buffer, which is drawn once in a frame
            return (COLOR,)
        known = locals_of(self._source, module=self.lowered)
        varying = (f"{PREFIX}{x.name}" for x in known if x.varies)
        return (COLOR, *IMAGE_VIEWS, *varying)

    @cached_property
    def lowered(self) -> Module:
        """The IR of an ``@image``.

        Raises:
            CompileError: The image has mistakes.
        """
        assert isinstance(self._source, Image)
        return lower(self._source.shown)

    @cached_property
    def parameters(self) -> list[Parameter]:
        """Return the parameters, in the order of first use."""
        return self._source.parameters()

    @property
    def steers(self) -> bool:
        """Whether the camera can be moved; if not, drags set the frame's mouse."""
        return self.scene is not None

    @cached_property
    def elevation(self) -> float:
        """The camera's initial elevation above its target, in radians."""
        if self.scene is None:
            return 0.0
        return float(executor().call(_Elevation(self.scene), (), {}))

    @cached_property
    def guide(self) -> Guide | None:
        """What keeps the camera out of solids and frames the scene; None without a camera."""
        return None if self.scene is None else Guide(self.scene)

    @cached_property
    def ruler(self) -> Ruler | None:
        """What measures distances on the scene; None for an ``@image``."""
        return None if self.scene is None else Ruler(self.scene)

    @cached_property
    def animated(self) -> bool:
        """Whether the picture depends on the time."""
        return executor().reads_time(self.image(COLOR, encoded=True))

    @cached_property
    def keeps_frames(self) -> bool:
        """Whether it reads earlier frames or what a host knows of one: the keyboard, the date."""
        return executor().keeps_frames(self.image(COLOR, encoded=True))

    @cached_property
    def reads_keyboard(self) -> bool:
        """Whether keys are the picture's: it reads the keyboard."""
        return self.keeps_frames and executor().reads_keyboard(self.image(COLOR, encoded=True))

    @cached_property
    def is_sectionable(self) -> bool:
        """Whether it can be cut open: a scene of solids, without the march for terrain."""
        scene = self.scene
        return scene is not None and scene.march == "sphere" and is_sectionable(scene.shape.node)

    @property
    def uncut_reason(self) -> str:
        """Why it cannot be cut open; "" if it can."""
        if self.scene is None:
            return "only scenes and shapes can be cut open; an @image has no solid"
        if self.scene.march != "sphere":
            return f'a scene with march="{self.scene.march}" cannot be cut open'
        return "" if self.is_sectionable else "nothing to cut open: planes stay whole"

    def shown_with(self, section: CutPlane | None) -> Viewable:
        """Return what a picture with a section shows: the object itself if it is not cut."""
        return self if section is None or self.sectioned is None else self.sectioned

    @cached_property
    def sectioned(self) -> Viewable | None:
        """The same object cut open by a ``CutPlane``; None if it has nothing that can be cut."""
        scene = self.scene
        if scene is None or not self.is_sectionable:
            return None
        made = copy.copy(self)
        made.scene = made._source = scene.sectioned
        for name in ("film", "guide", "ruler"):
            made.__dict__.pop(name, None)
        return made

    @property
    def source(self) -> Scene | Image:
        """The scene, that of a shape, or the ``@image``."""
        return self._source

    @property
    def file(self) -> Path | None:
        """The author's file, if known; a notebook's cell is none."""
        return _file_of(self._source)

    def image(
        self,
        view: str = COLOR,
        *,
        steered: bool = False,
        encoded: bool = False,
        sampled: bool = False,
    ) -> Image | Composed:
        """Return the object to render and compile.

        Args:
            view: One of ``views``; for an ``@image`` also "local:NAME".
            steered: Whether the camera is moved by a ``Steering``; no effect for an ``@image``.
            encoded: Whether pixels are display values. Otherwise they are linear light if the
                renderer computes it, with a ``display`` that encodes it.
            sampled: Whether a pixel is the mean of ``Samples`` rays; no effect for an ``@image``.

        Raises:
            ValueError: There is no such view.
        """
        if self.scene is not None:
            return self.scene.view(view, steered=steered, encoded=encoded, sampled=sampled)
        assert isinstance(self._source, Image)
        if view == COLOR:
            shown = self._source.shown
            copy_loaded_from(self._source, shown)
            return shown
        if view not in self._images:
            self._images[view] = view_of_image(self._source, view)
        return self._images[view]

    def is_traced(self, view: str) -> bool:
        """Return whether the light of a view is that of random paths."""
        return self.mode == "path" and view == COLOR

    @cached_property
    def film(self) -> tuple[FilmPass, ShownFilm] | None:
        """The programs of a live picture by paths; None in mode "direct"."""
        if self.scene is None or self.mode != "path":
            return None
        return FilmPass(self.scene, caustics=self.caustics), ShownFilm(self.scene)

    def is_sampled(self, view: str) -> bool:
        """Return whether a still of a view gets several samples in a pixel: a scene's colors."""
        return self.scene is not None and view == COLOR

    def settings(
        self, steering: Steering = STILL, section: CutPlane | None = None
    ) -> dict[str, Any]:
        """Return the uniforms of a steered program; empty if there is no camera.

        Args:
            steering: How a person has moved the camera.
            section: The plane that a program of ``sectioned`` reads.
        """
        plane = {} if section is None else section.settings
        return {**steering.settings, **plane} if self.steers else {}

    def render(self, options: RenderOptions) -> Picture:
        """Render the picture.

        Args:
            options: How it is rendered. Its ``section`` takes no effect if nothing can be cut; its
                mode and caustics are those of this object.
        """
        shown = self.shown_with(options.section)
        return shown._rendered(replace(options, section=None) if shown is self else options)

    def _rendered(self, options: RenderOptions) -> Picture:
        """Render the picture; with a section, of what ``sectioned`` returned."""
        view, steering, section = options.view, options.steering, options.section
        staged: tuple[Mapping[str, Any], float] | None = None
        asked: Mapping[str, Any] = {}
        if self.scene is None:
            image, settings = self.image(view), {}
        else:
            image, sampled = self.scene.program(
                view,
                options.samples,
                steered=steering is not None,
                mode=self.mode,
                caustics=self.caustics,
            )
            settings = {**steering_settings(options), **sampled}
            staged, asked = self.scene.staged, self.scene.asked_display
            if options.refinement is None:
                refinement = refinement_of(options, self.mode, self.scene.shutter)
                options = replace(options, refinement=refinement)
        picture = executor().render(image, with_range(image, replace(options, settings=settings)))
        return picture.with_provenance(
            view=view,
            mode="path" if self.is_traced(view) else "direct",
            steering=steering.numbers if steering is not None and self.steers else None,
            section=None if section is None else section.numbers,
            stage=staged,
            **asked,
        )


class _Elevation(Composed):
    """The elevation of a scene's camera above its target."""

    name = "elevation"
    signature = ()
    result = FLOAT

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        return SceneLowering(assembly, self._scene).camera.elevation()


def view_label(view: str) -> str:
    """Return a view's name for people: "Half way" for "local:half_way"."""
    label = view.removeprefix(PREFIX).replace("_", " ")
    return label[:1].upper() + label[1:]


def viewable(
    obj: Any,
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
    look: str | None = None,
) -> Viewable:
    """Return the common interface of a scene, a shape, a group or an ``@image``.

    Args:
        obj: The object to show; a ``Viewable`` is returned unchanged.
        params: Values of parameters by name, for the framing of a single shape.
        time: Time in seconds, for the framing of a single shape.
        look: The name of a look that a scene or shape is shown in; None for its own.

    Raises:
        LoadError: The object is not a picture, or an ``@image``, which has no look.
        ValueError: There is no such look.
    """
    if isinstance(obj, Viewable):
        return obj
    picture = checked_picture(Scene(obj) if isinstance(obj, Group) else obj)
    if isinstance(picture, BaseShape):
        return Viewable(picture.name, stage(picture, params, time, look))
    if isinstance(picture, Scene):
        return Viewable(picture.name, picture.with_display(look=look))
    if look is not None:
        raise LoadError(f"looks are for scenes and shapes; '{picture.name}' is an @image")
    return Viewable(picture.name, picture)


def checked_picture(obj: object) -> Image | Scene | BaseShape:
    """Return the object if it can be shown as a picture.

    Raises:
        LoadError: The object is not a picture.
    """
    if isinstance(obj, Image | Scene | BaseShape):
        return obj
    name = getattr(obj, "name", repr(obj)[:60])
    what = "a @func" if isinstance(obj, Func) else f"of type {type(obj).__name__}"
    raise LoadError(f"'{name}' is {what}; only a scene, a shape or an @image is a picture")


def _file_of(source: Scene | Image) -> Path | None:
    name: str | None = None
    if isinstance(source, Image):
        name = source.overloads[0].source.file
    elif source.place is not None:
        name = source.place.file
    if name is None or name.startswith("<"):
        return None
    path = Path(name)
    is_cell = path.parent.name.startswith("ipykernel_") or path.stem.startswith("__marimo__")
    return None if is_cell or not path.exists() else path
