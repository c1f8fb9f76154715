"""Lower each function of the library once a process, for each list of argument types.

Input: what a compilation was asked for while it lowered a function. Output: the same functions in a
later compilation, without lowering them again. Functions of the library do not change, so that what
comes of them depends on the names that are free, and on the structs of the program: each request is
repeated, and where its answer differs, the function is lowered as if nothing was known.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

from distal.frontend.lowering.instances import Instance
from distal.ir.nodes import Function
from distal.ir.types import Type
from distal.lang.functions import Overload, is_fixed
from distal.session import SESSION

if TYPE_CHECKING:
    from distal.frontend.lowering.compilation import Compilation

RECIPES_KEPT: Final = 4096

What: TypeAlias = Literal["name", "struct", "signature", "instance", "builtin", "function"]


@dataclass(frozen=True, slots=True)
class Step:
    """A request to the compilation, and its answer."""

    what: What
    asked: tuple[Any, ...]
    answer: Any


@dataclass(slots=True, eq=False)
class Recording:
    """What one function asks for while it is lowered; callees have recordings of their own.

    Attributes:
        steps: The requests, in order.
        is_lasting: Whether all of them can be repeated: those for the author's objects cannot.
    """

    steps: list[Step] = field(default_factory=list)
    is_lasting: bool = True
    _signatures: set[Overload] = field(default_factory=set)

    def add(self, what: What, asked: tuple[Any, ...], answer: Any) -> None:
        """Record a request; a signature once."""
        if what == "signature":
            if answer in self._signatures:
                return
            self._signatures.add(answer)
        self.steps.append(Step(what, asked, answer))


@dataclass(frozen=True, slots=True)
class Recipe:
    """The steps that make a function."""

    steps: tuple[Step, ...]
    source_name: str
    result: Type


_recipes: OrderedDict[tuple[Overload, tuple[Type, ...]], Recipe] = SESSION.keep(
    "recipes", OrderedDict()
)


def repeated(
    compilation: Compilation, overload: Overload, types: tuple[Type, ...]
) -> Instance | None:
    """Return an instance made as before; None if it was not made, or an answer differs now.

    Args:
        compilation: The compilation that gets the function.
        overload: The function.
        types: The types of its parameters.
    """
    recipe = _recipes.get((overload, types))
    if recipe is None:
        return None
    names: list[str] = []
    added: list[Function] = []
    with compilation.recording():
        for step in recipe.steps:
            if not _same(step, compilation, names, added):
                compilation.withdraw(names, added)
                return None
    return Instance(names[0], recipe.source_name, types, recipe.result)


def _same(step: Step, compilation: Compilation, names: list[str], added: list[Function]) -> bool:
    """Repeat a request; return whether its answer is the same."""
    match step.what:
        case "name":
            names.append(compilation.unique_name(*step.asked))
            return bool(names[-1] == step.answer)
        case "struct":
            return compilation.adopt(step.asked[0]) is step.answer
        case "signature":
            compilation.signature(step.answer)
        case "function":
            compilation.add(step.answer)
            added.append(step.answer)
        case "instance":
            return bool(compilation.instance_of(*step.asked).name == step.answer)
        case "builtin":
            return bool(compilation.builtin_function(*step.asked).name == step.answer)
    return True


def keep(
    overload: Overload, types: tuple[Type, ...], recording: Recording, instance: Instance
) -> None:
    """Keep how a function was made, if it is the library's and nothing of the author's is in it."""
    if not recording.is_lasting or instance.result is None or not is_fixed(overload):
        return
    steps = tuple(recording.steps)
    _recipes[overload, types] = Recipe(steps, instance.source_name, instance.result)
    if len(_recipes) > RECIPES_KEPT:
        _recipes.popitem(last=False)
