"""Change the source in small ways and see whether a test notices (``make mutate``).

    python tools/mutate.py --modules distal/fields 'distal/passes/fold*' --count 100 --seed 7

Input: globs below ``src``, how many mutations, a seed. Output: a line for each
mutation, counts for each package, and the survivors that ``tests/mutation/survivors.toml`` does
not accept, as entries to put there once their reason is known. Fails when there is one, and when
an entry is stale; names entries whose mutation is killed now. Which tests run what is in the record
(``make record``). With ``--proof`` the tests of ``make test`` run first, and those that it leaves
out for what they do not kill: how much ``make test`` notices of what any recorded test does.
"""

from __future__ import annotations

import argparse
import importlib
import os
import random
import secrets
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT)]

from tools.mutation.operators import Mutation, mutations, parses  # noqa: E402
from tools.mutation.project import Project  # noqa: E402
from tools.mutation.running import (  # noqa: E402
    KILLED,
    SURVIVED,
    TIMED_OUT,
    UNTESTED,
    Outcome,
    Runner,
)
from tools.mutation.selection import Selection  # noqa: E402
from tools.mutation.survivors import Accepted, accepted, entry_text, stale  # noqa: E402
from tools.record.rows import load  # noqa: E402

MODULES: Final = ("distal/fields", "distal/render", "distal/passes/fold*", "distal/scene")
# Tests of meaning: golden texts and error texts notice any change, and so say nothing.
TESTS: Final = (
    "tests/unit/passes",
    "tests/unit/frontend",
    "tests/unit/lang",
    "tests/fields",
    "tests/scene",
    "tests/render",
    "tests/optics",
    "tests/gradients/test_found.py",
    "tests/gradients/test_texts.py",
    "tests/export",
    "tests/parity/test_elementary.py",
    "tests/window/test_state.py",
    "tests/images/test_rerender.py",
)
PRELOAD: Final = ("numpy", "scipy.spatial", "hypothesis", "llvmlite.binding", "PIL.Image")
VERDICTS: Final = (KILLED, SURVIVED, TIMED_OUT, UNTESTED)
ACCEPTED: Final = "accepted"


def main() -> int:
    """Draw, run, report; whether all is well."""
    os.environ["DISTAL_ALL_CASES"] = "1"  # a survivor is one that no case of a sampled test notices
    options = _options()
    root = options.root.resolve()
    paths = (str(root), *options.paths)
    project = Project(root, root / "src", tuple(options.tests), tuple(options.preload), paths)
    entries = accepted(options.survivors)
    old = stale(project, entries)
    if options.count <= 0:
        return _report_stale(old)
    chosen, total = _drawn(project, options.modules, options.count, options.seed)
    print(f"{len(chosen)} of {total} mutations, SEED={options.seed}", flush=True)
    for name in project.preload:
        importlib.import_module(name)
    selection = Selection(project, load(options.map), project.tests, options.seconds)
    keys = {entry.key for entry in entries}
    outcomes = _run_all(project, chosen, selection, keys, options)
    survivors = [o for o in outcomes if o.verdict in (SURVIVED, UNTESTED)]
    fresh = [o for o in survivors if o.mutation.key not in keys]
    dead = [o for o in outcomes if o.verdict in (KILLED, TIMED_OUT) and o.mutation.key in keys]
    _report(outcomes, keys)
    for outcome in fresh:
        print(f"\n# line {outcome.mutation.line}: {outcome.verdict}, {outcome.tests} tests")
        print(entry_text(outcome.mutation))
    for outcome in dead:
        print(f"\nan accepted survivor is killed by {outcome.by}: take it out of the list")
        print(entry_text(outcome.mutation))
    return max(_report_stale(old), 1 if fresh else 0)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--modules", nargs="+", default=MODULES, help="globs below src")
    parser.add_argument("--count", type=int, default=100, help="how many; 0: only check the list")
    parser.add_argument("--seed", type=int, default=None, help="which ones; drawn when not given")
    parser.add_argument("--seconds", type=float, default=30.0, help="of tests for a mutation")
    parser.add_argument("--minutes", type=float, default=0.0, help="stop drawing after these")
    parser.add_argument("--proof", action="store_true", help="those of make test first")
    parser.add_argument("--map", type=Path, default=None, help="where the record is")
    parser.add_argument("--paths", nargs="*", default=(), help="what tests import besides")
    parser.add_argument("--root", type=Path, default=ROOT, help="another project")
    parser.add_argument("--tests", nargs="+", default=TESTS)
    parser.add_argument("--preload", nargs="*", default=PRELOAD)
    parser.add_argument("--survivors", type=Path, default=None)
    options = parser.parse_args()
    options.seed = secrets.randbelow(10**6) if options.seed is None else options.seed
    options.survivors = options.survivors or options.root / "tests/mutation/survivors.toml"
    options.map = options.map or options.root / "tests/record/rows.xz"
    return options


def _drawn(
    project: Project, patterns: Iterable[str], count: int, seed: int
) -> tuple[list[Mutation], int]:
    """So many, at random; and of how many."""
    files = {path: None for pattern in patterns for path in project.files(pattern)}
    if not files:
        raise SystemExit(f"no Python file below {project.source} is named by {' '.join(patterns)}")
    every = [
        m
        for path in files
        for m in mutations(project.name(path), project.index(project.name(path)))
    ]
    chosen: list[Mutation] = []
    for mutation in random.Random(seed).sample(every, len(every)):
        if len(chosen) == count:
            break
        if parses(mutation.applied(project.index(mutation.file).text)):
            chosen.append(mutation)
    return chosen, len(every)


def _run_all(
    project: Project,
    chosen: list[Mutation],
    selection: Selection,
    keys: set[tuple[str, str, str, str]],
    options: argparse.Namespace,
) -> list[Outcome]:
    outcomes: list[Outcome] = []
    missed: list[Outcome] = []
    of_make_test = selection.record.chosen
    runner = Runner(project)
    begin = time.monotonic()
    for number, mutation in enumerate(chosen, 1):
        if options.minutes and time.monotonic() - begin > 60.0 * options.minutes:
            print(f"stopped after {options.minutes:g} minutes")
            break
        if options.proof:
            tests = selection.tests(mutation, of_make_test.__contains__)
        else:
            tests = selection.tests(mutation)
        outcome = runner.run(mutation, tests)
        if options.proof and outcome.verdict in (SURVIVED, UNTESTED):
            others = selection.tests(mutation, lambda name: name not in of_make_test)
            rest = runner.run(mutation, others)
            if rest.verdict in (KILLED, TIMED_OUT):
                missed.append(rest)
            outcome = rest if rest.verdict != UNTESTED else outcome
        outcomes.append(outcome)
        known = " (accepted)" if mutation.key in keys else ""
        print(
            f"{number:4} {outcome.verdict}{known} {outcome.seconds:.1f} s"
            f" {mutation.file}:{mutation.line} {mutation.function}:"
            f" {mutation.was[:80]} => {mutation.becomes[:80]} [{outcome.by}]",
            flush=True,
        )
    if options.proof:
        killed = sum(outcome.verdict in (KILLED, TIMED_OUT) for outcome in outcomes)
        print(
            f"\n{killed} of {len(outcomes)} are killed by any test, {len(missed)} not by make test:"
        )
        for outcome in missed:
            print(f"    {outcome.mutation.file}:{outcome.mutation.line} {outcome.by}")
    return outcomes


def _report(outcomes: list[Outcome], keys: set[tuple[str, str, str, str]]) -> None:
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for outcome in outcomes:
        lives = outcome.verdict in (SURVIVED, UNTESTED) and outcome.mutation.key in keys
        package = outcome.mutation.file.rpartition("/")[0] or "."
        counts[package][ACCEPTED if lives else outcome.verdict] += 1
    print()
    for package, counter in sorted(counts.items()):
        words = ", ".join(f"{counter[verdict]} {verdict}" for verdict in (*VERDICTS, ACCEPTED))
        print(f"{package}: {counter.total()} made, {words}")


def _report_stale(old: list[Accepted]) -> int:
    for entry in old:
        print(f"stale entry, the text has no such mutation any more: {entry}")
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main())
