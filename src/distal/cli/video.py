"""``distal video``: render an animated scene as a video or as numbered pictures.

Input: parsed arguments. Output: the file, and one line about it. After an interruption, the line
says how to continue.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from distal.cli.arguments import UsageError
from distal.cli.base import (
    AdapterOption,
    ClusterOption,
    Device,
    DeviceOption,
    ProgressKind,
    ProgressOption,
    SceneArgument,
    SetOption,
    TimeoutOption,
    application,
    chosen_device,
    cluster_of,
    load_picture,
    reporting,
)
from distal.cli.options import NOTHING_ASKED, Asked, request_of, requesting
from distal.lang.progress_lines import COMPILING, LOADING


@application.command()
@reporting
@requesting("video")
def video(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="Ends in .mp4, .webm, .gif, .apng or .webp; or like frames/%05d.png.",
            show_default=False,
        ),
    ],
    duration: Annotated[
        str,
        typer.Option(metavar="S", help="Seconds; the period of what loops.", show_default=False),
    ],
    fps: Annotated[
        str, typer.Option(metavar="N", help="Frames a second: 30, 29.97, 30000/1001.")
    ] = "30",
    start: Annotated[
        str, typer.Option("--start", "--time", metavar="S", help="When the first frame is.")
    ] = "0",
    asked: Asked = NOTHING_ASKED,
    loop: Annotated[
        bool,
        typer.Option("--loop", help="Repeat gif, apng and webp without end; say if it jumps."),
    ] = False,
    quality: Annotated[
        str | None,
        typer.Option(
            help="low, medium, high, lossless, or 0 to 100; of mp4, webm and webp.",
            show_default="high",
        ),
    ] = None,
    assignments: SetOption = None,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    cluster: ClusterOption = None,
    task_timeout: TimeoutOption = 600.0,
    keep_frames: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write every frame there as PNG besides."),
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Render all frames again after an interrupted run.")
    ] = False,
    shown_progress: ProgressOption = ProgressKind.BAR,
) -> None:
    """Render an animated scene to a video or to numbered pictures."""
    from distal.cli.messages import say
    from distal.cli.report import frame_progress
    from distal.video.formats import QUALITY, VideoError, format_of
    from distal.video.recording import record

    format = format_of(output)
    if quality is not None and not format.lossy and quality != "lossless":
        raise UsageError(f"--quality is for mp4, webm and webp; {format.name} keeps what it can")
    device_name = chosen_device(device, adapter)
    bar = frame_progress(shown_progress)
    bar.stage(LOADING)
    obj, values = load_picture(scene, assignments)
    bar.stage(COMPILING)
    with cluster_of(cluster, device_name, task_timeout) as pool, bar:
        options = request_of(asked, params=values, device=device_name, cluster=pool)
        try:
            made = record(
                obj,
                output,
                options,
                duration=duration,
                fps=fps,
                start=start,
                loop=loop,
                quality=quality or QUALITY,
                keep_frames=keep_frames,
                fresh=fresh,
                progress=bar,
                tell=bar.say,
            )
        except VideoError as error:
            raise UsageError(str(error)) from None
    say(str(made))
