"""Map messages of drivers and validators about emitted text to the author's lines.

Input: an artifact, and a compiler's message about its text. Output: the same message with each
place in the text replaced by the author's file and line, if known. Depends on how the compilers
write a place, but not on the rest of their messages.
"""

from __future__ import annotations

import re

from distal.backends.base import Artifact

_PLACES = re.compile(
    r"""
    (?P<khronos>\b(?P<severity>ERROR|WARNING):\ \d+:(?P<line1>\d+)(?=:))   # glslang, ANGLE
    | (?P<mesa>\b\d+:(?P<line2>\d+)\(\d+\)(?=:))
    | (?P<nvidia>\b\d+\((?P<line3>\d+)\)(?=\s:))
    | (?P<naga>\bwgsl:(?P<line4>\d+):\d+)
    | (?P<tint>(?<![\w.]):(?P<line5>\d+):\d+(?=\s(?:error|warning|note)))
    """,
    re.VERBOSE,
)


def map_message(artifact: Artifact, message: str, *, vertex: bool = False) -> str:
    """Return ``message`` with places in the artifact's text replaced by the author's places.

    Args:
        artifact: The artifact that was compiled.
        message: The message of the driver or validator.
        vertex: Whether the message is about ``artifact.vertex``.
    """
    lines = artifact.vertex_lines if vertex else artifact.lines

    def author(match: re.Match[str]) -> str:
        number = next(int(n) for n in match.groups() if n is not None and n.isdigit())
        found = lines[number - 1] if 1 <= number <= len(lines) else None
        if found is None:
            return match[0]
        severity = match["severity"]
        place = f"{found[0]}:{found[1]}"
        return f"{severity}: {place}" if severity else place

    return _PLACES.sub(author, message)
