"""Pictures as colored triangles: chosen by error, packed, drawn by WebGL (decision 79).

``encode`` gives the bytes of a picture, ``decode`` the picture of the bytes; the script of pages is
``web/src/triangles/``.
"""

from distal.triangles.decoding import decode
from distal.triangles.encoding import encode
from distal.triangles.range_coder import CoderError

__all__ = ["CoderError", "decode", "encode"]
