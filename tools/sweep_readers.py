"""Damage files of every kind that others write, and read them with little memory and time.

Input: the names of kinds, the number of files for each subject, a seed. Output: a line for each
subject: how many files were read, refused in one line, ended in another exception, took too much
memory or time, or ended the process. The exit code is 1 if one did.

Each subject is read in a process of its own, which may take ``MEMORY`` more than it has with its
packages loaded; it is started again behind a file that ends it.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.readers.damage import REFUSALS, SUBJECTS, Subject, damaged  # noqa: E402

MEMORY: Final = 10**9  # bytes
SECONDS: Final = 10.0  # of the processor
_PATIENCE_S: Final = 60.0  # of a child that does not answer
READ, REFUSED, RAW, OVER, ENDED = "read", "refused", "raw exceptions", "over the limit", "ended"
_NO_MEMORY: Final = "more memory than there is"


def outcome(subject: Subject, path: Path) -> tuple[str, str]:
    """Read a file; return what happened, and a message."""
    begin = time.process_time()
    try:
        subject.read(path)
        found, message = READ, ""
    except REFUSALS as error:
        message = str(error)
        found = OVER if _NO_MEMORY in message else REFUSED
        if isinstance(error, Exception) and "\n" in message.split("\n  -->")[0].rstrip("\n"):
            found = RAW if not message.startswith("error:") else found
    except MemoryError:
        found, message = OVER, "MemoryError"
    except Exception as error:
        found, message = RAW, f"{type(error).__name__}: {error}"
    took = time.process_time() - begin
    return (OVER, f"{took:.1f} s") if took > SECONDS else (found, message)


def child(number: int, first: int, count: int, seed: int) -> None:
    """Read damaged files, and print a line before and after each."""
    subject = SUBJECTS[number]
    whole = subject.made()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / subject.name
        path.write_bytes(whole)
        subject.read(path)  # its packages are loaded, its kernels compiled
        _limit_memory()
        for i in range(first, count):
            path.write_bytes(damaged(whole, seed * 1_000_003 + i))
            print(json.dumps({"begin": i}), flush=True)
            found, message = outcome(subject, path)
            line = {"file": i, "found": found, "message": message.split("\n")[0][:200]}
            print(json.dumps(line), flush=True)


def _limit_memory() -> None:
    import resource  # noqa: PLC0415 (not on Windows)

    with open("/proc/self/statm", encoding="ascii") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + MEMORY,) * 2)


def swept(number: int, count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """Read the damaged files of a subject; return how many ended how, and what is wrong."""
    totals: Counter[str] = Counter()
    wrong: list[str] = []
    first = 0
    while first < count:
        command = [sys.executable, __file__, "--child", *map(str, (number, first, count, seed))]
        environment = {**os.environ, "PYTHONWARNINGS": "ignore", "OPENBLAS_NUM_THREADS": "1"}
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
        )
        try:
            output, errors = process.communicate(timeout=_PATIENCE_S + count)
        except subprocess.TimeoutExpired:
            process.kill()
            output, errors = process.communicate()
        last = None
        for line in output.splitlines():
            try:
                row = json.loads(line)
            except ValueError:
                continue
            if "begin" in row:
                last = row["begin"]
                continue
            last = None
            totals[row["found"]] += 1
            first = row["file"] + 1
            if row["found"] in (RAW, OVER):
                wrong.append(f"{row['file']}: {row['found']}: {row['message']}")
        if last is not None:
            totals[ENDED] += 1
            wrong.append(f"{last}: the process ended with {process.returncode}: {errors[-300:]}")
            first = last + 1
        elif first < count:
            wrong.append(f"the child failed: {errors[-600:]}")
            totals[ENDED] += 1
            break
    return totals, wrong


def main() -> int:
    """Sweep the kinds that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--child", nargs=4, type=int)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    if given.child:
        child(*given.child)
        return 0
    is_wrong = False
    for number, subject in enumerate(SUBJECTS):
        if given.kinds and subject.kind not in given.kinds:
            continue
        totals, wrong = swept(number, given.count, given.seed)
        counts = ", ".join(f"{totals[k]} {k}" for k in (READ, REFUSED, RAW, OVER, ENDED))
        print(f"{subject.kind:10} {subject.name:12} {counts}", flush=True)
        for line in wrong[:8]:
            print(f"    {line}", flush=True)
        is_wrong |= bool(wrong)
    return int(is_wrong)


if __name__ == "__main__":
    sys.exit(main())
