"""``distal export``: write a scene as a page or as a shader.

Input: parsed arguments. Output: a file, and a line that describes it. This module only checks which
options are valid together.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from distal.backends import TEXT_TARGETS
from distal.cli.arguments import UsageError, check_is_not_scene, check_lengths, read_size, read_time
from distal.cli.base import (
    CausticsOption,
    LookOption,
    ModeOption,
    SceneArgument,
    SetOption,
    TimeOption,
    application,
    check_view,
    load_picture,
    reporting,
)
from distal.cli.messages import say
from distal.cli.surroundings import check_processor

_SUFFIXES = [f"{t.suffix} {t.place.partition(',')[0]}" for t in TEXT_TARGETS.values() if t.suffix]


@application.command()
@reporting
def export(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help=f"The file: .html a page, {', '.join(_SUFFIXES)}.",
            show_default=False,
        ),
    ],
    target: Annotated[
        str | None,
        typer.Option(
            help="What to write, where the suffix does not say it: "
            f"{', '.join(('html', *TEXT_TARGETS))}.",
            show_default=False,
        ),
    ] = None,
    assignments: SetOption = None,
    at: TimeOption = "0",
    view: Annotated[
        str | None, typer.Option(help="What is shown first; color without it.", show_default=False)
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(
            metavar="WxH", help="Of a page: the picture's width and height.", show_default=False
        ),
    ] = None,
    duration: Annotated[
        str | None,
        typer.Option(
            metavar="S", help="Of a page: when the time starts again.", show_default=False
        ),
    ] = None,
    look: LookOption = None,
    mode: ModeOption = None,
    caustics: CausticsOption = True,
    title: Annotated[
        str | None, typer.Option(help="Of a page: what it is called.", show_default=False)
    ] = None,
    views: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME",
            help="Of a page: the views to include; all without it.",
            show_default=False,
        ),
    ] = None,
    embed: Annotated[
        bool, typer.Option("--embed", help="A fragment for other pages: the canvas alone.")
    ] = False,
    no_panel: Annotated[bool, typer.Option("--no-panel", help="A page without controls.")] = False,
    poster: Annotated[
        str | None,
        typer.Option(
            help="Of a page: the still picture before the first frame: webp, triangles (smaller, "
            "sharp at any size, needs WebGL 2) or none.",
            show_default="webp",
        ),
    ] = None,
    no_poster: Annotated[
        bool, typer.Option("--no-poster", help="A page without a still picture: --poster none.")
    ] = False,
    printable: Annotated[
        bool, typer.Option("--printable", help="A page that saves the part as 3MF and STL.")
    ] = False,
    inspect: Annotated[
        bool,
        typer.Option("--inspect", help="A page that cuts the scene open and measures distances."),
    ] = False,
    unit: Annotated[
        str | None,
        typer.Option(
            help="Of these two pages: the length of one scene unit: um, mm, cm, m, inch or ft.",
            show_default="mm",
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="LENGTH",
            help="Of a printable page: how far the part may be from the surface, in scene units.",
            show_default="0.002 of the largest side",
        ),
    ] = None,
) -> None:
    """Write a scene as a page that shows it, or as a shader for another program."""
    flags: dict[str, tuple[str, Any]] = {
        "--size": ("size", _size(size)),
        "--duration": ("duration", _duration(duration)),
        "--mode": ("mode", mode),
        "--no-caustics": ("caustics", None if caustics else False),
        "--title": ("title", title),
        "--views": ("views", None if views is None else _views(views)),
        "--embed": ("embed", embed or None),
        "--no-panel": ("panel", False if no_panel else None),
        "--poster": ("poster", poster),
        "--no-poster": ("poster", False if no_poster else None),
        "--printable": ("printable", printable or None),
        "--inspect": ("inspect", inspect or None),
        "--unit": ("unit", unit),
        "--tolerance": ("tolerance", tolerance),
    }
    given = {flag: entry for flag, entry in flags.items() if entry[1] is not None}
    # The names in ``flags`` are fields of PageOptions, which checks the values.
    options = {"view": view or "color", "time": read_time(at), **dict(given.values())}
    if poster is not None:
        _check_poster(poster, is_left_out=no_poster)
    if scene.endswith(".md"):
        return _write_lesson(scene, output, target, [*given, *(["--set"] if assignments else [])])
    flags_of = {flag: name for flag, (name, _) in given.items()}
    _check(scene, output, target, flags_of, is_without_poster=no_poster or poster == "none")
    for flag in ("--printable", "--inspect"):
        if flag in given:
            _check_panel(flag, list(given))
    if unit is not None and not (printable or inspect):
        raise UsageError("--unit is for --printable and --inspect")
    if printable:
        check_lengths(tolerance=tolerance)
    elif tolerance is not None:
        raise UsageError("--tolerance is for --printable")
    _write(scene, output, target, assignments or [], look, options)


def _check_poster(poster: str, *, is_left_out: bool) -> None:
    """Check the kind of a page's poster.

    Raises:
        UsageError: There is none, or it is left out.
    """
    from distal.export.page_options import NO_POSTER, POSTERS

    if poster not in POSTERS:
        raise UsageError(f"--poster is one of {', '.join(POSTERS)}, not '{poster:.40}'")
    if is_left_out and poster != NO_POSTER:
        raise UsageError(f"--poster {poster} and --no-poster exclude each other")


def _check(
    scene: str,
    output: Path,
    target: str | None,
    given: Mapping[str, str],
    *,
    is_without_poster: bool,
) -> None:
    """Check that the options are valid together, before time is spent on the work.

    Args:
        scene: The scene's file.
        output: The file to write.
        target: The output format if the suffix does not determine it.
        given: The flags for pages that were given, and the names of their options.
        is_without_poster: Whether no picture is rendered.

    Raises:
        UsageError: They are not.
    """
    from distal.export.registry import FORMATS, kind_of
    from distal.file_writer import check_destination

    try:
        name = kind_of(output, target)
    except ValueError as error:
        raise UsageError(str(error)) from None
    for flag, option in given.items():
        if option not in FORMATS[name].option_names:
            raise UsageError(f"{flag} is for pages, and {output} is a text ({name})")
    check_is_not_scene(output, scene)
    check_destination(output)
    if name == "html" and not is_without_poster:
        check_processor()


def _check_panel(wanted: str, given: list[str]) -> None:
    """Check that a page has the panel that the buttons of an option stand in.

    Raises:
        UsageError: It has none.
    """
    for flag in ("--embed", "--no-panel"):
        if flag in given:
            raise UsageError(f"{wanted} has its buttons in the panel, which {flag} leaves out")


def _write_lesson(scene: str, output: Path, target: str | None, given: list[str]) -> None:
    """Write the page of a lesson, whose file says everything else."""
    from distal.file_writer import check_destination
    from distal.lessons.page import write

    if target not in (None, "html") or output.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"a lesson is written as a page: -o {output.with_suffix('.html').name}")
    if given:
        raise UsageError(f"{given[0]} is for scenes; a lesson's file has its own settings")
    check_destination(output)
    check_processor()
    made = write(scene, output)
    for view, reason in made.omitted.items():
        say(f"warning: the view '{view}' is left out: {reason}")
    say(made)


def _write(
    scene: str,
    output: Path,
    target: str | None,
    assignments: list[str],
    look: str | None,
    options: dict[str, Any],
) -> None:
    from distal.export.registry import export as write
    from distal.scene.viewing.viewable import viewable

    obj, values = load_picture(scene, assignments)
    if options.get("printable"):
        from distal.export.printing import check_solid

        check_solid(obj)
    try:
        seen = viewable(obj, values, options["time"], look).in_mode(
            options.get("mode"), caustics=options.get("caustics")
        )
    except ValueError as error:
        raise UsageError(str(error)) from None
    if seen.mode != "path" and options.get("caustics") is False:
        raise UsageError("--no-caustics is for --mode path")
    for name in (options["view"], *(options.get("views") or ())):
        check_view(seen, name)
    options["params"] = values
    made = write(seen, output, target, options)
    for view, reason in made.omitted.items():
        say(f"warning: the view '{view}' is left out: {reason}")
    for part in made.unprinted:
        say(f"{part} has no end and is left out of the saved part")
    say(made)


def _size(text: str | None) -> tuple[int, int] | None:
    from distal.lang.render_options import LARGEST_SIDE_PX

    return None if text is None else read_size(text, LARGEST_SIDE_PX)


def _duration(text: str | None) -> float | None:
    if text is None:
        return None
    seconds = read_time(text)
    if seconds <= 0.0:
        raise UsageError(f"a duration is more than 0 seconds, not {text}")
    return seconds


def _views(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise UsageError(f"--views takes names with commas between, not '{text:.60}'")
    return names
