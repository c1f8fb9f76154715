"""``distal view``: show a scene live in a native window and reload it when its file changes.

Input: parsed arguments. Output: a window, and an exit code when it is closed.
"""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from distal.cli.arguments import UsageError, read_scene, read_size
from distal.cli.base import (
    AdapterOption,
    Device,
    DeviceOption,
    LookOption,
    SceneArgument,
    SetOption,
    SizeOption,
    UnitOption,
    application,
    chosen_device,
    load_picture,
    reporting,
)
from distal.cli.options import NOTHING_ASKED, Asked, request_of, requesting
from distal.lang.units import meters_of


@application.command()
@reporting
@requesting("window")
def view(
    scene: SceneArgument,
    size: SizeOption = "800x600",
    device: DeviceOption = Device.AUTO,
    adapter: AdapterOption = None,
    assignments: SetOption = None,
    asked: Asked = NOTHING_ASKED,
    scale: Annotated[
        float,
        typer.Option(min=0.05, max=4.0, help="Rendered pixels for each of the window's, a side."),
    ] = 1.0,
    paused: Annotated[bool, typer.Option("--paused", help="Begin with the time paused.")] = False,
    look: LookOption = None,
    unit: UnitOption = "mm",
) -> None:
    """Show a scene in a window, and reload it whenever its file is saved. H shows the keys."""
    from distal.window.opening import view as show
    from distal.window.screen import LARGEST_SIDE, check_display

    meters_of(unit, UsageError)
    width_height = read_size(size, LARGEST_SIDE)
    check_display()
    path, name = read_scene(scene)
    obj, values = load_picture(scene, assignments)
    options = request_of(
        asked, size=width_height, params=values, device=chosen_device(device, adapter)
    )
    try:
        code, ended = show(
            obj, path, name, options, scale=scale, paused=paused, look=look, unit=unit
        )
    except ValueError as error:
        raise UsageError(str(error)) from None
    if not ended:
        # A compiler is still running in a thread that cannot be stopped; it could crash during a
        # normal shutdown of Python.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    raise typer.Exit(code)
