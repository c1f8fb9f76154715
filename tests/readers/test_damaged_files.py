"""Damaged files of every kind end in one line, and in nothing else: a sample of the sweep."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from tests.readers.damage import REFUSALS, SUBJECTS, Subject, damaged

COUNT = 15


@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda s: f"{s.kind}-{s.name}")
def test_damaged_files_are_read_or_refused_in_one_line(tmp_path: Path, subject: Subject) -> None:
    whole = subject.made()
    path = tmp_path / subject.name
    path.write_bytes(whole)
    subject.read(path)  # undamaged
    for number in range(COUNT):
        path.write_bytes(damaged(whole, number))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                subject.read(path)
        except REFUSALS as error:
            lines = str(error).split("\n")
            assert lines[0].strip()
            # What follows is the author's line, or that of the file.
            assert len(lines) == 1 or lines[1].lstrip().startswith("-->")
            assert "more memory than there is" not in lines[0]


@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda s: f"{s.kind}-{s.name}")
def test_files_and_their_damage_are_the_same_each_time(subject: Subject) -> None:
    if subject.kind == "film":  # a zip archive has the time
        pytest.skip("its archive has the time in it")
    whole = subject.made()
    assert subject.made() == whole
    assert [damaged(whole, n) for n in range(4)] == [damaged(whole, n) for n in range(4)]
