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

from distal.cli.arguments import (
    UsageError,
    read_plane,
    read_scene,
    read_size,
    read_steering,
    read_time,
)
from distal.cli.base import (
    AdapterOption,
    CausticsOption,
    ClusterOption,
    Device,
    DeviceOption,
    LookOption,
    ModeOption,
    ProgressKind,
    ProgressOption,
    SamplesOption,
    SceneArgument,
    SetOption,
    SizeOption,
    SteeringOption,
    ThreadsOption,
    TimeOption,
    TimeoutOption,
    application,
    check_view,
    chosen_device,
    cluster_of,
    load_picture,
    reporting,
)
from distal.example_files import EXAMPLE_PREFIX
from distal.lang.progress_lines import COMPILING, LOADING

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.lang.render_options import RenderOptions
    from distal.scene.steering import Steering
    from distal.scene.viewing.viewable import Viewable


@dataclass(frozen=True, slots=True)
class PathArguments:
    """The options of path tracing; None for options that were not given.

    Attributes:
        mode: "direct" or "path".
        time_limit: Seconds.
        noise: The error at which the picture is finished.
        filter: The reconstruction filter.
        shutter: Seconds that the shutter is open.
        clamp: The largest light of a sample.
        denoise: Whether noise is removed in the end.
        film: The file that keeps the samples so far.
        goes_on: Whether the samples that it keeps already are used, and those of this run kept.
        caustics: Whether photons find caustics.
    """

    mode: str | None
    time_limit: float | None
    noise: float | None
    filter: str | None
    shutter: float | None
    clamp: float | None
    denoise: bool
    film: Path
    goes_on: bool
    preview: Callable[[Picture], Any]
    caustics: bool = True

    def options(self, scene_mode: str) -> dict[str, Any]:
        """Return the arguments of ``RenderOptions``.

        Args:
            scene_mode: The mode of the scene.

        Raises:
            UsageError: ``--continue`` was given in another mode.
        """
        names = ("mode", "time_limit", "noise", "filter", "shutter", "clamp", "denoise")
        given: dict[str, Any] = {name: getattr(self, name) for name in names}
        if (self.mode or scene_mode) == "path":
            return {**given, "film": self.film, "preview": self.preview, "caustics": self.caustics}
        if not self.caustics:
            raise UsageError("--no-caustics is for --mode path")
        if self.goes_on:
            raise UsageError("--continue is for --mode path")
        return given

    def forget(self) -> None:
        """Delete the samples that a run has kept, unless they are wanted."""
        if not self.goes_on:
            self.film.unlink(missing_ok=True)


@dataclass(frozen=True, slots=True)
class ViewArguments:
    """The options of a view; None for options that were not given."""

    view: str
    plane: tuple[tuple[float, float, float], float] | None
    transparent: bool
    exposure: float | None
    tone_map: str | None
    steering: Steering | None = None
    paths: PathArguments | None = None

    def refuse_for_image(self, name: str, layers: tuple[str, ...]) -> None:
        """Check that no option for scenes was given for an ``@image``.

        Raises:
            UsageError: One was given.
        """
        given = {
            "--slice": self.plane,
            "--transparent": self.transparent or None,
            "--exposure": self.exposure,
            "--tone-map": self.tone_map,
            "--steering": self.steering,
            "--mode": None if self.paths is None else self.paths.mode,
            "--layers": layers or None,
        }
        for option, value in given.items():
            if value is not None:
                raise UsageError(f"{option} is for scenes and shapes; '{name}' is an @image")


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
    size: SizeOption = "640x480",
    at: TimeOption = "0",
    assignments: SetOption = None,
    samples: SamplesOption = None,
    mode: ModeOption = None,
    time_limit: Annotated[
        float | None,
        typer.Option(metavar="S", help="In mode path: begin no more samples after S seconds."),
    ] = None,
    noise: Annotated[
        float | None,
        typer.Option(metavar="E", help="In mode path: stop when the estimated error is below E."),
    ] = None,
    filter: Annotated[
        str | None,
        typer.Option(
            help="In mode path: the reconstruction filter: tent, box, gaussian, blackman-harris or "
            "mitchell.",
            show_default="tent",
        ),
    ] = None,
    shutter: Annotated[
        float | None,
        typer.Option(metavar="S", help="In mode path: the shutter is open for S seconds."),
    ] = None,
    clamp: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            help="In mode path: no sample is brighter than X (1 is white). Removes single bright "
            "pixels, and some light.",
        ),
    ] = None,
    denoise: Annotated[
        bool,
        typer.Option("--denoise", help="In mode path: remove the noise that is left."),
    ] = False,
    goes_on: Annotated[
        bool,
        typer.Option(
            "--continue",
            help="In mode path: use the samples of a run that was broken off, and keep them.",
        ),
    ] = False,
    caustics: CausticsOption = True,
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
    look: LookOption = None,
    steering: SteeringOption = None,
    bits: Annotated[
        int | None,
        typer.Option(help="Of each channel: 8 or 16 of a PNG; 8 of a JPEG; 16 or 32 of an EXR."),
    ] = None,
    layers: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="What an EXR holds besides color: depth,normal,albedo,material, in mode path also "
            "samples,variance; or none; all without it.",
            show_default=False,
        ),
    ] = None,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    threads: ThreadsOption = None,
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
    from distal.lang.render_options import LARGEST_SIDE_PX, RenderOptions
    from distal.scene.viewing.viewable import viewable

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    output = output or picture_beside(scene)
    suffix, _ = check_savable(output, bits)
    if transparent and suffix == ".jpg":
        raise UsageError("a JPEG has no transparency: -o FILE.png")
    film = name_beside(output, ".film")
    progress = picture_progress(shown_progress)
    preview = PreviewFile(output, bits, film, progress)
    paths = PathArguments(
        mode, time_limit, noise, filter, shutter, clamp, denoise, film, goes_on, preview, caustics
    )
    moved = None if steering is None else read_steering(steering)
    arguments = replace(
        read_view(view, plane, transparent, exposure, tone_map), paths=paths, steering=moved
    )
    device_name = chosen_device(device, adapter)
    begin = time.perf_counter()
    progress.stage(LOADING)
    obj, values = load_picture(scene, assignments)
    progress.stage(COMPILING)
    seen = viewable(obj, values, seconds, look)
    wanted = read_layers(layers, suffix, seen, arguments)
    check_shown(seen, arguments, wanted)
    loaded = time.perf_counter()
    with cluster_of(cluster, device_name, task_timeout) as pool, progress, preview:
        options = RenderOptions(
            size=width_height,
            time=seconds,
            params=values,
            device=device_name,
            threads=threads,
            samples=samples,
            progress=progress,
            cluster=pool,
        )
        picture = rendered_picture(seen, arguments, wanted, options)
    rendered = time.perf_counter()
    picture.save(output, bits)
    if picture.provenance.mode == "path":
        paths.forget()
    figures = {
        "load_s": loaded - begin,
        **dict.fromkeys(("compile_s", "render_s", "cache_hit", "lanes", "threads")),
        "device": device_name,
        **picture.stats,
        "save_s": time.perf_counter() - rendered,
        "size": list(width_height),
    }
    if stats:
        progress.answer(json.dumps(figures))
    else:
        say(f"{output}: {picture.width}x{picture.height}; {stages(figures)}")
        if picture.stats.get("noise") is not None:
            say(described(picture.stats))
        if clamp is not None:
            say(f"samples brighter than {clamp:g} were scaled to it: the picture is biased")


def read_view(
    view: str | None,
    plane: str | None,
    transparent: bool,
    exposure: float | None,
    tone_map: str | None,
) -> ViewArguments:
    """Parse and check the options of a view.

    Args:
        view: The name of the view; None for the default.
        plane: AXIS=OFFSET for the view "slice".
        transparent: Whether alpha is 0 where a ray hits nothing.
        exposure: Factor on all light.
        tone_map: The name of a tone map.

    Raises:
        UsageError: The options are not valid together, or a value is invalid.
    """
    from distal.render.tonemap import NAMES

    if plane is not None and view not in (None, "slice"):
        raise UsageError(f"--slice is the plane of the view 'slice', not of '{view}'")
    if tone_map is not None and tone_map not in NAMES:
        raise UsageError(f"there is no tone map '{tone_map:.40}'; tone maps: {', '.join(NAMES)}")
    if exposure is not None and not exposure < 1e9:
        raise UsageError(f"an exposure is finite, not {exposure}")
    seen = view or ("color" if plane is None else "slice")
    wanted = None if plane is None else read_plane(plane)
    return ViewArguments(seen, wanted, transparent, exposure, tone_map)


def read_layers(
    given: str | None, suffix: str, seen: Viewable, arguments: ViewArguments
) -> tuple[str, ...]:
    """Return the layers to store in a file: the given ones, or the default for the suffix.

    Args:
        given: Names separated by commas, or "none"; None for the default.
        suffix: The suffix of the file.
        seen: The object to render.
        arguments: The options of the view.

    Raises:
        UsageError: The file cannot hold layers, or there is no such layer.
    """
    from distal.scene.lowering.layers import NAMES, OF_SAMPLES, checked_layers

    if given is None:
        if suffix != ".exr" or arguments.view != "color" or seen.scene is None:
            return ()
        mode = arguments.paths.mode if arguments.paths is not None else None
        by_paths = (mode or seen.scene.mode) == "path"
        return tuple(name for name in NAMES if by_paths or name not in OF_SAMPLES)
    if given == "none":
        return ()
    if suffix != ".exr":
        raise UsageError(f"layers are for an .exr, not for a {suffix}")
    try:
        return checked_layers(name.strip() for name in given.split(","))
    except ValueError as error:
        raise UsageError(str(error)) from None


def check_shown(seen: Viewable, arguments: ViewArguments, layers: tuple[str, ...]) -> None:
    """Check that the object supports the view and its options.

    Args:
        seen: The object to render.
        arguments: The options of the view.
        layers: The layers to store.

    Raises:
        UsageError: It is an ``@image``, which lacks such an option, or there is no such view.
    """
    if seen.scene is None:
        arguments.refuse_for_image(seen.name, layers)
    check_view(seen, arguments.view)


def rendered_picture(
    seen: Viewable, arguments: ViewArguments, layers: tuple[str, ...], options: RenderOptions
) -> Picture:
    """Render the picture with the given options of the view.

    Args:
        seen: The object to render.
        arguments: The options of the view.
        layers: The layers to store.
        options: The other options.
    """
    from distal.scene.rendering import render_scene
    from distal.scene.view_options import refinement_of

    if seen.scene is None:
        return seen.render(replace(options, view=arguments.view))
    scene = seen.scene.developed(exposure=arguments.exposure, tone_map=arguments.tone_map)
    paths = arguments.paths
    try:
        options = replace(
            options,
            view=arguments.view,
            transparent=arguments.transparent,
            layers=layers,
            steering=arguments.steering,
            **({} if paths is None else paths.options(scene.mode)),
        )
        refinement = refinement_of(options, scene.mode)
    except ValueError as error:
        raise UsageError(str(error)) from None
    if arguments.plane is not None:
        options = replace(options, plane=arguments.plane)
    if paths is not None and refinement is not None:
        paths.forget()
    return render_scene(scene, options)
