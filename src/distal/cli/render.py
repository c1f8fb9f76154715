"""``distal render``: render a scene, a shape or an image, in color or as another view.

Input: parsed arguments. Output: a picture file, and the time that it took. This module only checks
which options are valid together.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from distal.cli.arguments import UsageError, read_scene
from distal.cli.base import (
    AdapterOption,
    ClusterOption,
    Device,
    DeviceOption,
    LookOption,
    ProgressKind,
    ProgressOption,
    SceneArgument,
    SetOption,
    TimeoutOption,
    application,
    check_view,
    chosen_device,
    cluster_of,
    load_picture,
    reporting,
)
from distal.cli.options import NOTHING_ASKED, Asked, flag_name, flags, request_of, requesting
from distal.example_files import EXAMPLE_PREFIX
from distal.lang.progress_lines import COMPILING, LOADING

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.lang.render_options import RenderOptions
    from distal.scene.viewing.viewable import Viewable


@dataclass(frozen=True, slots=True)
class KeptSamples:
    """The samples of mode "path" that a file keeps while a picture is rendered.

    Attributes:
        film: The file.
        goes_on: Whether the samples that it keeps already are used, and those of this run kept.
        preview: Called with the picture so far.
    """

    film: Path
    goes_on: bool
    preview: Callable[[Picture], Any]

    def asked(self, options: RenderOptions, scene_mode: str) -> RenderOptions:
        """Return the options with the file, if they are of mode "path".

        Raises:
            UsageError: An option for mode "path" was given in another mode.
        """
        from distal.scene.view_options import refinement_of

        is_path = (options.mode or scene_mode) == "path"
        if is_path:
            options = replace(options, film=self.film, preview=self.preview)
        elif not options.caustics:
            raise UsageError("--no-caustics is for --mode path")
        elif self.goes_on:
            raise UsageError("--continue is for --mode path")
        try:
            refinement = refinement_of(options, scene_mode)
        except ValueError as error:
            raise UsageError(str(error)) from None
        if refinement is not None:
            self.forget()
        return options

    def forget(self) -> None:
        """Delete the samples that a run has kept, unless they are wanted."""
        if not self.goes_on:
            self.film.unlink(missing_ok=True)


def picture_beside(scene: str) -> Path:
    """Return the picture's file for a scene: named like it, in the current folder.

    Args:
        scene: FILE[:NAME] or example:NAME[:NAME].
    """
    path, name = read_scene(scene)
    stem = Path(path.removeprefix(EXAMPLE_PREFIX)).stem
    return Path(f"{stem}.png" if name is None else f"{stem}_{name}.png")


@application.command()
@reporting
@requesting("scene")
def render(
    scene: SceneArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="The picture's file: .png, .jpg or .exr. Without it: the scene's name with .png.",
            show_default=False,
        ),
    ] = None,
    asked: Asked = NOTHING_ASKED,
    assignments: SetOption = None,
    goes_on: Annotated[
        bool,
        typer.Option(
            "--continue",
            help="In mode path: use the samples of a run that was broken off, and keep them.",
        ),
    ] = False,
    exposure: Annotated[
        float | None, typer.Option(min=0.0, help="A factor on all light; the scene's without it.")
    ] = None,
    tone_map: Annotated[
        str | None, typer.Option(help="none, reinhard, aces, agx or neutral.", show_default=False)
    ] = None,
    look: LookOption = None,
    bits: Annotated[
        int | None,
        typer.Option(help="Of each channel: 8 or 16 of a PNG; 8 of a JPEG; 16 or 32 of an EXR."),
    ] = None,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    cluster: ClusterOption = None,
    task_timeout: TimeoutOption = 600.0,
    shown_progress: ProgressOption = ProgressKind.BAR,
    stats: Annotated[
        bool, typer.Option("--stats", help="Print one line of JSON with the figures.")
    ] = False,
) -> None:
    """Render a scene, a shape or an image to a picture."""
    from distal.cli.messages import say
    from distal.cli.preview import PreviewFile, described
    from distal.cli.report import picture_progress, stages
    from distal.file_writer import name_beside
    from distal.images.picture import check_savable
    from distal.scene.rendering import render_scene
    from distal.scene.viewing.viewable import viewable

    asked = check_view_options(asked, exposure, tone_map)
    output = output or picture_beside(scene)
    suffix, _ = check_savable(output, bits)
    if asked["transparent"] and suffix == ".jpg":
        raise UsageError("a JPEG has no transparency: -o FILE.png")
    film = name_beside(output, ".film")
    progress = picture_progress(shown_progress)
    preview = PreviewFile(output, bits, film, progress)
    kept = KeptSamples(film, goes_on, preview)
    device_name = chosen_device(device, adapter)
    begin = time.perf_counter()
    progress.stage(LOADING)
    obj, values = load_picture(scene, assignments)
    progress.stage(COMPILING)
    seen = viewable(obj, values, asked["time"], look)
    asked = {**asked, "layers": read_layers(suffix, seen, asked)}
    check_shown(seen, asked, exposure, tone_map)
    loaded = time.perf_counter()
    with cluster_of(cluster, device_name, task_timeout) as pool, progress, preview:
        options = request_of(
            asked, params=values, device=device_name, progress=progress, cluster=pool
        )
        if seen.scene is None:
            picture = seen.render(options)
        else:
            developed = seen.scene.with_display(exposure=exposure, tone_map=tone_map)
            picture = render_scene(developed, kept.asked(options, developed.mode))
    rendered = time.perf_counter()
    picture.save(output, bits)
    if picture.provenance.mode == "path":
        kept.forget()
    figures = {
        "load_s": loaded - begin,
        **dict.fromkeys(("compile_s", "render_s", "cache_hit", "lanes", "threads")),
        "device": device_name,
        **picture.stats,
        "save_s": time.perf_counter() - rendered,
        "size": list(options.size),
    }
    if stats:
        progress.answer(json.dumps(figures))
    else:
        say(f"{output}: {picture.width}x{picture.height}; {stages(figures)}")
        if picture.stats.get("noise") is not None:
            say(described(picture.stats))
        if options.clamp is not None:
            say(f"samples brighter than {options.clamp:g} were scaled to it: the picture is biased")


def check_view_options(asked: Asked, exposure: float | None, tone_map: str | None) -> Asked:
    """Return what was asked for, with the view that a plane is for.

    Args:
        asked: The options of the picture.
        exposure: Factor on all light.
        tone_map: The name of a tone map.

    Raises:
        UsageError: The options are not valid together, or a value is invalid.
    """
    from distal.render.tonemap import NAMES

    if "plane" not in asked:
        view = asked.get("view", "color")
    elif (view := asked.get("view", "slice")) != "slice":
        raise UsageError(f"--slice is the plane of the view 'slice', not of '{view}'")
    if tone_map is not None and tone_map not in NAMES:
        raise UsageError(f"there is no tone map '{tone_map:.40}'; tone maps: {', '.join(NAMES)}")
    if exposure is not None and not exposure < 1e9:
        raise UsageError(f"an exposure is finite, not {exposure}")
    return {**asked, "view": view}


def read_layers(suffix: str, seen: Viewable, asked: Asked) -> tuple[str, ...]:
    """Return the layers to store in a file: the given ones, or the default for the suffix.

    Args:
        suffix: The suffix of the file.
        seen: The object to render.
        asked: The options; ``layers`` are names separated by commas, or "none".

    Raises:
        UsageError: The file cannot hold layers, or there is no such layer.
    """
    from distal.scene.lowering.layers import NAMES, OF_SAMPLES, checked_layers

    given = asked.get("layers")
    if given is None:
        if suffix != ".exr" or asked["view"] != "color" or seen.scene is None:
            return ()
        by_paths = asked.get("mode", seen.scene.mode) == "path"
        return tuple(name for name in NAMES if by_paths or name not in OF_SAMPLES)
    if given == "none":
        return ()
    if suffix != ".exr":
        raise UsageError(f"layers are for an .exr, not for a {suffix}")
    try:
        return checked_layers(name.strip() for name in given.split(","))
    except ValueError as error:
        raise UsageError(str(error)) from None


def check_shown(seen: Viewable, asked: Asked, exposure: float | None, tone_map: str | None) -> None:
    """Check that the object supports the view and its options.

    Args:
        seen: The object to render.
        asked: The options of the picture.
        exposure: Factor on all light.
        tone_map: The name of a tone map.

    Raises:
        UsageError: It is an ``@image``, which lacks such an option, or there is no such view.
    """
    if seen.scene is None:
        of_scenes = [row for row in flags("scene") if "image" not in row.methods.split()]
        given = {
            flag_name(row): asked.get(row.name, row.default) != row.default
            for row in of_scenes
            if row.name != "view"
        }
        given |= {"--exposure": exposure is not None, "--tone-map": tone_map is not None}
        for option, is_given in given.items():
            if is_given:
                raise UsageError(f"{option} is for scenes and shapes; '{seen.name}' is an @image")
    check_view(seen, asked["view"])
