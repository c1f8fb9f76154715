"""What windows, pages, notebooks and videos show: one interface to scenes, shapes and images.

Input: any object that is a picture. Output: its programs by view, with a camera
that can be moved where it has one, and its parameters. Knows no window and no page.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import LoadError
from distal.frontend import Assembly
from distal.ir.types import FLOAT
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.parameters import Parameter
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.render.views import VIEWS
from distal.scene.lowering.local_views import VIEWS as IMAGE_VIEWS
from distal.scene.lowering.local_views import view_of_image
from distal.scene.lowering.picture import SceneLowering
from distal.scene.objects.field import BaseShape
from distal.scene.scene import Scene
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.stage import stage

if TYPE_CHECKING:
    from distal.images.picture import Picture

COLOR: Final = "color"


class Viewable:
    """A picture that can be looked at in several ways.

    Attributes:
        name: What the author calls it.
        scene: The scene, with the stage of a lone shape around it; None for an ``@image``.
        views: The ways it can be looked at; "color" is the first.
    """

    def __init__(self, name: str, source: Scene | Image) -> None:
        self.name = name
        self._source = source
        self.scene = source if isinstance(source, Scene) else None
        self._images: dict[str, Image | Composed] = {}

    @cached_property
    def views(self) -> tuple[str, ...]:
        """The names of what ``image`` shows."""
        if self.scene is not None:
            return (COLOR, *VIEWS)
        return (COLOR, *(view for view in IMAGE_VIEWS if self._has(view)))

    @cached_property
    def parameters(self) -> list[Parameter]:
        """Its parameters, by first use."""
        return self._source.parameters()

    @property
    def steers(self) -> bool:
        """Whether its camera can be moved; else drags are the frame's mouse."""
        return self.scene is not None

    @cached_property
    def elevation(self) -> float:
        """The camera's first elevation above what it looks at, in radians."""
        if self.scene is None:
            return 0.0
        return float(executor().call(_Elevation(self.scene), (), {}))

    @cached_property
    def animated(self) -> bool:
        """Whether the picture depends on the time."""
        return executor().reads_time(self.image(COLOR, encoded=True))

    @property
    def file(self) -> Path | None:
        """The file that the author wrote it in, where known."""
        return _file_of(self._source)

    def image(
        self, view: str = COLOR, *, steered: bool = False, encoded: bool = False
    ) -> Image | Composed:
        """What is rendered and compiled.

        Args:
            view: One of ``views``; of an ``@image`` also "local:NAME".
            steered: Whether the camera is moved by a ``Steering``; nothing for an ``@image``.
            encoded: Whether pixels are display values. Else they are linear light where the
                renderer makes such, with a ``display`` that encodes it.

        Raises:
            ValueError: There is no such view.
        """
        if self.scene is not None:
            return self.scene.view(view, steered=steered, encoded=encoded)
        assert isinstance(self._source, Image)
        if view == COLOR:
            return self._source
        if view not in self._images:
            self._images[view] = view_of_image(self._source, view)
        return self._images[view]

    def settings(self, steering: Steering = STILL) -> dict[str, Any]:
        """The values of a steered program's numbers; empty where no camera is moved."""
        return steering.settings if self.steers else {}

    def render(
        self, options: RenderOptions, *, view: str = COLOR, steering: Steering | None = None
    ) -> Picture:
        """The picture.

        Args:
            options: How it is rendered.
            view: One of ``views``.
            steering: How the camera is moved by hand; None: not.
        """
        image = self.image(view, steered=steering is not None)
        settings = {} if steering is None else self.settings(steering)
        picture = executor().render(image, replace(options, settings=settings))
        moved = steering.numbers if steering is not None and self.steers else None
        staged = None if self.scene is None else self.scene.staged
        return picture.with_provenance(view=view, steering=moved, stage=staged)

    def _has(self, view: str) -> bool:
        try:
            self.image(view)
        except ValueError:
            return False
        return True


class _Elevation(Composed):
    """The elevation of a scene's camera above what it looks at."""

    name = "elevation"
    signature = ()
    result = FLOAT

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """The function of nothing."""
        return SceneLowering(assembly, self._scene).elevation()


def view_label(view: str) -> str:
    """What a person reads of a view: "local:half_way" is "Half way"."""
    label = view.removeprefix("local:").replace("_", " ")
    return label[:1].upper() + label[1:]


def viewable(obj: Any, params: Mapping[str, Any] | None = None, time: float = 0.0) -> Viewable:
    """The one interface over a scene, a shape and an ``@image``.

    Args:
        obj: What is to be shown; what is a ``Viewable`` already stays as it is.
        params: Values of parameters by name: the stage of a lone shape is as large as it is then.
        time: Seconds, for the same.

    Raises:
        LoadError: It is no picture.
    """
    if isinstance(obj, Viewable):
        return obj
    picture = checked_picture(obj)
    if isinstance(picture, BaseShape):
        return Viewable(picture.name, stage(picture, params, time))
    return Viewable(picture.name, picture)


def checked_picture(obj: object) -> Image | Scene | BaseShape:
    """What a picture can be made of.

    Raises:
        LoadError: It is something else.
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
    return None if name is None or name.startswith("<") else Path(name)
