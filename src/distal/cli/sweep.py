"""``distal sweep``: render a scene for all combinations of some values.

Input: parsed arguments. Output: a sheet or a folder of pictures, a table, and one line about it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from distal.cli.arguments import UsageError, read_size, read_time
from distal.cli.base import (
    AdapterOption,
    ClusterOption,
    Device,
    DeviceOption,
    ModeOption,
    ProgressKind,
    ProgressOption,
    SamplesOption,
    SceneArgument,
    ThreadsOption,
    TimeOption,
    TimeoutOption,
    application,
    chosen_device,
    cluster_of,
    load_picture,
    reporting,
)
from distal.lang.progress_lines import COMPILING, LOADING


@application.command()
@reporting
def sweep(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="A .png for a sheet of all pictures, or a folder for numbered pictures.",
            show_default=False,
        ),
    ],
    assignments: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="NAME=VALUES",
            help="NAME=FIRST:LAST:COUNT or NAME=A,B,C; of colors and points NAME=A;B. Also time.",
            show_default=False,
        ),
    ],
    size: Annotated[
        str, typer.Option("--size", metavar="WxH", help="Of each picture, in pixels.")
    ] = "160x120",
    at: TimeOption = "0",
    samples: SamplesOption = None,
    mode: ModeOption = None,
    view: Annotated[str, typer.Option(help="What to show, as in distal render.")] = "color",
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    threads: ThreadsOption = None,
    cluster: ClusterOption = None,
    task_timeout: TimeoutOption = 600.0,
    measure: Annotated[
        bool,
        typer.Option("--measure", help="Add volume, area, box and thinnest wall to the table."),
    ] = False,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Render also what an earlier sweep left in the folder.")
    ] = False,
    shown_progress: ProgressOption = ProgressKind.BAR,
) -> None:
    """Render a scene for all combinations of some values of its parameters."""
    from distal.cli.messages import say
    from distal.cli.report import frame_progress
    from distal.lang.render_options import LARGEST_SIDE_PX
    from distal.sweeps import sweep as run

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    device_name = chosen_device(device, adapter)
    values: dict[str, str] = {}
    for text in assignments:
        name, equals, given = text.partition("=")
        if not equals:
            raise UsageError(f"--set takes NAME=VALUES, not '{text:.60}'")
        if name.strip() in values:
            raise UsageError(f"--set gives '{name.strip()}' twice: NAME=0.2,0.4 has both values")
        values[name.strip()] = given
    bar = frame_progress(shown_progress)
    bar.stage(LOADING)
    obj, _ = load_picture(scene, None)
    bar.stage(COMPILING)
    with cluster_of(cluster, device_name, task_timeout) as pool, bar:
        try:
            made = run(
                obj,
                values,
                output,
                size=width_height,
                time=seconds,
                samples=samples,
                mode=mode,
                view=view,
                device=device_name,
                threads=threads,
                cluster=pool,
                measure=measure,
                fresh=fresh,
                progress=bar,
            )
        except ValueError as error:
            raise UsageError(str(error)) from None
    say(str(made))
