"""Video: a moving picture, rendered frame by frame and written as one file or as many.

Input: anything that can be viewed, and how long it is shown. Output: mp4, webm, gif, apng, webp or
numbered PNG files.
"""

from __future__ import annotations

from distal.video.recording import FinishedSequence, video

__all__ = ["FinishedSequence", "video"]
