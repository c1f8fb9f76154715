"""Share links: JSON, compressed by deflate, in the letters of base64url.

Input: what is shared. Output: the text after ``#c=``, and back. A browser does the same with
``CompressionStream("deflate-raw")``. Needs the standard library alone.
"""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any, Final

from distal.deflating import deflated

PREFIX: Final = "#c="
LONGEST: Final = 1_000_000  # characters of a link, and of the JSON in it


class LinkError(ValueError):
    """A text is not a share link."""


def link_of(shared: dict[str, Any]) -> str:
    """Return the fragment of a share link.

    Args:
        shared: JSON values: "files", "main"; if they are shared, too, "values", "camera", "time".
    """
    text = json.dumps(shared, separators=(",", ":"), ensure_ascii=False)
    packed = deflated(text.encode("utf-8", "surrogatepass"))
    return PREFIX + base64.urlsafe_b64encode(packed).decode("ascii").rstrip("=")


def shared_by(link: str) -> dict[str, Any]:
    """Return what a share link shares.

    Raises:
        LinkError: It is no share link, is broken, or is too long.
    """
    _, prefix, letters = link.partition(PREFIX)
    if not prefix or len(letters) > LONGEST:
        raise LinkError(f"a share link has {PREFIX} and at most {LONGEST:,} characters after it")
    try:
        packed = base64.b64decode(letters + "=" * (-len(letters) % 4), b"-_", validate=True)
        press = zlib.decompressobj(-zlib.MAX_WBITS)
        text = press.decompress(packed, LONGEST)
        if press.unconsumed_tail or not press.eof:
            raise LinkError("the share link is cut off, or what it shares is too long")
        found = json.loads(text.decode("utf-8", "surrogatepass"))
    except (ValueError, zlib.error, RecursionError) as error:
        if isinstance(error, LinkError):
            raise
        raise LinkError("the share link is broken: copy the whole of it") from None
    if not isinstance(found, dict):
        raise LinkError("the share link is broken: copy the whole of it")
    return found
