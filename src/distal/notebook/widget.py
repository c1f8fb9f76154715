"""The live picture of a notebook cell.

Input: a viewable object, and values of its parameters. Output: a widget that shows it in the
browser. Both sides can change its state (parameters, time, view, camera). Does not depend on how
the browser draws.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from distal.diagnostics import CompileError, LoadError, printable_lines
from distal.export.page import PLAYER, player_of
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.images.picture import Picture
from distal.lang.chosen_values import checked_values
from distal.lang.render_options import (
    Cancel,
    Progress,
    RenderOptions,
    checked_size,
    checked_time,
)
from distal.scene.steering import Steering
from distal.scene.view_options import refinement_of
from distal.scene.viewing.viewable import Viewable, viewable


class LiveView(anywidget.AnyWidget):
    """A live picture. ``params``, ``time``, ``view`` and ``steering`` are traits to observe.

    Attributes:
        params: The value of each parameter by name. Set it, or ``set(name=value)``, from Python;
            controls in the browser change it.
        time: Seconds.
        playing: Whether the time runs.
        view: The name of the view: "color", "normal", "depth" …
        steering: The movement of the camera: ``yaw``, ``pitch``, ``zoom``, ``pan``.
        error: The message of the browser's driver about the shader, or "".
    """

    _esm: Path | str = PLAYER

    payload = traitlets.Dict(read_only=True).tag(sync=True)
    params = traitlets.Dict().tag(sync=True)
    time = traitlets.Float(0.0).tag(sync=True)
    playing = traitlets.Bool(False).tag(sync=True)
    view = traitlets.Unicode("color").tag(sync=True)
    steering = traitlets.Any().tag(sync=True)  # may also be set to a Steering
    error = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self,
        obj: Any,
        *,
        size: tuple[int, int] = (640, 480),
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        playing: bool | None = None,
        view: str = "color",
        panel: bool = True,
        mode: str | None = None,
    ) -> None:
        """Show a live picture in a notebook, with a control for every parameter.

        The widget's ``params``, ``time``, ``view`` and ``steering`` are bound both ways: controls
        change them, and setting them changes the picture. Needs the extra ``notebook``.

        Args:
            obj: The object to show.
            size: Width and height of the picture in CSS pixels.
            params: Values of parameters by name; the others have their defaults.
            time: Initial time in seconds.
            playing: Whether the time runs; None: if the picture depends on it.
            view: The initial view.
            panel: Whether to show controls beside the picture.
            mode: How light is computed: "direct" or "path"; None: as the scene says.

        Raises:
            CompileError: The scene code has mistakes, or uses something that WebGL lacks.
            ValueError: A value is out of its parameter's range, or there is no such view.
        """
        size, time = checked_size(size), checked_time(time)
        self._seen: Viewable = viewable(obj, params, time).in_mode(mode)
        if view not in self._seen.views:
            raise ValueError(f"there is no view '{view}'; views: {', '.join(self._seen.views)}")
        values = self._checked(params)
        # The widget's own trait, not the payload, determines the initial view.
        variable = variable_of(obj)
        title = None if variable in (None, "scene", "_") else variable.replace("_", " ")
        options = PageOptions(size=size, params=values, time=time, panel=panel, title=title)
        made = payload(self._seen, options, variable=variable)
        # Without views that WebGL cannot show.
        self._views = [shown["name"] for shown in made["views"]]
        if (player := player_of(self._seen)) != PLAYER:
            self._esm = player.read_text(encoding="utf-8")
        super().__init__(
            params={**{p.name: _plain(p.default) for p in self._seen.parameters}, **values},
            time=time,
            playing=self._seen.animated if playing is None else playing,
            view=view,
            steering=_as_dict(Steering()),
        )
        self.set_trait("payload", made)
        self._size = size

    def set(self, **values: Any) -> None:
        """Change parameters: ``widget.set(softness=0.1)``.

        Raises:
            ValueError: There is no such parameter, or a value is out of its range.
            TypeError: A value has the wrong type.
        """
        self.params = {**self.params, **values}

    def render(
        self,
        size: tuple[int, int] | None = None,
        *,
        device: str = "cpu",
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        mouse: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
        index: int | None = None,
        seed: int = 0,
        samples: int | None = None,
        time_limit: float | None = None,
        freeze: bool = False,
    ) -> Picture:
        """Render what the widget shows now in Python, as a ``Picture`` to save or to measure.

        Args:
            size: Width and height in pixels; None for the widget's size.
            device: As for ``Scene.render``, like all following arguments.
            threads: How many CPU threads to use.
            progress: Called with the finished fraction.
            cancel: Stops the rendering early.
            mouse: The frame's mouse.
            index: The number of the frame; None: as for ``Image.render``.
            seed: The seed of random numbers.
            samples: Samples in each pixel.
            time_limit: In mode "path": seconds after which no more samples are begun.
            freeze: Compile all numbers as constants.
        """
        options = RenderOptions(
            size=size or self._size,
            time=self.time,
            params=dict(self.params),
            device=device,
            threads=threads,
            progress=progress,
            cancel=cancel,
            mouse=mouse,
            index=index,
            seed=seed,
            samples=samples,
            time_limit=time_limit,
            view=self.view,
            steering=_as_steering(self.steering) if self._seen.steers else None,
            freeze=freeze,
        )
        refinement = refinement_of(options, self._seen.mode)
        return self._seen.render(replace(options, refinement=refinement))

    def _checked(self, values: Mapping[str, Any] | None) -> dict[str, Any]:
        chosen = checked_values(self._seen.parameters, values)
        return {name: _plain(value) for name, value in chosen.items()}

    @traitlets.validate("params")
    def _check_params(self, proposal: Any) -> dict[str, Any]:
        # Parameters that a message omits keep their values, so partial changes lose nothing.
        return {**self.params, **self._checked(proposal["value"])}

    @traitlets.validate("time")
    def _check_time(self, proposal: Any) -> float:
        # Messages to the browser are JSON, which has no infinity.
        return checked_time(proposal["value"])

    @traitlets.validate("view")
    def _check_view(self, proposal: Any) -> str:
        view: str = proposal["value"]
        if view not in self._views:
            known = ", ".join(self._views)
            raise traitlets.TraitError(f"there is no view '{view}'; views: {known}")
        return view

    @traitlets.validate("steering")
    def _check_steering(self, proposal: Any) -> dict[str, Any]:
        return _as_dict(_as_steering(proposal["value"]))


def variable_of(obj: object) -> str | None:
    """Return the notebook's variable that holds an object; None if there is none."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    names = {} if shell is None else dict(shell.user_ns)
    return next((n for n, v in names.items() if v is obj and not n.startswith("_")), None)


def bundle_of(obj: Any) -> Any:
    """Return what a cell that ends with an object shows: it is live, or a text says why not.

    In a terminal nothing is compiled: there its text is shown.
    """
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is not None and not hasattr(shell, "kernel"):
        return None
    try:
        return LiveView(obj)._repr_mimebundle_()
    except (CompileError, LoadError, ValueError, TypeError) as error:
        return {"text/plain": printable_lines(f"{obj!r}\n{error}")}


def _as_steering(value: Mapping[str, Any] | Steering) -> Steering:
    if isinstance(value, Steering):
        return value
    try:
        numbers = {"yaw": 0.0, "pitch": 0.0, "zoom": 1.0, "pan": (0.0, 0.0), **value}
        x, y = (float(c) for c in numbers.pop("pan"))
        return Steering(pan=(x, y), **{name: float(v) for name, v in numbers.items()})
    except (TypeError, ValueError):
        raise traitlets.TraitError(
            f"a steering is yaw, pitch, zoom and pan (two numbers), not {value!r}"
        ) from None


def _as_dict(steering: Steering) -> dict[str, Any]:
    return {
        "yaw": steering.yaw,
        "pitch": steering.pitch,
        "zoom": steering.zoom,
        "pan": list(steering.pan),
    }


def _plain(value: Any) -> Any:
    """Return a parameter's value in the form for JSON."""
    return list(value) if isinstance(value, tuple) else value
