"""Sequences: a picture that moves, rendered frame by frame and written as one file or as many.

What flows in: anything that is a picture, and how long it is shown. What flows out: mp4, webm, gif,
apng, webp or numbered PNG files. Knows how frames lie in time and what is kept when work is broken
off; how files are encoded is ``film``'s matter.
"""

from __future__ import annotations

from distal.sequence.recording import Made, video

__all__ = ["Made", "video"]
