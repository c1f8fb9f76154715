"""``distal video``: render an animated scene as a video or as numbered pictures.

Input: parsed arguments. Output: the file, and one line about it. After an interruption, the line
says how to continue.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from distal.cli.arguments import UsageError, read_size, read_steering
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
    SetOption,
    SizeOption,
    SteeringOption,
    ThreadsOption,
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
    size: SizeOption = "640x480",
    start: Annotated[
        str, typer.Option("--start", "--time", metavar="S", help="When the first frame is.")
    ] = "0",
    samples: SamplesOption = None,
    mode: ModeOption = None,
    shutter: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="In mode path: the shutter is open for S seconds in each frame.",
            show_default=False,
        ),
    ] = None,
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
    view: Annotated[str, typer.Option(help="What to show, as in distal render.")] = "color",
    steering: SteeringOption = None,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    threads: ThreadsOption = None,
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
    from distal.lang.render_options import LARGEST_SIDE_PX
    from distal.video import video as record
    from distal.video.formats import QUALITY, VideoError, format_of

    width_height = read_size(size, LARGEST_SIDE_PX)
    format = format_of(output)
    if quality is not None and not format.lossy and quality != "lossless":
        raise UsageError(f"--quality is for mp4, webm and webp; {format.name} keeps what it can")
    device_name = chosen_device(device, adapter)
    moved = None if steering is None else read_steering(steering)
    bar = frame_progress(shown_progress)
    bar.stage(LOADING)
    obj, values = load_picture(scene, assignments)
    bar.stage(COMPILING)
    with cluster_of(cluster, device_name, task_timeout) as pool, bar:
        try:
            made = record(
                obj,
                output,
                duration=duration,
                fps=fps,
                size=width_height,
                start=start,
                params=values,
                view=view,
                steering=moved,
                samples=samples,
                mode=mode,
                shutter=shutter,
                loop=loop,
                quality=quality or QUALITY,
                device=device_name,
                threads=threads,
                keep_frames=keep_frames,
                fresh=fresh,
                progress=bar,
                tell=bar.say,
                cluster=pool,
            )
        except VideoError as error:
            raise UsageError(str(error)) from None
    say(str(made))
