"""Public lights, cameras, backgrounds, materials, patterns, made of declarations in ``render``.

Input: declarations of ``render``. Output: signatures and docstrings; calls of scene functions with
checked arguments; the classes and functions that authors call. Does not depend on what the
functions compute.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, Final, TypeVar

from distal.diagnostics import Span
from distal.fields.guarantees import Limit, Requirement
from distal.frontend.problems import did_you_mean
from distal.frontend.signatures.signatures import MISSING
from distal.ir.types import BOOL, FLOAT, INT, Texture, Type
from distal.ir.types import Buffer as BufferType
from distal.lang.functions import Func
from distal.lang.places import PLACES
from distal.lang.source_places import author_place
from distal.render.declarations import Declaration, ExtraParameter, Family
from distal.scene.tree.arguments import Accept, FunctionParameter, arguments, slots_of, takes_color
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.conversion import unwrapped
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.former_names import renamed
from distal.scene.tree.value import AuthorObject, CallRecord, argument

C = TypeVar("C")
V = TypeVar("V", bound=AuthorObject)

_BY_POSITION: Final = inspect.Parameter.POSITIONAL_OR_KEYWORD
_BY_NAME: Final = inspect.Parameter.KEYWORD_ONLY


# Signatures and docstrings for help() and editors


@cache
def signature_of(declaration: Declaration) -> inspect.Signature:
    """Return the signature that authors see, with defaults and types."""
    family = declaration.family
    before = [e for e in declaration.extras if not e.keyword_only]
    after = [e for e in declaration.extras if e.keyword_only]
    own = [s for s in slots_of(declaration.function) if s.name not in family.site]
    by_position = [s for s in own if s.name not in family.keyword_only]
    by_name = [s for s in own if s.name in family.keyword_only]
    return inspect.Signature(
        [
            *map(_extra, before),
            *(_parameter(slot, family) for slot in by_position),
            *map(_extra, after),
            *(_parameter(slot, family) for slot in by_name),
        ]
    )


def _extra(extra: ExtraParameter) -> inspect.Parameter:
    kind = _BY_NAME if extra.keyword_only else _BY_POSITION
    return inspect.Parameter(extra.name, kind, default=extra.default, annotation=extra.annotation)


def _parameter(slot: FunctionParameter, family: Family) -> inspect.Parameter:
    kind = _BY_NAME if slot.name in family.keyword_only else _BY_POSITION
    annotation = annotation_of(slot.type, is_color=takes_color(slot.name, family.colors))
    if family.varies and annotation in ("Number", "Vector", "Color"):
        annotation += " | Varying"
    default = inspect.Parameter.empty if slot.default is MISSING else unwrapped(slot.default)
    if slot.name in family.optional:
        annotation, default = f"{annotation} | None", None
    return inspect.Parameter(slot.name, kind, default=default, annotation=annotation)


def annotation_of(type: Type | None, *, is_color: bool = False) -> str:
    """Return the name of the type alias of values accepted for a scene function's parameter."""
    if isinstance(type, BufferType):
        return "Points"
    if isinstance(type, Texture):
        return "Image"
    if type in (INT, BOOL):
        return "int" if type is INT else "bool"
    if type is FLOAT:
        return "Number"
    return "Color" if is_color else "Vector"


def documentation_of(declaration: Declaration) -> str | None:
    """Return the scene function's docstring with the arguments that authors pass.

    None where Python keeps no docstrings (``python -OO``): nothing but ``help()`` reads them.
    """
    text = inspect.getdoc(declaration.function)
    if text is None:
        return None
    described = {e.name: _wrapped(f"{e.name}: {e.doc}") for e in declaration.extras}
    head, found, rest = text.partition("Args:\n")
    entries, separator, rest = rest.partition("\n\n")
    for entry in re.split(r"\n(?=    \S)", entries) if found else ():
        described[entry.strip().partition(":")[0]] = entry
    listed = [described[name] for name in signature_of(declaration).parameters]
    together = ", or numbers do not go together" if declaration.requires else ""
    raises = (
        f"    ValueError: A number is out of its range{together}.",
        "    TypeError: An argument is of another kind.",
    )
    parts = [head.rstrip(), "", "Args:", *listed, "", "Raises:", *raises]
    return "\n".join(parts) + separator + rest


def _wrapped(entry: str) -> str:
    return textwrap.fill(entry, 96, initial_indent=" " * 4, subsequent_indent=" " * 8)


# Calls


def given_arguments(
    declaration: Declaration,
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    what: str,
    place: Span | None,
) -> dict[str, Any]:
    """Return the author's arguments by name.

    None for an optional parameter counts as not passed.

    Args:
        declaration: The class or function that is called.
        args: Arguments by position.
        kwargs: Arguments by name.
        what: Its name in messages.
        place: The author's line.

    Raises:
        SceneTypeError: An argument is unknown, missing, passed twice, or surplus.
    """
    parameters = signature_of(declaration).parameters
    for name in kwargs:
        if name not in parameters:
            hint = renamed(what, name) or did_you_mean(name, parameters) or _takes(declaration)
            refuse_kind(f"{what} has no '{name}'", hint, place)
    try:
        bound = signature_of(declaration).bind_partial(*args, **kwargs).arguments
    except TypeError as error:
        message = f"{what}: {error}"
        refuse_kind(message, _takes(declaration), place)
    for name, parameter in parameters.items():
        if name not in bound and parameter.default is parameter.empty:
            refuse_kind(f"{what} needs '{name}'", _takes(declaration), place)
    optional = declaration.family.optional
    return {n: v for n, v in bound.items() if not (v is None and n in optional)}


def _takes(declaration: Declaration) -> str:
    return f"it takes {', '.join(signature_of(declaration).parameters)}"


def scene_call(
    family: Family,
    function: Func,
    given: Mapping[str, Any],
    what: str,
    place: Span | None,
    *,
    args: Sequence[Any] = (),
    limits: Mapping[str, Limit] | None = None,
    requires: Requirement | None = None,
    accept: Accept | None = None,
) -> FunctionCall:
    """Check values and return the call of a scene function.

    Args:
        family: The family's reserved parameters and limits.
        function: The scene function.
        given: Arguments by name.
        what: The name in messages.
        place: The author's line.
        args: Arguments by position.
        limits: Limits to use instead of the family's.
        requires: Returns why numbers contradict each other, or None.
        accept: Accepts objects that are not numbers; see ``scene.tree.arguments.Accept``.

    Raises:
        SceneTypeError: A value has the wrong type.
        SceneValueError: A number is out of its range, or contradicts others.
    """
    values = arguments(
        function,
        args,
        given,
        what=what,
        limits=family.limits if limits is None else limits,
        requires=requires,
        place=place,
        reserved=family.site,
        colors=family.colors,
        accept=accept,
        varies=PLACES & frozenset(family.site) if family.varies else frozenset(),
    )
    return FunctionCall(what, function, values, place)


def declared_call(
    declaration: Declaration,
    given: Mapping[str, Any],
    place: Span | None,
    *,
    what: str | None = None,
    accept: Accept | None = None,
) -> FunctionCall:
    """Check values and return the call of a declared scene function.

    ``given`` may also hold extra parameters.

    Args:
        declaration: The declaration of the scene function.
        given: Arguments by name.
        place: The author's line.
        what: The name in messages; the declaration's own name by default.
        accept: Accepts objects that are not numbers; see ``scene.tree.arguments.Accept``.
    """
    extras = {extra.name for extra in declaration.extras}
    return scene_call(
        declaration.family,
        declaration.function,
        {name: value for name, value in given.items() if name not in extras},
        what or declaration.name,
        place,
        limits=declaration.limits,
        requires=declaration.requires,
        accept=accept,
    )


# Classes and functions


def declared_class(declaration: Declaration, base: type[C]) -> type[C]:
    """Return the class of a declaration; ``base`` uses ``cls.declaration``."""
    body: dict[str, Any] = {
        "__slots__": (),
        "__doc__": documentation_of(declaration),
        "__module__": base.__module__,
        "__signature__": signature_of(declaration),
        "declaration": declaration,
        **{n: argument(n) for n in signature_of(declaration).parameters if not hasattr(base, n)},
    }
    return type(declaration.name, (base,), body)


def declared_function(
    declaration: Declaration,
    make: Callable[[Declaration, dict[str, Any], Span | None], V],
    module: str,
    returns: str,
) -> Callable[..., V]:
    """Return the public function of a declaration.

    Args:
        declaration: The declaration.
        make: Makes the object from the declaration, the arguments by name and the author's line.
        module: The module that authors import it from.
        returns: The name of the type that the function returns.
    """

    def made(*args: Any, **kwargs: Any) -> V:
        place = author_place()
        given = given_arguments(declaration, args, kwargs, declaration.name, place)
        value = make(declaration, given, place)
        value._record(CallRecord(made, (), given, type(value)))
        return value

    made.__name__ = made.__qualname__ = declaration.name
    made.__module__ = module
    made.__doc__ = documentation_of(declaration)
    signature = signature_of(declaration).replace(return_annotation=returns)
    made.__dict__["__signature__"] = signature
    return made
