"""Arguments by name of hand-written classes: refused at the author's line, as those of shapes are.

Input: a class. Output: the same, with a check before its ``__init__``, which editors see as it is
written. Does not check values.
"""

from __future__ import annotations

import inspect
from functools import wraps
from typing import Any, TypeVar

from distal.frontend.problems import did_you_mean
from distal.lang.source_places import author_place
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.former_names import renamed

C = TypeVar("C")


def checks_keywords(made: type[C]) -> type[C]:
    """Refuse arguments that ``__init__`` does not have, with the name that is meant in the hint."""
    initialize: Any = made.__init__
    what = made.__name__
    names = [name for name in inspect.signature(initialize).parameters if name != "self"]

    @wraps(initialize)
    def checked(self: C, *args: Any, **kwargs: Any) -> None:
        for name in kwargs:
            if name not in names:
                hint = renamed(what, name) or did_you_mean(name, names)
                hint = hint or f"it takes {', '.join(names)}"
                refuse_kind(f"{what} has no '{name}'", hint, author_place())
        initialize(self, *args, **kwargs)

    setattr(made, "__init__", checked)  # noqa: B010 (mypy refuses to assign to a method)
    return made
