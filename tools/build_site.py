"""Write the site: front page, playground, lessons, gallery, documents, search.

    python tools/build_site.py [FOLDER] [--examples NAMES] [--lessons NUMBERS] [--no-playground]

Every address in it is relative, so that it works from any folder, and from a disk as far as
browsers allow. With fewer examples and lessons it is built sooner, for tests.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tools.site import documents, front, pages, playground  # noqa: E402


def main() -> None:
    """Write the site in a folder, which is made anew."""
    parser = argparse.ArgumentParser(description="Write the site.")
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "site")
    parser.add_argument("--examples", help="names with commas; all if left out")
    parser.add_argument("--lessons", help="numbers with commas; all if left out")
    parser.add_argument("--no-playground", action="store_true", help="leave the playground out")
    given = parser.parse_args()
    names = given.examples.split(",") if given.examples else pages.all_examples()
    lessons = pages.all_lessons()
    if given.lessons:
        chosen = {int(number) for number in given.lessons.split(",")}
        lessons = [file for file in lessons if int(file.parent.name[:2]) in chosen]
    build(given.folder, names, lessons, has_playground=not given.no_playground)


def build(folder: Path, names: list[str], lessons: list[Path], *, has_playground: bool) -> None:
    """Write the site; a folder that is there and is no site is refused."""
    if folder.exists() and any(folder.iterdir()) and not (folder / "site.css").exists():
        raise SystemExit(f"{folder} is there and holds something else")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    pages.copy_style(folder)
    found = documents.build(folder, documents.Tried())
    found += pages.build_gallery(folder, names)
    found += pages.build_lessons(folder, lessons)
    front.build(folder, names, lessons)
    documents.write_search(folder, found)
    if has_playground:
        playground.build(folder / "playground", names)
    print(f"{folder}: {sum(1 for path in folder.rglob('*') if path.is_file())} files")


if __name__ == "__main__":
    main()
