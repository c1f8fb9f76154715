"""The list of survivors that are accepted, each with its reason.

Input: a TOML file. Output: entries, and what is wrong with them. An entry is known
by its file, its function and its line before and after, so that lines may move; when the line
changes, the entry is stale.
"""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

from tools.mutation.operators import Mutation, mutations
from tools.mutation.project import Project

WHY = ("equivalent", "performance", "tolerance", "choice")
_PARTS = ("file", "function", "was", "becomes", "why", "reason")


@dataclass(frozen=True)
class Accepted:
    """A survivor that may live.

    Attributes:
        key: File, function, line before, line after.
        why: ``equivalent`` (no input tells them apart), ``performance`` (the result is as right),
            ``tolerance`` (within what is claimed), ``choice`` (a number that could be another, such
            as a default, which the reference states and a test holds the reference to).
        reason: Why that is so.
    """

    key: tuple[str, str, str, str]
    why: str
    reason: str


def accepted(path: Path) -> list[Accepted]:
    """The entries of the list.

    Raises:
        SystemExit: One lacks something.
    """
    if not path.exists():
        return []
    entries = []
    for row in tomllib.loads(path.read_text("utf-8")).get("survivor", []):
        if set(row) != set(_PARTS) or row["why"] not in WHY or not row["reason"].strip():
            words = f"each survivor has {', '.join(_PARTS)}; why is one of {', '.join(WHY)}"
            raise SystemExit(f"{path.name}: {words}: {row}")
        key = (row["file"], row["function"], row["was"], row["becomes"])
        entries.append(Accepted(key, row["why"], row["reason"]))
    return entries


def stale(project: Project, entries: list[Accepted]) -> list[Accepted]:
    """Entries that name no mutation of the text as it is now."""
    files = {entry.key[0] for entry in entries}
    known: set[tuple[str, str, str, str]] = set()
    for file in files:
        if (project.source / file).exists():
            known |= {mutation.key for mutation in mutations(file, project.index(file))}
    return [entry for entry in entries if entry.key not in known]


def entry_text(mutation: Mutation) -> str:
    """A survivor as it is put into the list; the reason is the author's to find."""
    parts = (*mutation.key, "", "")
    lines = [f"{n} = {json.dumps(p)}" for n, p in zip(_PARTS, parts, strict=True)]
    return "\n".join(["[[survivor]]", *lines])
