"""Outlines of flat shapes: SVG and DXF; millimeters.

Input: closed polylines, y up, in millimeters. Output: text.

Source: Scalable Vector Graphics 1.1, W3C; DXF Reference, release 12, Autodesk.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

# The lowest and the highest corner of a drawing.
Frame: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]
# The height of a layer, and its polylines.
FileLayer: TypeAlias = tuple[float, Sequence[NDArray[np.float64]]]


def write_svg(
    file: BinaryIO, polylines: Sequence[NDArray[np.float64]], frame: Frame | None = None
) -> None:
    """Write one path in real size; a polyline inside another one is a hole (even-odd rule).

    Args:
        file: The file.
        polylines: The polylines.
        frame: The corners of the drawing; None for those of the polylines.
    """
    low, high = frame_of(polylines) if frame is None else frame
    lines = f"{_svg_path(polylines, low, high)}\n"
    file.write((_svg_head(low, high) + lines + "</svg>\n").encode())


def write_svg_layers(file: BinaryIO, layers: Sequence[FileLayer]) -> None:
    """Write one group for each layer, from below; slicers read its height.

    Args:
        file: The file.
        layers: The height of each layer and its polylines.
    """
    low, high = frame_of([line for _, polylines in layers for line in polylines])
    file.write(_svg_head(low, high).encode())
    for number, (height, polylines) in enumerate(layers, 1):
        file.write(f'<g id="{layer_name(number)}" data-height="{height:.9g}">'.encode())
        file.write(f"{_svg_path(polylines, low, high)}</g>\n".encode())
    file.write(b"</svg>\n")


def write_dxf(
    file: BinaryIO, polylines: Sequence[NDArray[np.float64]], frame: Frame | None = None
) -> None:
    """Write closed polylines of DXF release 12, which all CAD programs read.

    Args:
        file: The file.
        polylines: The polylines.
        frame: Not used: places in DXF are those of the shape.
    """
    _write_dxf(file, [("0", 0.0, polylines)])


def write_dxf_layers(file: BinaryIO, layers: Sequence[FileLayer]) -> None:
    """Write the polylines of each layer on a layer of the drawing, at their height.

    Args:
        file: The file.
        layers: The height of each layer and its polylines.
    """
    _write_dxf(file, [(layer_name(n), *layer) for n, layer in enumerate(layers, 1)])


def layer_name(number: int) -> str:
    """Return the name of a layer, counted from 1: in drawings, and of files."""
    return f"layer-{number:04d}"


def frame_of(polylines: Sequence[NDArray[np.float64]]) -> Frame:
    """Return the corners of the box around polylines."""
    joined = np.concatenate(polylines)
    return joined.min(axis=0), joined.max(axis=0)


def _svg_head(low: NDArray[np.float64], high: NDArray[np.float64]) -> str:
    width, height = (high - low).tolist()
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" '
        f'width="{width:.9g}mm" height="{height:.9g}mm" '
        f'viewBox="0 0 {width:.9g} {height:.9g}">\n'
    )


def _svg_path(
    polylines: Sequence[NDArray[np.float64]],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> str:
    """Return a path element; SVG's y axis points down.

    Args:
        polylines: The polylines.
        low: The lowest corner of the drawing.
        high: The highest corner.
    """
    paths = (np.stack([line[:, 0] - low[0], high[1] - line[:, 1]], axis=1) for line in polylines)
    data = " ".join(_path(line) for line in paths)
    return f'<path fill-rule="evenodd" d="{data}"/>'


def _write_dxf(
    file: BinaryIO, layers: Sequence[tuple[str, float, Sequence[NDArray[np.float64]]]]
) -> None:
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER")]
    pairs += [(1, "AC1009"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC")]
    pairs += [(0, "SECTION"), (2, "ENTITIES")]
    for name, height, polylines in layers:
        for line in polylines:
            pairs += [(0, "POLYLINE"), (8, name), (66, 1), (70, 1)]
            pairs += [(10, 0.0), (20, 0.0), (30, height)]
            for x, y in line.tolist():
                pairs += [(0, "VERTEX"), (8, name), (10, x), (20, y), (30, height)]
            pairs += [(0, "SEQEND"), (8, name)]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    file.write("".join(f"{code}\n{_value(value)}\n" for code, value in pairs).encode())


def _path(line: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{x:.9g} {y:.9g}" for x, y in line.tolist()) + "Z"


def _value(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)
