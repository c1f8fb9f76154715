"""A sample of cases: the same each time, at least one of each group, all of them when asked."""

from __future__ import annotations

import pytest

from tests.selection import VARIABLE, drawn_last

pytest_plugins = ["pytester"]

CASES = """
import pytest

@pytest.mark.sample(3)
@pytest.mark.parametrize("number", range(30))
def test_one_of_three(number):
    pass

@pytest.mark.sample(4, each="name")
@pytest.mark.parametrize("target", ["glsl", "wgsl"])
@pytest.mark.parametrize("name", "abcdef")
def test_each(name, target):
    pass

def test_other():
    pass
"""
HOOKS = "from tests.selection import *\n"


@pytest.fixture
def trial(pytester, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    pytester.makeconftest(HOOKS)
    pytester.makepyfile(test_trial=CASES)
    return pytester


def passed(trial, *words):
    """Names of the cases that ran, and what pytest printed."""
    done = trial.inline_run("-q", "-p", "no:cacheprovider", *words)
    return [report.nodeid.partition("::")[2] for report in done.listoutcomes()[0]]


def test_one_of_three_cases_runs_and_one_of_each_name(trial, capsys):
    names = passed(trial)
    said = capsys.readouterr().out
    numbers = [name for name in names if name.startswith("test_one")]
    each = [name for name in names if name.startswith("test_each")]
    assert len(numbers) == 10
    assert sorted(name[len("test_each[")] for name in each) == [*"abcdef"]
    assert {name[-5:-1] for name in each} == {"glsl", "wgsl"}
    assert "test_other" in names
    assert "26 cases of sampled tests were left out: `make sweep` runs each case" in said
    assert passed(trial) == names


def test_every_case_runs_when_asked(trial, monkeypatch, capsys):
    monkeypatch.setenv(VARIABLE, "1")
    assert len(passed(trial)) == 30 + 12 + 1
    assert "left out" not in capsys.readouterr().out


def test_a_named_case_runs(trial):
    for number in range(6):
        name = f"test_one_of_three[{number}]"
        assert passed(trial, f"test_trial.py::{name}") == [name]


def test_a_sample_does_not_depend_on_other_choices(trial):
    names = [name for name in passed(trial) if name.startswith("test_one")]
    assert passed(trial, "-k", "one_of_three") == names


@pytest.mark.parametrize(("count", "of", "kept"), [(1, 5, 1), (5, 5, 1), (6, 5, 2), (7, 1, 7)])
def test_a_sample_is_one_of_so_many_and_at_least_one(count, of, kept):
    names = [str(number) for number in range(count)]
    assert len(names) - len(drawn_last(names, of)) == kept
