"""Compress what a page or a link carries: deflate without a header, which browsers unpack."""

from __future__ import annotations

import base64
import zlib


def deflated(data: bytes) -> bytes:
    """Return bytes compressed."""
    press = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9)
    return press.compress(data) + press.flush()


def deflated_text(data: bytes) -> str:
    """Return bytes compressed, in base64."""
    return base64.b64encode(deflated(data)).decode("ascii")
