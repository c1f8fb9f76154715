"""Video: render an animated picture frame by frame and write it as one file or as many.

Input: a viewable object and a duration. Output: mp4, webm, gif, apng, webp or numbered PNG files.
"""

from __future__ import annotations

from distal.lang.presentable import Presentable
from distal.video.recording import FinishedSequence

video = Presentable.video

__all__ = ["FinishedSequence", "video"]
