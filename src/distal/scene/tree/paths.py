"""Paths of parts: ``"shape.children.0.radius"`` names one number of a scene.

Input: an author's object. Output: the numbers in it by path; the object with another part at a
path. Does not depend on the objects' classes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from distal.frontend.problems import did_you_mean
from distal.lang.expressions import Expression
from distal.lang.parameters import Parameter
from distal.lang.source_places import author_place
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.scene.tree.value import AuthorObject


def numbers_of(whole: AuthorObject) -> dict[str, Any]:
    """Return the numbers and vectors of an object and of its parts, by path, in their order."""
    numbers: dict[str, Any] = {}
    waiting: list[tuple[str, Any]] = [("", whole)]
    while waiting:
        path, part = waiting.pop()
        if _is_number(part):
            numbers[path] = part
            continue
        below = ((f"{path}.{step}" if path else step, inner) for step, inner in _steps(part))
        waiting.extend(reversed(list(below)))
    return numbers


def check_apart(paths: Iterable[str], names: Iterable[str]) -> None:
    """Check that no path leads into what is replaced as a whole.

    Args:
        paths: The paths.
        names: All that is replaced, the paths too.

    Raises:
        SceneValueError: One does.
    """
    whole = set(names)
    for path in paths:
        steps = path.split(".")
        for count in range(1, len(steps)):
            if (above := ".".join(steps[:count])) in whole:
                message = f"'{path}' is a part of '{above}', which is replaced too"
                refuse(message, "replace one of them", author_place())


def replaced(whole: Any, path: str, value: Any) -> Any:
    """Return an object with another part at a path.

    Args:
        whole: The object.
        path: Names and numbers with dots between them.
        value: The part.

    Raises:
        SceneValueError: There is no such part.
    """
    steps = path.split(".")
    owners = [whole]
    for count, step in enumerate(steps[:-1], 1):
        owners.append(_part(owners[-1], step, steps[:count]))
    for count in range(len(steps), 0, -1):
        value = _with_part(owners.pop(), steps[count - 1], value, steps[:count])
    return value


def _is_number(part: Any) -> bool:
    if isinstance(part, Expression | Parameter):
        return True
    if isinstance(part, tuple):
        return bool(part) and all(isinstance(one, int | float | Expression) for one in part)
    return isinstance(part, int | float) and not isinstance(part, bool)


def _steps(part: Any) -> Iterator[tuple[str, Any]]:
    """Yield the steps from an object, and where each leads."""
    if hasattr(part, "_parts"):
        yield from part._parts().items()
    elif isinstance(part, Mapping):
        yield from ((str(name), inner) for name, inner in part.items())
    elif isinstance(part, list | tuple):
        yield from ((str(number), inner) for number, inner in enumerate(part))


def _part(owner: Any, step: str, path: Sequence[str]) -> Any:
    parts = dict(_steps(owner))
    if step not in parts:
        _refuse_step(owner, path, list(parts))
    return parts[step]


def _with_part(owner: Any, step: str, value: Any, path: Sequence[str]) -> Any:
    """Return an object with another part, one step below it."""
    if hasattr(owner, "_parts"):
        return owner.replace(**{step: value})
    _part(owner, step, path)
    if isinstance(owner, Mapping):
        return {**owner, step: value}
    changed = list(owner)
    changed[int(step)] = value
    return type(owner)(changed)


def _refuse_step(owner: Any, path: Sequence[str], steps: Sequence[str]) -> None:
    step = path[-1]
    if hasattr(owner, "_parts") and step in owner.arguments:
        message = f"'{step}' has no parts that can be replaced: it was not given"
        refuse(message, f"give it: replace({step}=…)", author_place())
    hint = did_you_mean(path[-1], steps) or (
        f"it has {', '.join(steps)}" if steps else "it has no parts"
    )
    where = ".".join(path[:-1])
    message = f"there is no '{path[-1]}' in '{where}'" if where else f"there is no '{path[-1]}'"
    refuse(message, hint, author_place())
