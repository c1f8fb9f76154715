"""``distal render``: a picture of a scene, a shape or an image, in color or as another view.

What flows in: parsed words. What flows out: a picture's file, and how long it took. What a view
shows is the library's matter; here stands only which options go with what.
"""

from __future__ import annotations

import functools
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from distal.cli.arguments import (
    UsageError,
    read_assignments,
    read_plane,
    read_size,
    read_time,
)
from distal.cli.base import (
    AdapterOption,
    Device,
    DeviceOption,
    SceneArgument,
    SetOption,
    SizeOption,
    TimeOption,
    answer,
    application,
    chosen_device,
    load,
    reporting,
)
from distal.diagnostics import LoadError

if TYPE_CHECKING:
    from distal.film.picture import Picture

Run: TypeAlias = "Callable[..., Picture]"


@dataclass(frozen=True, slots=True)
class Wishes:
    """How a scene is to be seen; None where nothing was said."""

    view: str
    plane: tuple[tuple[float, float, float], float] | None
    samples: int | None
    transparent: bool
    exposure: float | None
    tone_map: str | None
    layers: tuple[str, ...] | None = None

    @property
    def options(self) -> dict[str, Any]:
        """What ``Scene.render`` is told of them."""
        said: dict[str, Any] = {"view": self.view, "plane": self.plane, "samples": self.samples}
        said |= {"transparent": self.transparent, "layers": self.layers}
        plain = (None, False, "color", ())
        return {name: value for name, value in said.items() if value not in plain}

    def refuse_for_image(self, name: str) -> None:
        """Refuse what only a scene can be asked for."""
        given = {
            "--slice": self.plane,
            "--samples": self.samples,
            "--transparent": self.transparent or None,
            "--exposure": self.exposure,
            "--tone-map": self.tone_map,
            "--layers": self.layers or None,
        }
        for option, value in given.items():
            if value is not None:
                raise UsageError(f"{option} is for scenes and shapes; '{name}' is an @image")


@application.command()
@reporting
def render(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", help="The picture's file: .png or .exr.", show_default=False
        ),
    ],
    size: SizeOption = "640x480",
    at: TimeOption = "0",
    assignments: SetOption = None,
    samples: Annotated[
        int | None, typer.Option(min=1, max=65536, help="Rays for each pixel.")
    ] = None,
    view: Annotated[
        str | None,
        typer.Option(
            help="color, coordinate, signal, distance, normal, depth, steps, material, slope, "
            "slice; of an @image color, coordinate, signal, local:NAME.",
            show_default=False,
        ),
    ] = None,
    plane: Annotated[
        str | None,
        typer.Option("--slice", metavar="AXIS=OFFSET", help="The plane of the view slice."),
    ] = None,
    transparent: Annotated[
        bool, typer.Option("--transparent", help="Leave out what is behind everything.")
    ] = False,
    exposure: Annotated[
        float | None, typer.Option(min=0.0, help="A factor on all light; the scene's without it.")
    ] = None,
    tone_map: Annotated[
        str | None, typer.Option(help="none, reinhard, aces, agx or neutral.", show_default=False)
    ] = None,
    bits: Annotated[
        int | None,
        typer.Option(help="Of each channel: 8 or 16 of a PNG; 16 or 32 of an EXR."),
    ] = None,
    layers: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="What an EXR holds besides color: depth,normal,albedo,material or none; "
            "all without it.",
            show_default=False,
        ),
    ] = None,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    threads: Annotated[
        int | None,
        typer.Option(min=1, max=1024, help="CPU threads; one per core if not given."),
    ] = None,
    stats: Annotated[
        bool, typer.Option("--stats", help="Print one line of JSON with the figures.")
    ] = False,
) -> None:
    """Render a scene, a shape or an image to a picture."""
    from distal.cli.report import ProgressBar, say, stages
    from distal.film.picture import check_savable
    from distal.uniform_values import LARGEST_SIDE_PX

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    wishes = read_wishes(view, plane, samples, transparent, exposure, tone_map)
    suffix, _ = check_savable(output, bits)
    device_name = chosen_device(device, adapter)
    begin = time.perf_counter()
    obj = load(scene)
    wishes = replace(wishes, layers=read_layers(layers, suffix, obj, wishes.view))
    run, values = prepared(obj, wishes, assignments or (), seconds)
    loaded = time.perf_counter()
    with ProgressBar() as progress:
        picture = run(
            size=width_height,
            time=seconds,
            params=values,
            device=device_name,
            threads=threads,
            progress=progress,
        )
    rendered = time.perf_counter()
    picture.save(output, bits)
    figures = {
        "load_s": loaded - begin,
        **dict.fromkeys(("compile_s", "render_s", "cache_hit", "lanes", "threads")),
        "device": device_name,
        **picture.stats,
        "save_s": time.perf_counter() - rendered,
        "size": list(width_height),
    }
    if stats:
        answer(json.dumps(figures))
    else:
        say(f"{output}: {picture.width}x{picture.height}; {stages(figures)}")


def read_wishes(
    view: str | None,
    plane: str | None,
    samples: int | None,
    transparent: bool,
    exposure: float | None,
    tone_map: str | None,
) -> Wishes:
    """The options of how a scene is seen, held against each other."""
    from distal.render.tonemap import NAMES

    if plane is not None and view not in (None, "slice"):
        raise UsageError(f"--slice is the plane of the view 'slice', not of '{view}'")
    if tone_map is not None and tone_map not in NAMES:
        raise UsageError(f"there is no tone map '{tone_map:.40}'; tone maps: {', '.join(NAMES)}")
    if exposure is not None and not exposure < 1e9:
        raise UsageError(f"an exposure is finite, not {exposure}")
    seen = view or ("color" if plane is None else "slice")
    wanted = None if plane is None else read_plane(plane)
    return Wishes(seen, wanted, samples, transparent, exposure, tone_map)


def read_layers(given: str | None, suffix: str, obj: Any, view: str) -> tuple[str, ...]:
    """The layers that a file of a suffix is to hold: those that were asked for, else all."""
    from distal.lang.functions import Func
    from distal.scene.layers import NAMES, checked_layers

    if given is None:
        all_of_them = suffix == ".exr" and view == "color" and not isinstance(obj, Func)
        return NAMES if all_of_them else ()
    if given == "none":
        return ()
    if suffix != ".exr":
        raise UsageError(f"layers are for an .exr, not for a {suffix}")
    try:
        return checked_layers(name.strip() for name in given.split(","))
    except ValueError as error:
        raise UsageError(str(error)) from None


def prepared(
    obj: Any, wishes: Wishes, assignments: Sequence[str], seconds: float
) -> tuple[Run, Mapping[str, Any]]:
    """What renders an object, and the values of its parameters.

    Raises:
        LoadError: It is no picture.
        UsageError: It cannot be seen that way, or a parameter's value is wrong.
    """
    from distal.lang.functions import Func, Image

    if isinstance(obj, Image):
        wishes.refuse_for_image(obj.name)
        values = read_assignments(assignments, obj.parameters())
        return _image_run(obj, wishes.view), values
    if isinstance(obj, Func) or not hasattr(obj, "parameters"):
        raise LoadError(f"'{obj.name}' is a @func; only a scene, a shape or an @image is a picture")
    values = read_assignments(assignments, obj.parameters())
    return _scene_run(staged(obj, values, seconds), wishes), values


def _image_run(image: Any, view: str) -> Run:
    if view == "color":
        run: Run = image.render
        return run
    from distal.executor_hook import executor
    from distal.scene.local_views import view_of_image

    try:
        seen = view_of_image(image, view)
    except ValueError as error:
        raise UsageError(str(error)) from None
    return lambda **options: executor().render(seen, **options).told(view=view)


def _scene_run(scene: Any, wishes: Wishes) -> Run:
    if wishes.view != "color":
        _check_view(wishes.view)
    if wishes.exposure is not None or wishes.tone_map is not None:
        scene = scene.developed(exposure=wishes.exposure, tone_map=wishes.tone_map)
    return functools.partial(scene.render, **wishes.options)


def _check_view(view: str) -> None:
    from distal.render.views import VIEWS

    if view not in VIEWS:
        known = ", ".join(("color", *VIEWS))
        hint = "; locals are shown of an @image" if view.startswith("local:") else ""
        raise UsageError(f"a scene has no view '{view:.40}'; views: {known}{hint}")


def staged(obj: Any, values: Mapping[str, Any], seconds: float) -> Any:
    """A scene as it is; a shape in a scene of its own."""
    from distal.scene.field import Field

    if not isinstance(obj, Field):
        if not hasattr(obj, "render"):
            raise LoadError(f"'{obj.name}' is no scene, no shape and no @image")
        return obj
    from distal.scene.stage import stage

    return stage(obj, values, seconds)
