"""Write the table and the pictures of ``docs/guide/coming-from-other-tools.md``.

Input: the page's scenes, each a heading with one block of Python, and the lines that the originals
have. Output: the page's table of lines, and a picture for each scene in ``docs/pictures/rebuilt``.
A line counts if it is neither blank nor a comment. ``--check`` writes nothing and fails when the
table is stale or a picture is missing; ``--table`` draws nothing; names draw only these.
"""

from __future__ import annotations

import contextlib
import re
import runpy
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import Image

from distal import Scene

ROOT: Final = Path(__file__).resolve().parents[1]
PAGE: Final = ROOT / "docs/guide/coming-from-other-tools.md"
PICTURES: Final = ROOT / "docs/pictures/rebuilt"
SIZE: Final = (320, 240)
MOST_BYTES: Final = 25_000
BEGIN: Final = "<!-- table: tools/gen_rebuilt.py -->\n"
END: Final = "<!-- end of the table -->\n"
HEAD: Final = "| scene | original | its lines | lines here |\n|---|---|---|---|\n"
SECTION: Final = re.compile(r"^### (.+?)\n(.*?)(?=^### |^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK: Final = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)

SDF: Final = "https://github.com/fogleman/sdf/blob/main/examples"
CURV: Final = "https://github.com/curv3d/curv/blob/master/examples"
THREADS: Final = "https://github.com/rcolyer/threads-scad"


@dataclass(frozen=True, slots=True)
class Original:
    """The scene of another tool.

    Attributes:
        tool: The tool's name.
        file: The name of the file.
        address: Where it is published.
        lines: Its lines that are neither blank nor comments.
    """

    tool: str
    file: str
    address: str
    lines: int


# None: a scene without an original, which is not counted.
ORIGINALS: Final[Mapping[str, Original | None]] = {
    "Solid geometry": Original("fogleman/sdf", "example.py", f"{SDF}/example.py", 5),
    "Gearlike": Original("fogleman/sdf", "gearlike.py", f"{SDF}/gearlike.py", 5),
    "Knurled handle": Original("fogleman/sdf", "knurling.py", f"{SDF}/knurling.py", 11),
    "Pawn": Original("fogleman/sdf", "pawn.py", f"{SDF}/pawn.py", 13),
    "Weave": Original("fogleman/sdf", "weave.py", f"{SDF}/weave.py", 9),
    "Blobby": Original("fogleman/sdf", "blobby.py", f"{SDF}/blobby.py", 6),
    "Box with a lid": Original(
        "fogleman/sdf", "customizable_box.py", f"{SDF}/customizable_box.py", 50
    ),
    "Relief of a picture": Original("fogleman/sdf", "image.py", f"{SDF}/image.py", 6),
    "Text": Original("fogleman/sdf", "text.py", f"{SDF}/text.py", 7),
    "Gyroids": Original("Curv", "gyroid.curv", f"{CURV}/gyroid.curv", 14),
    "Trefoil knot": Original("Curv", "sweep.curv", f"{CURV}/sweep.curv", 21),
    "Mug with a slider": Original("Curv", "fat_bottom_mug.curv", f"{CURV}/fat_bottom_mug.curv", 24),
    "Bolt and nut": Original("OpenSCAD", "with threads.scad", THREADS, 3),
    "Chain along a knot": None,
}


def scenes(page: str) -> dict[str, list[str]]:
    """Return the blocks of each scene by its heading; the last block makes the scene."""
    found = {title: BLOCK.findall(body) for title, body in SECTION.findall(page)}
    return {title: blocks for title, blocks in found.items() if title in ORIGINALS}


def counted(code: str) -> int:
    """Return the number of lines that are neither blank nor comments."""
    lines = (line.strip() for line in code.splitlines())
    return sum(1 for line in lines if line and not line.startswith("#"))


def table(page: str) -> str:
    """Return the table of lines."""
    rows = [HEAD]
    total = [0, 0]
    for title, blocks in scenes(page).items():
        made, ours = ORIGINALS[title], counted(blocks[-1])
        if made is None:
            rows.append(f"| [{title}](#{anchor(title)}) | | | {ours} |\n")
            continue
        total[0] += made.lines
        total[1] += ours
        original = f"{made.tool}: [{made.file}]({made.address}) | {made.lines}"
        rows.append(f"| [{title}](#{anchor(title)}) | {original} | {ours} |\n")
    rows.append(f"| all with an original | | {total[0]} | {total[1]} |\n")
    return "".join(rows)


def anchor(title: str) -> str:
    """Return the name of a heading in addresses and of its picture."""
    return title.lower().replace(" ", "-")


def replaced(page: str) -> str:
    """Return the page with a fresh table."""
    before, _, rest = page.partition(BEGIN)
    return f"{before}{BEGIN}{table(page)}{END}{rest.partition(END)[2]}"


def picture_of(title: str) -> Path:
    """Return the file of a scene's picture."""
    return PICTURES / f"{anchor(title)}.webp"


def draw(title: str, blocks: list[str]) -> None:
    """Run the blocks of a scene and draw what the last one makes."""
    made: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for number, code in enumerate(blocks):
            file = Path(folder) / f"block_{number}.py"
            file.write_text(code, encoding="utf-8")
            made = runpy.run_path(str(file))
        scene = made["scene"]
        picture = (scene if isinstance(scene, Scene) else Scene(scene)).render(SIZE, samples=9)
    shown = np.clip(np.nan_to_num(picture.array[..., :3]), 0.0, 1.0)
    pixels = Image.fromarray(np.round(shown * 255).astype(np.uint8))
    PICTURES.mkdir(parents=True, exist_ok=True)
    pixels.save(picture_of(title), quality=80, method=6)
    print(title)


def faults(page: str) -> list[str]:
    """Return what is stale or missing."""
    again = "run tools/gen_rebuilt.py"
    found = [f"{PAGE.name} has no scene '{title}'" for title in ORIGINALS.keys() - scenes(page)]
    if replaced(page) != page:
        found.append(f"{PAGE.name}: the table is stale: {again} --table")
    for path in map(picture_of, ORIGINALS):
        if not path.exists():
            found.append(f"{path.name} is missing: {again}")
        elif path.stat().st_size > MOST_BYTES:
            found.append(f"{path.name} has more than {MOST_BYTES:,} bytes")
        if f"../pictures/rebuilt/{path.name}" not in page:
            found.append(f"{PAGE.name} does not show {path.name}")
    return found


def main() -> int:
    """Write or check the table and the pictures."""
    page = PAGE.read_text("utf-8")
    given = sys.argv[1:]
    if "--check" in given:
        found = faults(page)
        print("\n".join(found), end="")
        return 1 if found else 0
    PAGE.write_text(replaced(page), "utf-8")
    if "--table" not in given:
        for title, blocks in scenes(page).items():
            if not given or title in given:
                draw(title, blocks)
    return 0


if __name__ == "__main__":
    sys.exit(main())
