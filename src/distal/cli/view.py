"""``distal view``: show a scene live in a native window and reload it when its file changes.

Input: parsed arguments. Output: a window, and an exit code when it is closed.
"""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from distal.cli.arguments import UsageError, read_scene, read_size, read_time
from distal.cli.base import (
    AdapterOption,
    CausticsOption,
    Device,
    DeviceOption,
    LookOption,
    ModeOption,
    SceneArgument,
    SetOption,
    SizeOption,
    TimeOption,
    UnitOption,
    application,
    chosen_device,
    load_picture,
    reporting,
)
from distal.lang.units import meters_of


@application.command()
@reporting
def view(
    scene: SceneArgument,
    size: SizeOption = "800x600",
    device: DeviceOption = Device.AUTO,
    adapter: AdapterOption = None,
    assignments: SetOption = None,
    at: TimeOption = "0",
    first_view: Annotated[
        str, typer.Option("--view", help="The first view; V shows the others.")
    ] = "color",
    scale: Annotated[
        float,
        typer.Option(min=0.05, max=4.0, help="Rendered pixels for each of the window's, a side."),
    ] = 1.0,
    paused: Annotated[bool, typer.Option("--paused", help="Begin with the time paused.")] = False,
    look: LookOption = None,
    mode: ModeOption = None,
    caustics: CausticsOption = True,
    unit: UnitOption = "mm",
) -> None:
    """Show a scene in a window, and reload it whenever its file is saved. H shows the keys."""
    from distal.lang.render_options import RenderOptions
    from distal.window.opening import view as show
    from distal.window.screen import LARGEST_SIDE, check_display

    meters_of(unit, UsageError)
    width_height, seconds = read_size(size, LARGEST_SIDE), read_time(at)
    check_display()
    path, name = read_scene(scene)
    obj, values = load_picture(scene, assignments)
    try:
        options = RenderOptions(
            size=width_height,
            time=seconds,
            params=values,
            device=chosen_device(device, adapter),
        )
        code, ended = show(
            obj,
            path,
            name,
            options,
            first_view=first_view,
            scale=scale,
            paused=paused,
            look=look,
            mode=mode,
            caustics=caustics,
            unit=unit,
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
