"""Draw the catalogue sheets: every shape, operator and blend of the field library over its name.

Input: the cells of ``catalogue_cells``, and their pictures, which ``gen_thumbnails.py`` draws by
``draw`` of this module. Output: one picture for each group in ``docs/pictures/``, which lists its
cells in its metadata. Solids are lit and framed by their own boxes; flat shapes are lines of equal
distance. ``--only NAME …`` draws single cells to a folder of your own instead, large enough to
judge them. ``--check`` writes nothing and fails when a sheet lacks a cell or a cell has no picture.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from catalogue_cells import GROUPS, Cell, cells
from gen_thumbnails import SIZE_PX, picture_of, place_of
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from distal import Box, Camera, DistantLight, HemisphereLight, Scene
from distal.fields.guarantees import EXACT
from distal.lang import Frame, image, slider, vec2, vec4
from distal.render.views import isolines
from distal.scene.lowering.slope_limit import check_slope

FOLDER: Final = Path(__file__).parents[1] / "docs/pictures"
ACROSS: Final = 10
LABEL_PX: Final = 30  # two lines
LETTERS_PX: Final = 11
QUALITY: Final = 80
PAPER: Final = (250, 249, 246)
INK: Final = (40, 42, 48)
BACKGROUND: Final = (0.93, 0.92, 0.89)
# A shape's guarantee as its color: exact, a bound, or a bounded slope only.
CLAY: Final = {"exact": "#e2824a", "bound": "#5f93b8", "slope": "#8d9a6b", "part": "#c9ad7c"}
# An endless shape is shown as far as this.
ROOM: Final = 1.9
TOWARDS: Final = (0.55, 0.5, 0.85)  # the camera, as seen from a shape


@dataclass(frozen=True, slots=True)
class Drawn:
    """A cell's picture, (height, width, 3) 8-bit, and what it took."""

    cell: Cell
    pixels: NDArray[np.uint8]
    compile_s: float
    problem: str = ""


def draw(cell: Cell, size_px: int, samples: int) -> Drawn:
    """The picture of one cell; a problem is shown in it, not raised."""
    try:
        shape = cell.make()
        check_slope(shape.node)
        if shape.flat:
            pixels, took = _flat(shape, size_px)
        else:
            color = CLAY[_claim(shape) if cell.group == "solids" else "part"]
            pixels, took = _solid(shape, color, size_px, samples)
    except Exception as error:  # one bad row must not hide the others
        blank = np.full((size_px, size_px, 3), (200, 60, 60), np.uint8)
        return Drawn(cell, blank, 0.0, f"{type(error).__name__}: {error}")
    shown = np.clip(np.nan_to_num(pixels[..., :3]), 0.0, 1.0)
    return Drawn(cell, np.round(shown * 255).astype(np.uint8), took)


def _solid(shape: Any, color: str, size_px: int, samples: int) -> tuple[Any, float]:
    shape, low, high = _within(shape)
    center = (low + high) / 2.0
    radius = max(0.5 * float(np.linalg.norm(high - low)), 0.05)
    away = 4.5 * radius
    basis = _looking(TOWARDS)
    # Where to look and how wide, in units of the distance: parameters, so that looking once more
    # compiles nothing.
    aim = tuple(slider(name, 0.0, low=-1.0, high=1.0) for name in ("Right", "Up"))
    wide = slider("Wide", 0.3, low=0.001, high=2.0)
    target = tuple(
        float(center[i]) + away * (float(basis[0][i]) * aim[0] + float(basis[1][i]) * aim[1])
        for i in range(3)
    )
    scene = Scene(
        shape.paint(color),
        lights=[
            DistantLight((-0.4, 1.0, 0.75), 0.85, angle=0.12),
            HemisphereLight(sky=(0.95, 0.97, 1.0), ground=(0.55, 0.47, 0.42), intensity=0.45),
        ],
        camera=Camera(tuple(map(float, center + away * basis[2])), target=target, fov=wide),
        background=BACKGROUND,
        ambient_occlusion=0.35 * radius,
        steps=256,
    )
    first = 2.0 * float(np.tan(np.arcsin(radius / away)))
    seen = scene.render(size=(72, 72), params={"wide": 2.0 * np.arctan(first / 2.0)})
    right, up, wide_enough = _framed(seen.linear, first)
    picture = scene.render(
        size=(size_px, size_px),
        samples=samples,
        params={"right": right, "up": up, "wide": 2.0 * np.arctan(wide_enough / 2.0)},
    )
    return picture.array, picture.stats["compile_s"] + seen.stats["compile_s"]


def _looking(towards: Sequence[float]) -> NDArray[np.float64]:
    """Right, up and back of a camera that looks at the origin from somewhere."""
    back = np.array(towards) / np.linalg.norm(towards)
    right = np.cross((0.0, 1.0, 0.0), back)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(back, right), back])


def _framed(linear: NDArray[np.float32], wide: float) -> tuple[float, float, float]:
    """Where a shape's middle was seen, and how wide to look to see it and a rim."""
    shown = np.abs(linear[..., :3] - np.array(BACKGROUND)).max(axis=2) > 0.02
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    if not rows.size:
        return 0.0, 0.0, wide
    px = wide / linear.shape[0]
    left, right = columns[0] * px, (columns[-1] + 1) * px
    top, bottom = rows[0] * px, (rows[-1] + 1) * px
    room = 1.14 * max(right - left, bottom - top)
    return (left + right - wide) / 2.0, (wide - top - bottom) / 2.0, room


def _within(shape: Any) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]]:
    """The shape, cut where it has no end, and the corners of what is shown."""
    low, high = (np.array(corner, float) for corner in shape.bounds())
    if np.isfinite(low).all() and np.isfinite(high).all():
        return shape, low, high
    half = ROOM / 2.0
    low, high = np.clip(low, -half, half), np.clip(high, -half, half)
    return shape & Box(ROOM), low, high


def _claim(shape: Any) -> str:
    claims = shape.claims
    if claims >= EXACT:
        return "exact"
    return "bound" if claims else "slope"


def _flat(shape: Any, size_px: int) -> tuple[Any, float]:
    low, high = (np.clip(corner, -1.2, 1.2) for corner in shape.bounds())
    middle = vec2(*map(float, (low + high) / 2.0))
    reach = float(max(high - low)) * 0.5 * 1.35

    @image
    def lines(frame: Frame) -> vec4:
        """The outline, and the lines of equal distance around it."""
        across = frame.resolution.y
        color = vec4(0.0)
        for i in range(9):
            at = frame.coord + vec2(float(i % 3) - 1.0, float(i // 3) - 1.0) / 3.0
            p = middle + reach * (2.0 * at - frame.resolution) / across
            color += vec4(isolines(shape(p), 2.0 * reach / across, 0.1, 1.0), 1.0) / 9.0
        return color

    picture = lines.render(size=(size_px, size_px))
    return picture.array, picture.stats["compile_s"]


def sheet(pictures: Mapping[str, Image.Image], size_px: int, across: int = ACROSS) -> Image.Image:
    """Return all pictures in rows, each over its title."""
    gap, down = 8, -(-len(pictures) // across)
    step_x, step_y = size_px + gap, size_px + LABEL_PX + gap
    made = Image.new("RGB", (across * step_x + gap, down * step_y + gap), PAPER)
    pen = ImageDraw.Draw(made)
    for i, (title, picture) in enumerate(pictures.items()):
        x, y = gap + (i % across) * step_x, gap + (i // across) * step_y
        made.paste(picture, (x, y))
        text = _in_lines(title, size_px + gap - 2)
        pen.multiline_text(
            (x + size_px / 2, y + size_px + 2), text, INK, _font(), "ma", spacing=1, align="center"
        )
    return made


def _font() -> Any:
    return ImageFont.load_default(LETTERS_PX)


def _in_lines(title: str, width_px: int) -> str:
    """Return a title in lines that keep within its cell, divided between words."""
    words = re.findall(r"[A-Z]?[^A-Z ]+ ?|[A-Z]+(?![a-z]) ?", title)
    lines = [""]
    for word in words:
        if lines[-1] and _font().getlength((lines[-1] + word).rstrip()) > width_px:
            lines.append("")
        lines[-1] += word
    return "\n".join(line.rstrip() for line in lines)


def _save(picture: Image.Image, path: Path, titles: Sequence[str]) -> None:
    """Write a WebP file with the titles of its cells."""
    picture.save(path, quality=QUALITY, method=6, xmp=", ".join(titles).encode())


def _titles_in(path: Path) -> str:
    """Return the titles of a sheet's cells."""
    with Image.open(path) as picture:
        return bytes(picture.info.get("xmp", b"")).decode()


def ordered(group: str) -> list[str]:
    """Return the titles of a group's cells in the order of the page of shapes."""
    return [cell.title for cell in sorted(cells([group]), key=place_of)]


def path_of(group: str) -> Path:
    """Return the file of a group's sheet."""
    return FOLDER / f"catalogue_{group}.webp"


def problems(group: str) -> Iterator[str]:
    """Yield what is missing of a sheet."""
    for title in ordered(group):
        if not picture_of(title).exists():
            yield f"{title} has no picture: run tools/gen_thumbnails.py --changed"
    path = path_of(group)
    if not path.exists():
        yield f"{path.name} is missing: run tools/gen_catalogue_sheet.py"
    elif _titles_in(path) != ", ".join(ordered(group)):
        yield f"{path.name} has other cells: run tools/gen_catalogue_sheet.py"


def _draw_only(given: argparse.Namespace) -> int:
    """Draw some cells, large; 1 when a cell could not be drawn."""
    chosen = [cell for cell in cells(given.groups or GROUPS) if cell.title in given.only]
    given.folder.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(given.processes) as pool:
        drawn = list(pool.map(partial(draw, size_px=given.size, samples=given.samples), chosen))
    for one in drawn:
        Image.fromarray(one.pixels).save(given.folder / f"{one.cell.title.replace(' ', '_')}.png")
        print(f"{one.cell.title}: compiled in {one.compile_s:.1f} s", one.problem)
    return 1 if any(one.problem for one in drawn) else 0


def main() -> int:
    """Draw the sheets; 1 when something is missing."""
    told = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    told.add_argument("groups", nargs="*", help=f"of {', '.join(GROUPS)}; all without")
    told.add_argument("--check", action="store_true")
    told.add_argument("--only", nargs="*", help="titles of cells to draw")
    told.add_argument("--folder", type=Path, default=Path("cells"), help="for --only")
    told.add_argument("--size", type=int, default=320, help="of a cell of --only, in pixels")
    told.add_argument("--samples", type=int, default=9)
    told.add_argument("--processes", type=int, default=2)
    given = told.parse_args()
    if given.only:
        return _draw_only(given)
    found = []
    for group in given.groups or GROUPS:
        if not given.check:
            there = [title for title in ordered(group) if picture_of(title).exists()]
            pictures = {title: Image.open(picture_of(title)).convert("RGB") for title in there}
            _save(sheet(pictures, SIZE_PX), path_of(group), there)
        found += problems(group)
    print("\n".join(found), end="")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
