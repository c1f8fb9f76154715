"""The picture's file while ``distal render`` works: the samples so far.

Input: pictures with few samples, then more. Output: the file, replaced in one step each time; after
an interruption, lines that say what there is and how to go on.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from distal.cli.messages import say

if TYPE_CHECKING:
    from distal.cli.progress_lines import PictureLines
    from distal.cli.report import ProgressBar
    from distal.images.picture import Picture


class PreviewFile:
    """Saves the picture so far, and says so if the work is broken off.

    Args:
        output: The picture's file.
        bits: Bits of a channel; None for the default.
        film: The file that keeps the samples.
        progress: The progress, which shows the figures.
    """

    def __init__(
        self, output: Path, bits: int | None, film: Path, progress: ProgressBar | PictureLines
    ) -> None:
        self._output, self._bits, self._film, self._progress = output, bits, film, progress
        self._shown: Mapping[str, Any] | None = None

    def __call__(self, picture: Picture) -> None:
        """Save the picture so far."""
        picture.save(self._output, self._bits)
        self._shown = picture.stats
        self._progress.describe(described(picture.stats))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if isinstance(error, KeyboardInterrupt) and self._shown is not None:
            say(f"{self._output}: broken off after {described(self._shown)}")
            say(f"{self._film} keeps them; go on with: {continued(sys.argv)}")


def described(figures: Mapping[str, Any]) -> str:
    """Return a text like "48 samples, error 0.012" of a picture's statistics."""
    count = figures["samples"]
    text = "1 sample" if count == 1 else f"{round(count, 1):g} samples"
    return text if figures["noise"] is None else f"{text}, error {figures['noise']:.2g}"


def continued(command: list[str]) -> str:
    """Return the command line that goes on where this one was broken off."""
    arguments = [argument for argument in command[1:] if argument != "--continue"]
    return shlex.join(["distal", *arguments, "--continue"])
