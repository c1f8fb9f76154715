"""Outlines of flat shapes: SVG and DXF; millimeters.

Input: closed polylines, y up, in millimeters. Output: text.

Source: Scalable Vector Graphics 1.1, W3C; DXF Reference, release 12, Autodesk.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray


def write_svg(file: BinaryIO, polylines: Sequence[NDArray[np.float64]]) -> None:
    """Write one path in real size; a polyline inside another one is a hole (even-odd rule)."""
    joined = np.concatenate(polylines)
    low, high = joined.min(axis=0), joined.max(axis=0)
    width, height = (high - low).tolist()
    # SVG's y axis points down.
    paths = (np.stack([line[:, 0] - low[0], high[1] - line[:, 1]], axis=1) for line in polylines)
    data = " ".join(_path(line) for line in paths)
    file.write(
        (
            '<svg xmlns="http://www.w3.org/2000/svg" '
            f'width="{width:.9g}mm" height="{height:.9g}mm" '
            f'viewBox="0 0 {width:.9g} {height:.9g}">\n'
            f'<path fill-rule="evenodd" d="{data}"/>\n</svg>\n'
        ).encode()
    )


def write_dxf(file: BinaryIO, polylines: Sequence[NDArray[np.float64]]) -> None:
    """Write closed polylines of DXF release 12, which all CAD programs read."""
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER")]
    pairs += [(1, "AC1009"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC")]
    pairs += [(0, "SECTION"), (2, "ENTITIES")]
    for line in polylines:
        pairs += [(0, "POLYLINE"), (8, "0"), (66, 1), (70, 1), (10, 0.0), (20, 0.0), (30, 0.0)]
        for x, y in line.tolist():
            pairs += [(0, "VERTEX"), (8, "0"), (10, x), (20, y), (30, 0.0)]
        pairs += [(0, "SEQEND"), (8, "0")]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    file.write("".join(f"{code}\n{_value(value)}\n" for code, value in pairs).encode())


def _path(line: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{x:.9g} {y:.9g}" for x, y in line.tolist()) + "Z"


def _value(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)
