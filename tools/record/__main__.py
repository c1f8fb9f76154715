"""Record, choose, and run the tests that a change can reach.

python -m tools.record all               records every test and chooses those of make test
python -m tools.record choose            chooses anew (--seconds)
python -m tools.record read FOLDER       takes the rows of a recording
python -m tools.record changed [REV]     runs the tests that a change since REV can reach
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

from tools.record import monitor
from tools.record.choice import chosen
from tools.record.packages import with_table
from tools.record.reach import digests, tests_for
from tools.record.rows import PATH, ROOT, Record, load, merged, raw_rows

GUIDE: Final = ROOT / "CONTRIBUTING.md"
SHOWN: Final = 12  # names of tests, before the others are counted


def main() -> int:
    """Do what the first word says."""
    options = _options()
    before = load() if PATH.exists() else None
    if options.action == "changed":
        if before is None:
            raise SystemExit(f"there is no record; make record writes {PATH.relative_to(ROOT)}")
        return _changed(before, options.revision, options.workers)
    code = 0
    if options.action == "all":
        with tempfile.TemporaryDirectory(prefix="distal-record-") as folder:
            code = _run(folder, options.workers)
            before = merged(raw_rows(Path(folder)), digests(), None)
    if options.action == "read":
        before = merged(raw_rows(Path(options.revision)), digests(), before)
    assert before is not None, "there is no record"
    found = replace(before, chosen=frozenset(chosen(before, options.seconds)))
    found.save()
    GUIDE.write_text(with_table(GUIDE.read_text("utf-8"), found), "utf-8")
    print(
        f"{len(found.rows)} tests, {found.seconds(found.rows):.0f} s of the processor,"
        f" {len(found.functions)} functions; make test: {len(found.chosen)} tests,"
        f" {found.seconds(found.chosen):.0f} s"
    )
    return code


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("action", choices=("all", "choose", "read", "changed"))
    parser.add_argument("revision", nargs="?", default="HEAD", metavar="REV or FOLDER")
    parser.add_argument("--seconds", type=float, default=950.0, help="of the processor at most")
    parser.add_argument("--workers", default="4")
    return parser.parse_args()


def _run(folder: str, workers: str, **environment: str) -> int:
    """Run pytest with the recorder; return its status."""
    inside = [str(Path(__file__).parent / "in_children"), os.environ.get("PYTHONPATH", "")]
    added = {
        monitor.FOLDER: folder,
        monitor.SOURCE: f"{ROOT / 'src'}{os.sep}",
        "PYTHONPATH": os.pathsep.join(filter(None, inside)),
        "DISTAL_CACHE_DIR": "off",  # on a hit, what compiles does not run
    }
    recorder = ["-p", "tools.record.plugin", "-n", workers, "--dist", "worksteal", "-rfEs"]
    command = [sys.executable, "-m", "pytest", *recorder]
    made = subprocess.run(command, cwd=ROOT, env={**os.environ, **added, **environment})
    return made.returncode


def _changed(before: Record, revision: str, workers: str) -> int:
    """Run what a change can reach, say why, and refresh the rows."""
    reasons = tests_for(before, revision)
    found = set().union(*reasons.values())
    _say(before, revision, reasons)
    with tempfile.TemporaryDirectory(prefix="distal-record-") as folder:
        names = Path(folder) / "names"
        # Tests that the record does not know are new: they are in it as all that is not known.
        names.write_text("\n".join(sorted(before.rows.keys() - found)), "utf-8")
        code = _run(folder, workers, DISTAL_TESTS=str(names))
        merged(raw_rows(Path(folder)), digests(), before).save()
    return 0 if code == 5 else code  # 5: no test is reached


def _say(record: Record, revision: str, reasons: Mapping[str, set[str]]) -> None:
    for reason, tests in reasons.items():
        if tests:
            print(f"{len(tests)} tests {reason}:")
            for name in sorted(tests)[:SHOWN]:
                print(f"    {name}")
            if len(tests) > SHOWN:
                print(f"    and {len(tests) - SHOWN} more")
    found = set().union(*reasons.values())
    print(
        f"{len(found)} of {len(record.rows)} tests are reached by the change since {revision}:"
        f" {record.seconds(found):.0f} of {record.seconds(record.rows):.0f} s of the processor;"
        " tests that are not in the record run too",
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
