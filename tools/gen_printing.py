"""Write the table of printable examples in ``docs/guide/printing.md``: what their meshes are like.

Input: the printable examples that ``tools/sweep_meshes.py`` names. Output: a row for each part:
its name, triangles, the largest measured error, processor seconds, the size of the 3MF, and
faults. ``--check`` writes nothing and fails when a part is missing.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import distal  # noqa: E402
from tools.sweep_meshes import EXAMPLES  # noqa: E402

PAGE: Final = ROOT / "docs" / "guide" / "printing.md"
BEGIN: Final = "<!-- table: tools/gen_printing.py -->\n"
END: Final = "<!-- end of the table -->\n"
HEAD: Final = (
    "| `distal mesh …` | triangles | largest error, units | of size | CPU s | 3MF, kB | faults |\n"
    "|---|---|---|---|---|---|---|\n"
)


def row_of(example: str, part: str) -> str:
    """Return the row of a part."""
    shape: Any = distal.load(f"example:{example}", part)
    begin = time.process_time()
    made = shape.mesh(check=True)
    seconds = time.process_time() - begin
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "part.3mf"
        made.save(file)
        size = file.stat().st_size
    low, high = made.bounds
    largest = max(b - a for a, b in zip(low, high, strict=True))
    error, faults = made.report["error"]["largest"], made.report["check"]
    cells = (
        f"`example:{example}:{part}`",
        f"{len(made.triangles):,}",
        f"{error:.2g}",
        f"{error / largest:.1e}",
        f"{seconds:.1f}",
        f"{size / 1000:,.0f}",
        ", ".join(map(str, faults.values())),
    )
    return f"| {' | '.join(cells)} |\n"


def parts_in(page: str) -> list[str]:
    """Return the parts that a page's table has."""
    table = page.partition(BEGIN)[2].partition(END)[0]
    return [line.split("`")[1] for line in table.splitlines() if line.startswith("| `example:")]


def replaced(page: str, rows: Iterable[str]) -> str:
    """Return the page with another table."""
    before, _, rest = page.partition(BEGIN)
    after = rest.partition(END)[2]
    return f"{before}{BEGIN}{HEAD}{''.join(rows)}{END}{after}"


def main() -> int:
    """Write or check the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    page = PAGE.read_text("utf-8")
    if parser.parse_args().check:
        wanted = [f"example:{example}:{part}" for example, part in EXAMPLES]
        if parts_in(page) != wanted:
            print("docs/guide/printing.md: run tools/gen_printing.py")
            return 1
        return 0
    rows = []
    for example, part in EXAMPLES:
        rows.append(row_of(example, part))
        print(rows[-1], end="", flush=True)
    PAGE.write_text(replaced(page, rows), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
