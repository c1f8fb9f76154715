"""A page's text as a host has it that trusts its driver with some built-ins.

Input: an artifact of glsl-es300 and names of built-ins. Output: the artifact with
their macros defined. Nothing here is the player's.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from distal.backends.base import Artifact


def trusting(artifact: Artifact, names: Iterable[str]) -> Artifact:
    """Its macros right after the version; the lines that the author can mend move along."""
    macros = [artifact.interface["trust"][name] for name in names]
    head, rest = artifact.text.split("\n", 1)
    text = "\n".join([head, *(f"#define {macro}" for macro in macros), rest])
    lines = (artifact.lines[0], *(None for _ in macros), *artifact.lines[1:])
    return replace(artifact, text=text, lines=lines)
