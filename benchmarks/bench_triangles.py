"""Pictures as triangles beside WebP, JPEG and AVIF: bytes against PSNR.

Ten pictures of the gallery at 480x360, and three by paths at 1728x1296 against the line of the
founding blog: 46,000 bytes for a picture of 6.7 MB, 24.184 dB, 155,568 triangles. Rivals are
interpolated to equal bytes over all their qualities, at full and at half size, whichever is better.

    python benchmarks/bench_triangles.py [--pictures FOLDER] [--large] [--save FOLDER]

FOLDER has pictures that were rendered before, as NAME.png and large_NAME.png; others are rendered.
"""

from __future__ import annotations

import argparse
import io
import time
from pathlib import Path

import numpy as np
from PIL import Image, features

import distal
from distal.export.page import TRIANGLES, player_script
from distal.images.png import quantise
from distal.triangles.decoding import decode
from distal.triangles.encoding import TriangleEncoding, within

SMALL = (480, 360)
LARGE = (1728, 1296)
NAMES = (
    *("bunny", "planet", "room_door", "castle", "sea"),
    *("gears", "gyroid_part", "still_life", "forest", "city"),
)
LARGE_NAMES = ("castle", "still_life", "forest")
LINE_BYTES, LINE_DB, LINE_TRIANGLES = 46_000, 24.184, 155_568
PRICES = (6000.0, 2000.0, 600.0, 200.0, 60.0)
QUALITIES = (1, 3, 6, 10, 15, 22, 30, 40, 50, 60, 70, 80, 90)
FORMATS = {"WEBP": {"method": 6}, "JPEG": {"optimize": True, "progressive": True}}
if features.check("avif"):
    FORMATS["AVIF"] = {"speed": 4}


def picture(name: str, size: tuple[int, int], folder: Path | None) -> np.ndarray:
    """Return a picture of the gallery, rendered where the folder does not have it."""
    is_large = size == LARGE
    file = folder / f"{'large_' * is_large}{name}.png" if folder else None
    if file and file.exists():
        return np.asarray(Image.open(file).convert("RGB"))
    scene = distal.load(f"example:{name}")
    more = {"mode": "path", "samples": 32} if is_large else {}
    levels = quantise(scene.render(size, **more).array)[..., :3]
    if file:
        Image.fromarray(levels).save(file)
    return levels


def psnr(found: np.ndarray, wanted: np.ndarray) -> float:
    """Return the ratio of the peak to the noise, over all channels, in dB."""
    error = np.mean(np.square(found.astype(float) - wanted))
    return float(10.0 * np.log10(255.0**2 / max(error, 1e-9)))


def rival(wanted: np.ndarray, kind: str) -> list[tuple[int, float]]:
    """Return bytes and PSNR of a format, by bytes, each better than the one before."""
    height, width, _ = wanted.shape
    whole = Image.fromarray(wanted)
    found = []
    for part in (1, 2):
        sized = whole.resize((width // part, height // part), Image.Resampling.LANCZOS)
        for quality in QUALITIES:
            file = io.BytesIO()
            sized.save(file, kind, quality=quality, **FORMATS[kind])
            shown = (
                Image.open(file).convert("RGB").resize((width, height), Image.Resampling.BICUBIC)
            )
            found.append((file.tell(), psnr(np.asarray(shown), wanted)))
    rising: list[tuple[int, float]] = []
    for size, ratio in sorted(found):
        if not rising or ratio > rising[-1][1]:
            rising.append((size, ratio))
    return rising


def at(curve: list[tuple[int, float]], size: int) -> str:
    """Return the PSNR of a curve at a number of bytes; what it has at least below its beginning."""
    if size < curve[0][0]:
        return f"none below {curve[0][0]:,} B"
    return f"{np.interp(np.log(size), np.log([s for s, _ in curve]), [r for _, r in curve]):.2f}"


def compare(name: str, wanted: np.ndarray, save: Path | None) -> None:
    """Print the rows of one picture."""
    curves = {kind: rival(wanted, kind) for kind in FORMATS}
    work = TriangleEncoding(wanted.copy())
    for price in PRICES:
        file = work.file(price)
        shown = decode(file)
        others = " | ".join(at(curve, len(file)) for curve in curves.values())
        ratio = psnr(shown, wanted)
        print(
            f"| {name} | {len(file):,} | {work.triangles:,} | {ratio:.2f} | {others} |", flush=True
        )
        if save:
            Image.fromarray(shown).save(save / f"{name}_{price:.0f}.png")


def compare_line(name: str, wanted: np.ndarray, save: Path | None) -> None:
    """Print the row of one large picture."""
    start = time.process_time()
    work = TriangleEncoding(wanted.copy())
    measured = time.process_time()
    file = within(work, LINE_BYTES)
    searched = time.process_time()
    shown = decode(file)
    decoded = time.process_time()
    ratio = psnr(shown, wanted)
    others = " | ".join(at(rival(wanted, kind), len(file)) for kind in FORMATS)
    times = " | ".join(
        f"{s:.0f}" for s in (measured - start, searched - measured, decoded - searched)
    )
    print(
        f"| {name} | {len(file):,} | {wanted.nbytes / len(file):.0f}:1 | {work.triangles:,} "
        f"| {ratio:.2f} | {ratio - LINE_DB:+.2f} | {others} | {times} |",
        flush=True,
    )
    if save:
        Image.fromarray(shown).save(save / f"large_{name}_triangles.png")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Pictures as triangles beside other formats.")
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--save", type=Path)
    parser.add_argument("--large", action="store_true", help="the pictures at 1728x1296 too")
    given = parser.parse_args()
    script = TRIANGLES.read_bytes()
    packed = len(player_script(before=TRIANGLES).text) - len(player_script().text)
    print(f"script: {len(script):,} bytes, {packed:,} in a page")
    print(f"| picture | bytes | triangles | dB | {' | '.join(f'{k} dB' for k in FORMATS)} |")
    for name in NAMES:
        compare(name, picture(name, SMALL, given.pictures), given.save)
    if given.large:
        print(f"line: {LINE_BYTES:,} bytes, {LINE_DB} dB, {LINE_TRIANGLES:,} triangles")
        for name in LARGE_NAMES:
            compare_line(name, picture(name, LARGE, given.pictures), given.save)


if __name__ == "__main__":
    main()
