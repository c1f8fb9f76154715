"""Write ``examples/posters/``: the small pictures that the studio's gallery shows.

Input: the pictures of ``docs/pictures/``, which ``tools/gen_gallery.py`` draws. Output: a WebP
file for each example, which is part of the package. ``--check`` writes nothing and fails when one
is missing, too large, or another picture.
"""

from __future__ import annotations

import argparse
import io
import sys
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from distal.example_files import all_examples

ROOT: Final = Path(__file__).parents[1]
PICTURES: Final = ROOT / "docs/pictures"
POSTERS: Final = ROOT / "examples/posters"
SIZE: Final = (320, 240)
MOST_BYTES: Final = 6_500
QUALITIES: Final = range(80, 0, -4)
# Of display values, at a fourth of the size: compression changes .02 at most, and pictures of
# different scenes differ by .1 at least.
MOST_DIFFERENCE: Final = 0.03


def small(name: str) -> Image.Image:
    """Return an example's picture in the size of a poster."""
    with Image.open(PICTURES / f"{name}.png") as picture:
        return picture.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)


def encoded(picture: Image.Image) -> bytes:
    """Return the finest file that is small enough."""
    for quality in QUALITIES:
        file = io.BytesIO()
        picture.save(file, "WEBP", quality=quality, method=6)
        if file.tell() <= MOST_BYTES:
            break
    return file.getvalue()


def fault_of(name: str) -> str | None:
    """Return what is wrong with an example's poster, or None."""
    path = POSTERS / f"{name}.webp"
    if not path.exists():
        return f"there is no poster of {name}"
    with Image.open(path) as picture:
        if picture.size != SIZE or path.stat().st_size > MOST_BYTES:
            return f"the poster of {name} is {picture.size}, {path.stat().st_size} bytes"
        shown = picture.convert("RGB")
    if difference(shown, small(name)) > MOST_DIFFERENCE:
        return f"the poster of {name} is another picture"
    return None


def difference(a: Image.Image, b: Image.Image) -> float:
    """Return the mean difference of display values of two pictures, at a fourth of the size."""
    quarter = (SIZE[0] // 4, SIZE[1] // 4)
    pixels = [np.asarray(p.resize(quarter, Image.Resampling.BOX), dtype=float) for p in (a, b)]
    return float(np.abs(pixels[0] - pixels[1]).mean() / 255.0)


def main() -> None:
    """Write the posters, or check them."""
    parser = argparse.ArgumentParser(description="Write the posters of the examples.")
    parser.add_argument("--check", action="store_true")
    if parser.parse_args().check:
        faults = [fault for name in all_examples() if (fault := fault_of(name))]
        sys.exit("; ".join([*faults, "run python tools/gen_posters.py"]) if faults else 0)
    POSTERS.mkdir(exist_ok=True)
    for old in POSTERS.glob("*.webp"):
        old.unlink()
    for name in all_examples():
        (POSTERS / f"{name}.webp").write_bytes(encoded(small(name)))


if __name__ == "__main__":
    main()
