"""``distal rerender``: render a saved picture again, using the metadata in its file.

Input: parsed arguments. Output: a picture file, or the difference of the two pictures.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from distal.cli.arguments import UsageError, read_size
from distal.cli.base import (
    AdapterOption,
    Device,
    ThreadsOption,
    answer,
    application,
    chosen_device,
    reporting,
)
from distal.cli.exit_codes import ExitCode
from distal.cli.surroundings import check_processor
from distal.diagnostics import printable_lines

if TYPE_CHECKING:
    from distal.scene.rerender import Difference


@application.command()
@reporting
def rerender(
    picture: Annotated[
        Path,
        typer.Argument(metavar="PICTURE", help="A PNG or EXR by distal.", show_default=False),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="The new file; without it PICTURE.rerendered.png in the same folder.",
            show_default=False,
        ),
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", metavar="WxH", help="Another size.", show_default=False)
    ] = None,
    samples: Annotated[
        int | None, typer.Option(min=1, max=65536, help="Another number of samples in each pixel.")
    ] = None,
    bits: Annotated[
        int | None, typer.Option(help="Of each channel; as it was without.", show_default=False)
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(metavar="FILE[:NAME]", help="The scene, where it is now.", show_default=False),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Render a scene that has changed as it is now.")
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Show how the two differ; exit code 1 if they do. No file without -o."
        ),
    ] = False,
    device: Annotated[
        Device | None,
        typer.Option("--device", help="What renders; what did then without.", show_default=False),
    ] = None,
    adapter: AdapterOption = None,
    threads: ThreadsOption = None,
) -> None:
    """Render a saved picture again, using the metadata in its file."""
    from distal.cli.messages import say
    from distal.cli.report import ProgressBar
    from distal.images.metadata import ReadError
    from distal.images.picture import check_savable
    from distal.lang.render_options import LARGEST_SIDE_PX
    from distal.scene import rerender as library

    if check and (size is not None or samples is not None):
        raise UsageError("--check compares with the picture as it was: no --size, no --samples")
    if adapter is not None and device is None:
        raise UsageError("--adapter goes with --device")
    width_height = None if size is None else read_size(size, LARGEST_SIDE_PX)
    try:
        plan = library.plan_rerender(picture, source=source, force=force)
        target = output or (None if check else library.default_output(picture))
        if target is not None:
            bits = bits or _kept_bits(plan.record.format, plan.record.bits, target)
            check_savable(target, bits)
        if device is None and plan.record.provenance.device == Device.CPU:
            check_processor()
        chosen = None if device is None else chosen_device(device, adapter)
        for note in plan.notes:
            say(f"note: {note}")
        with ProgressBar() as progress:
            made = library.rerender(
                plan,
                size=width_height,
                samples=samples,
                device=chosen,
                threads=threads,
                progress=progress,
            )
        if target is not None:
            made.save(target, bits)
            say(f"{target}: {made.width}x{made.height}, {plan.source}")
        if check:
            found = library.difference(plan, made)
            answer(printable_lines(_difference_line(picture, found)))
            if not found.is_none:
                raise typer.Exit(ExitCode.FAILED)
    except (ReadError, library.RerenderError) as error:
        say(f"error: {error}")
        raise typer.Exit(ExitCode.FAILED) from None


def _kept_bits(kind: str, bits: int, target: Path) -> int | None:
    """Return the recorded bits if the new file has the same format, else None."""
    return bits if target.suffix.lower() == f".{kind}" else None


def _difference_line(picture: Path, found: Difference) -> str:
    if found.is_none:
        return f"{picture}: identical"
    largest, percent = found.largest, 100.0 * found.share
    return f"{picture}: {percent:.3g} % of the pixels differ, by up to {largest:.3g}"
