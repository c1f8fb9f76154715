"""The record: what a test runs is seen, kept and found again; the choice covers what it claims."""

from __future__ import annotations

import ast
import itertools
import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from tools.mutation.project import Project
from tools.record import packages, reach
from tools.record.choice import cases, chosen, cover, pinned, run_by
from tools.record.reach import parts
from tools.record.rows import PATH, ROOT, Plan, Record, load, merged, plan, raw_rows

SOURCE = '''\
"""Made for the test."""
import os
import subprocess
import sys

LIMIT = 3


def direct():
    return inner()


def inner():
    return [n for n in range(LIMIT)]


def unused():
    return 1


def child():
    code = "from small.made import in_child; in_child()"
    subprocess.run([sys.executable, "-c", code], check=True)


def in_child():
    return 2


def forks():
    pid = os.fork()
    if pid == 0:
        in_fork()
        os._exit(0)
    os.waitpid(pid, 0)


def in_fork():
    return 3
'''
TESTS = """\
import subprocess
import sys

import pytest
from small.made import *

BUSY = "import time\\nwhile time.process_time() < 0.3: pass\\nprint(flush=True)\\ntime.sleep(60)"


@pytest.fixture(scope="module")
def processes():
    started = []
    yield started
    for each in started:
        each.kill()


def test_child_that_outlives_it(processes):
    processes.append(subprocess.Popen([sys.executable, "-c", BUSY], stdout=subprocess.PIPE))
    processes[0].stdout.readline()


@pytest.fixture(scope="module")
def shared():
    return inner()


def test_direct():
    direct()


def test_again():
    direct()


def test_child():
    child()


def test_forks():
    forks()


def test_of_a_fixture(shared):
    assert shared == [0, 1, 2]


def test_of_the_same_fixture(shared):
    pass
"""
RAN = {
    "test_direct": {"direct", "inner"},
    "test_again": {"direct", "inner"},
    "test_child": {"child", "in_child"},
    "test_child_that_outlives_it": set(),
    "test_forks": {"forks", "in_fork"},
    "test_of_a_fixture": {"inner"},
    "test_of_the_same_fixture": {"inner"},
}


def random_record(seed: int, tests: int = 9, functions: int = 12) -> Record:
    drawn = random.Random(seed)
    names = [f"a.py:f{i}" for i in range(functions)]
    rows = {
        f"tests/t.py::t{i}": (
            drawn.uniform(0.01, 2.0),
            set(drawn.sample(names, drawn.randint(1, 5))),
        )
        for i in range(tests)
    }
    return merged(rows, {n: "1" for n in names}, None)


@pytest.mark.parametrize("seed", range(5))
def test_a_cover_runs_each_function_for_about_the_least_time(seed):
    record = random_record(seed)
    every, found = run_by(record, record.rows), cover(record)
    assert run_by(record, found) == every
    best = min(
        record.seconds(tests)
        for count in range(len(record.rows) + 1)
        for tests in itertools.combinations(record.rows, count)
        if run_by(record, tests) == every
    )
    assert record.seconds(found) <= 1.5 * best + 0.2


def test_pins_stay_in_a_cover():
    record = random_record(1)
    longest = max(record.rows, key=lambda name: record.rows[name].seconds)
    found = cover(record, [longest])
    assert longest in found
    assert run_by(record, found) == run_by(record, record.rows)


def test_what_costs_little_is_chosen_and_cases_as_the_time_allows():
    seconds = {
        "tests/a.py::cheap[1]": 0.1,
        "tests/a.py::cheap[2]": 0.1,
        "tests/a.py::cheap[3]": 0.9,
        "tests/a.py::middling[1]": 0.8,
        "tests/a.py::middling[2]": 0.7,
        "tests/a.py::long": 3.0,
        "tests/a.py::longer": 9.0,
        "tests/meta/a.py::rule": 3.0,
    }
    rows = {name: (s, {"f"}) for name, s in seconds.items()}
    rows["tests/a.py::longer"] = (9.0, {"g"})
    record = merged(rows, {"f": "1", "g": "1"}, None)
    cheap = {"tests/a.py::cheap[1]", "tests/a.py::cheap[2]", "tests/meta/a.py::rule"}
    assert pinned(record) == cheap
    covers = cheap | {"tests/a.py::longer"}
    assert cases(record, covers) == ["tests/a.py::middling[2]", "tests/a.py::long"]
    assert chosen(record, 12.3) == covers
    assert chosen(record, 13.0) == covers | {"tests/a.py::middling[2]"}
    assert chosen(record, 99.0) == covers | {"tests/a.py::middling[2]", "tests/a.py::long"}
    with pytest.raises(ValueError, match="a cover takes 12 s; 12 are allowed"):
        chosen(record, 12.0)


def test_a_record_is_the_same_after_it_was_kept(tmp_path):
    record = random_record(3)
    kept = Record(record.functions, record.rows, record.digests, frozenset([*record.rows][:2]))
    path = tmp_path / "rows.xz"
    kept.save(path)
    assert load(path) == kept
    assert plan(path).left_out == set([*record.rows][2:])
    assert plan(path).seconds == {name: row.seconds for name, row in record.rows.items()}
    first = path.read_bytes()
    load(path).save(path)
    assert path.read_bytes() == first


def test_without_a_record_nothing_is_left_out(tmp_path):
    assert plan(tmp_path / "rows.xz") == Plan({}, frozenset())


def test_new_rows_replace_old_ones_and_the_rest_stays():
    before = merged({"a": (1.0, {"f", "g"}), "b": (2.0, {"g"})}, {"f": "1", "g": "1"}, None)
    after = merged({"a": (3.0, {"f", "h"})}, {"f": "2", "g": "2", "h": "2"}, before)
    assert {t: (r.seconds, set(after.names(r.functions))) for t, r in after.rows.items()} == {
        "a": (3.0, {"f", "h"}),
        "b": (2.0, {"g"}),
    }
    # b was recorded with the old g: it is run again.
    assert after.digests == {"f": "2", "g": "1", "h": "2"}
    assert after.running(["g"]) == {"b"}
    assert after.running(["f", "unknown"]) == {"a"}
    assert after.chosen == frozenset()


def test_make_test_runs_a_test_that_is_new_to_the_record():
    before = merged({"a": (1.0, {"f"})}, {"f": "1"}, None)
    assert merged({"a": (1.0, {"f"}), "b": (1.0, {"f"})}, {"f": "1"}, before).chosen == {"b"}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_what_tests_run_is_recorded_in_children_and_forks_too(tmp_path):
    package, out = tmp_path / "src/small", tmp_path / "out"
    package.mkdir(parents=True)
    out.mkdir()
    (tmp_path / "tests").mkdir()
    (package / "__init__.py").touch()
    (package / "made.py").write_text(SOURCE)
    (tmp_path / "tests/test_made.py").write_text(TESTS)
    paths = [ROOT / "tools/record/in_children", tmp_path / "src", ROOT / "src", ROOT]
    outside = {k: v for k, v in os.environ.items() if k != "DISTAL_RECORD_TEST"}
    environment = {
        **outside,
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "DISTAL_RECORD": str(out),
        "DISTAL_RECORD_SOURCE": f"{tmp_path / 'src'}{os.sep}",
    }
    command = [sys.executable, "-W", "ignore", "-m", "pytest", "-q", "-p", "tools.record.plugin"]
    made = subprocess.run(
        [*command, "-p", "no:cacheprovider", "tests"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    rows = raw_rows(out)
    found = {
        name.partition("::")[2]: {f.removeprefix("small/made.py:") for f in functions}
        for name, (_, functions) in rows.items()
    }
    assert found == RAN
    assert all(seconds < 60.0 for seconds, _ in rows.values())
    assert rows["tests/test_made.py::test_child"][0] > rows["tests/test_made.py::test_again"][0]
    assert rows["tests/test_made.py::test_child_that_outlives_it"][0] > 0.25


def test_the_parts_of_a_module_are_functions_and_statements():
    functions, others = parts(
        '"""Words."""\nimport os\nA = 1\n\ndef f(): return A\n\n'
        'class C(B):\n    """D."""\n    x = 2\n    def g(self): pass\n'
    )
    assert set(functions) == {"f", "C.g"}
    assert set(others) == {"A = 1", "class C(B):", "C.    x = 2"}


@pytest.fixture
def changed(tmp_path, monkeypatch):
    """Return a function that edits a small project and says which tests the change reaches."""
    (tmp_path / "src/p").mkdir(parents=True)
    (tmp_path / "tests").mkdir()
    texts = {
        "src/p/a.py": "SIZE = 2\n\ndef f():\n    return 1\n\ndef setup():\n    return 1\n",
        "src/p/b.py": "from p.a import SIZE, setup\nx = setup()\n\ndef g():\n    return SIZE + x\n",
        "tests/test_a.py": "def test_f(): pass\n",
        "tests/helper.py": "def help(): pass\n",
        "README.md": "words\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    for words in (
        "init -q",
        "add .",
        "-c user.name=a -c user.email=b -c commit.gpgsign=false commit -qm a",
    ):
        subprocess.run(["git", *words.split()], cwd=tmp_path, check=True)
    monkeypatch.setattr(reach, "ROOT", tmp_path)
    rows = {
        "tests/test_a.py::test_f": (0.1, {"p/a.py:f"}),
        "tests/test_b.py::test_g": (0.1, {"p/b.py:g"}),
        "tests/meta/test_m.py::test_m": (0.1, set()),
    }
    record = merged(rows, reach.digests(), None)

    def edit(name: str, old: str, new: str) -> set[str]:
        path = tmp_path / name
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))
        found = reach.tests_for(record, "HEAD")
        return {name.partition("::")[2] for tests in found.values() for name in tests}

    return edit


@pytest.mark.parametrize(
    ("file", "old", "new", "reached"),
    [
        ("src/p/a.py", "    return 1\n\ndef setup", "    return 2\n\ndef setup", {"test_f"}),
        ("src/p/a.py", "SIZE = 2", "SIZE = 3", {"test_g"}),  # in another file
        ("src/p/a.py", "def setup():\n    return 1", "def setup():\n    return 2", {"test_g"}),
        ("src/p/b.py", "x = setup()", "x = setup() + 1", {"test_g"}),
        ("src/p/a.py", "SIZE = 2", "# a comment\nSIZE = 2", set()),
        ("tests/test_a.py", "pass", "assert True", {"test_f"}),
        ("tests/helper.py", "pass", "return", {"test_f", "test_g", "test_m"}),
        ("README.md", "words", "other words", {"test_m"}),
    ],
    ids=["function", "constant", "at import", "statement", "comment", "test", "helper", "text"],
)
def test_a_change_reaches_the_tests_that_it_can_break(changed, file, old, new, reached):
    assert changed(file, old, new) == reached


def test_there_is_no_such_revision(changed, monkeypatch):
    with pytest.raises(SystemExit, match="git diff --name-only no-such-thing"):
        reach.tests_for(merged({}, {}, None), "no-such-thing")


# The record of this project


@pytest.fixture(scope="module")
def record() -> Record:
    return load(PATH)


def test_the_tests_of_make_test_run_every_function_that_any_test_runs(record):
    every, here = 0, 0
    for name, row in record.rows.items():
        every |= row.functions
        here |= row.functions if name in record.chosen else 0
    assert every == here


def test_most_functions_of_the_source_are_in_the_record(record):
    now = set(reach.digests())
    assert len(now & set(record.functions)) > 0.8 * len(now)


def test_the_map_of_packages_names_folders_that_run_most_of_them(record):
    rows = packages.rows_of((ROOT / "CONTRIBUTING.md").read_text("utf-8"))
    here = {p.stem for p in (ROOT / "src/distal").iterdir() if p.suffix == ".py" or p.is_dir()}
    functions = packages.functions_of(record)
    assert rows.keys() == functions.keys()
    assert rows.keys() <= here
    for package, folders in rows.items():
        assert all((ROOT / folder).exists() for folder in folders), package
        assert packages.share(record, functions[package], folders) > 0.9, package


def test_functions_are_named_as_python_names_them():
    project = Project(ROOT, ROOT / "src", ())
    names = set(project.index("distal/session.py").functions)
    assert {"CompilerSession.keep", "CompilerSession.fresh"} <= names
    assert ast.parse(json.dumps(sorted(names)))


def test_places_of_others_exist():
    for start, tests in reach.OTHERS.items():
        for place in (start, *tests):
            assert (Path(ROOT) / place).exists(), place
