"""``distal render``: a picture of a scene, a shape or an image, in color or as another view.

Input: parsed words. Output: a picture's file, and how long it took. What a view
shows is the library's matter; here stands only which options go with what.
"""

from __future__ import annotations

import functools
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from distal.cli.arguments import UsageError, read_plane, read_size, read_time
from distal.cli.base import (
    AdapterOption,
    Device,
    DeviceOption,
    SceneArgument,
    SetOption,
    SizeOption,
    ThreadsOption,
    TimeOption,
    answer,
    application,
    check_view,
    chosen_device,
    load_picture,
    reporting,
)

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.viewing.viewable import Viewable

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
    threads: ThreadsOption = None,
    stats: Annotated[
        bool, typer.Option("--stats", help="Print one line of JSON with the figures.")
    ] = False,
) -> None:
    """Render a scene, a shape or an image to a picture."""
    from distal.cli.messages import say
    from distal.cli.report import ProgressBar, stages
    from distal.images.picture import check_savable
    from distal.runtime.uniform_values import LARGEST_SIDE_PX
    from distal.scene.viewing.viewable import viewable

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    wishes = read_wishes(view, plane, samples, transparent, exposure, tone_map)
    suffix, _ = check_savable(output, bits)
    device_name = chosen_device(device, adapter)
    begin = time.perf_counter()
    obj, values = load_picture(scene, assignments)
    seen = viewable(obj, values, seconds)
    wishes = replace(wishes, layers=read_layers(layers, suffix, seen, wishes.view))
    run = rendering(seen, wishes)
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


def read_layers(given: str | None, suffix: str, seen: Viewable, view: str) -> tuple[str, ...]:
    """The layers that a file of a suffix is to hold: those that were asked for, else all."""
    from distal.scene.lowering.layers import NAMES, checked_layers

    if given is None:
        all_of_them = suffix == ".exr" and view == "color" and seen.scene is not None
        return NAMES if all_of_them else ()
    if given == "none":
        return ()
    if suffix != ".exr":
        raise UsageError(f"layers are for an .exr, not for a {suffix}")
    try:
        return checked_layers(name.strip() for name in given.split(","))
    except ValueError as error:
        raise UsageError(str(error)) from None


def rendering(seen: Viewable, wishes: Wishes) -> Run:
    """What renders a picture as it is to be seen.

    Raises:
        UsageError: It cannot be seen that way.
    """
    if seen.scene is None:
        wishes.refuse_for_image(seen.name)
    check_view(seen, wishes.view)
    if seen.scene is None:
        return functools.partial(seen.render, view=wishes.view)
    scene = seen.scene.developed(exposure=wishes.exposure, tone_map=wishes.tone_map)
    return functools.partial(scene.render, **wishes.options)
