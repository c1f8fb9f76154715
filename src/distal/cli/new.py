"""``distal new``: a first scene to change.

Input: the name of a file. Output: the file, and the commands to go on with. A file that exists is
never overwritten.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

import typer

from distal.cli.arguments import UsageError
from distal.cli.base import application, reporting
from distal.cli.messages import say
from distal.file_writer import ChangedError, SaveError, save

TEXT: Final = '''\
"""A ball on a box: change a number, save, and look again."""

from distal import Box, Scene, Sphere
from distal.lang import slider

radius = slider("Radius", 0.8, low=0.3, high=1.2)
soft = slider("Soft", 0.15, low=0.0, high=0.5, help="How softly the two are joined.")

ball = Sphere(radius).translate(y=0.9).paint("coral")
base = Box(2.0, 0.6, 2.0).round(0.1).paint("#e8e2d4")

scene = Scene(base.union(ball, smooth=soft), look="studio")
'''
_NEXT: Final = """\
{file}: a first scene. Go on with
  distal view {file}               a window that follows the file
  distal studio {file}             an editor in the browser
  distal {file}                    a picture
  distal mesh {file}:ball -o ball.3mf"""


@application.command()
@reporting
def new(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="The new file; .py is added if it is missing.")
    ] = Path("scene.py"),
) -> None:
    """Write a first scene to a new file."""
    if file.suffix not in ("", ".py"):
        raise UsageError(f"a scene is a Python file: {file.with_suffix('.py')}")
    file = file.with_suffix(".py")
    try:
        save(file, TEXT.encode(), expected=None)
    except ChangedError:
        raise SaveError(f"{file} is there already; give another name") from None
    say(_NEXT.format(file=file))
