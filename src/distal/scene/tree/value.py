"""What the objects that an author makes have in common: arguments can be read and replaced.

Input: the objects' own checked values, and the calls that made them. Output: arguments as an author
gives them, and other objects of the same kind. Does not depend on the objects' classes.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, TypeVar, cast

from distal.fields.guarantees import ended
from distal.frontend.problems import did_you_mean
from distal.ir.nodes import Cast, Uniform
from distal.lang.expressions import Expression
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Buffer
from distal.lang.source_places import author_place
from distal.scene.tree.conversion import Number
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import renamed
from distal.scene.tree.varying import VaryingNumber

if TYPE_CHECKING:
    from distal import library_stamp
    from distal.scene.tree import digests, paths, texts
else:
    library_stamp = LazyModule("distal.library_stamp")  # needs hashlib
    paths = LazyModule("distal.scene.tree.paths")
    texts = LazyModule("distal.scene.tree.texts")
    digests = LazyModule("distal.scene.tree.digests")  # needs hashlib and json

Made = TypeVar("Made")


class CallRecord:
    """The call that made an object; its arguments are bound when they are read.

    Attributes:
        factory: The class or the function.
        kind: The class of the object.
        state: The public attributes of a shape besides its node.
        made_with: The name, the material and the cut material of a shape that was made.
    """

    __slots__ = ("_args", "_given", "_kwargs", "factory", "kind", "made_with", "state")

    made_with: tuple[str, Any, Any]

    def __init__(
        self,
        factory: Callable[..., Any],
        args: tuple[Any, ...],
        kwargs: Mapping[str, Any],
        kind: type[Any],
        state: Mapping[str, Any] = MappingProxyType({}),
    ) -> None:
        self.factory, self.kind, self.state = factory, kind, state
        self.made_with = ("", None, None)
        self._args, self._kwargs = args, kwargs
        self._given: Mapping[str, Any] | None = None

    @property
    def parts(self) -> tuple[Any, ...]:
        """What it consists of, for pickles: the arguments of ``of_parts``."""
        return self.factory, self._args, self._kwargs, self.kind, self.state, self.made_with

    @classmethod
    def of_parts(cls, *parts: Any) -> CallRecord:
        """Return the record of ``parts``."""
        *made, made_with = parts
        record = cls(*made)
        record.made_with = made_with
        return record

    def __reduce__(self) -> Any:
        factory, args, kwargs, kind, state, made_with = self.parts
        return CallRecord.of_parts, (factory, args, dict(kwargs), kind, dict(state), made_with)

    @property
    def given(self) -> Mapping[str, Any]:
        """The arguments that were given, by name."""
        if self._given is None:
            signature = inspect.signature(self.factory)
            known = dict(signature.bind(*self._args, **self._kwargs).arguments)
            for name, parameter in signature.parameters.items():
                if parameter.kind is parameter.VAR_KEYWORD:
                    known.update(known.pop(name, {}))
            self._given = MappingProxyType(known)
        return self._given

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name, with the defaults of those that were not given."""
        known: dict[str, Any] = {}
        for name, parameter in inspect.signature(self.factory).parameters.items():
            if name in self.given or parameter.default is not parameter.empty:
                known[name] = self.given.get(name, parameter.default)
        return MappingProxyType({**known, **self.given})

    @property
    def alternatives(self) -> tuple[tuple[str, ...], ...]:
        """Groups of arguments of which at most one is given, as the factory declares them."""
        found: tuple[tuple[str, ...], ...] = getattr(self.factory, "alternatives", ())
        return found


class AuthorObject:
    """An object that an author makes; it never changes."""

    __slots__ = ()

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name, checked, in the declared order."""
        raise NotImplementedError

    def replace(self, **changes: Any) -> Self:
        """Return the object with other arguments, or with other arguments of its parts.

        Args:
            changes: The arguments that change, by name, or by path as ``paths`` shows them:
                ``scene.replace(**{"shape.children.0.radius": 2})``.

        Raises:
            SceneTypeError: An argument is unknown or of another type.
            SceneValueError: A number is beyond its limit, or there is no such part.
        """
        changed = self
        by_path = [name for name in changes if "." in name]
        paths.check_apart(by_path, changes)
        for path in by_path:
            changed = paths.replaced(changed, path, changes.pop(path))
        return changed._replaced(changes) if changes else changed

    def paths(self) -> dict[str, Any]:
        """Return the numbers and vectors of the object and of its parts, by path.

        ``replace`` takes the paths: ``{"children.0.radius": 1.0, "material.color": (1, 0, 0)}``.
        """
        return paths.numbers_of(self)

    def _replaced(self, changes: dict[str, Any]) -> Self:
        """Return the object with other arguments."""
        raise NotImplementedError

    def _parts(self) -> Mapping[str, Any]:
        """Return what a path leads to from here, by the name of the step."""
        return self.arguments

    def __replace__(self, /, **changes: Any) -> Self:
        return self.replace(**changes)

    def __eq__(self, other: object) -> bool:
        """Return whether an object is the same by value; where it was written does not count."""
        if self is other:
            return True
        if not isinstance(other, AuthorObject):
            return NotImplemented
        return self._digest() == other._digest()

    def __hash__(self) -> int:
        return int.from_bytes(self._digest()[:8], "little", signed=True)

    def __repr__(self) -> str:
        return texts.TextWriter().text(self)

    def _written(self, writer: texts.TextWriter) -> str:
        """Return the object as text that evaluates to an equal one, as far as there is one."""
        raise NotImplementedError

    def _compared(self) -> tuple[Any, ...]:
        """Return what equal objects have in common: the word for their kind, and values."""
        raise NotImplementedError

    def _digest(self) -> bytes:
        """Return 16 bytes that equal objects have in common; kept when they are first needed."""
        digest: bytes | None = getattr(self, "_kept_digest", None)
        if digest is None:
            digest = digests.digest_of(*self._compared())
            object.__setattr__(self, "_kept_digest", digest)
        return digest

    def _record(self, origin: CallRecord) -> None:
        """Keep the call that made the object."""
        raise NotImplementedError


class CalledValue(AuthorObject):
    """A value that holds calls of scene functions: a light, a camera, a material, a pattern.

    Attributes:
        noun: The word for such objects in messages.
    """

    __slots__ = ()

    noun: ClassVar[str]

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name, checked: colors are linear; a slider comes back as itself.

        Of arguments that exclude each other, that which was given.
        """
        checked = {n: value_of(v) for values in self._checked() for n, v in values.items()}
        origin = self._origin_or_none
        if origin is None:
            return MappingProxyType(checked)
        exclusive = {name for group in origin.alternatives for name in group}
        given = origin.arguments.items()
        return MappingProxyType(
            {n: v if n in exclusive or n not in checked else checked[n] for n, v in given}
        )

    def _pickled(self) -> Any:
        kinds = [kind for kind in type(self).__mro__ if "__slots__" in vars(kind)]
        names = {name for kind in kinds for name in vars(kind)["__slots__"]} - _NOT_PICKLED
        # What a subclass computes is no state, though its base has a slot of that name.
        names = {name for name in names if not isinstance(getattr(type(self), name), property)}
        state = {name: getattr(self, name) for name in sorted(names) if hasattr(self, name)}
        return _called_value, (type(self), library_stamp.library_stamp(), state)

    @property
    def _origin_or_none(self) -> CallRecord | None:
        """The call that made the object; None for what a scene makes, such as its camera."""
        return getattr(self, "_origin", None)

    def _with_origin_of(self, other: CalledValue) -> Self:
        """Keep the call that made another object, if it is known; return this one."""
        if (origin := other._origin_or_none) is not None:
            self._record(origin)
        return self

    def _written(self, writer: texts.TextWriter) -> str:
        origin = self._origin_or_none
        if origin is None:
            return f"<{self.noun} of the scene>"
        arguments = self.arguments
        return writer.call(origin.factory, {name: arguments[name] for name in origin.given})

    def _replaced(self, changes: dict[str, Any]) -> Self:
        """Return the object with other arguments.

        One that is instead of another, as ``fov`` of ``fov_deg``, displaces it.
        """
        origin = self._origin_or_none
        if origin is None:
            message = f"this {self.noun} was made by the scene: it cannot be changed"
            refuse(message, f"give the scene a {self.noun} of your own", author_place())
        groups = (set(group) for group in origin.alternatives)
        displaced = {name for group in groups if group & set(changes) for name in group}
        given = {n: v for n, v in origin.given.items() if n not in displaced}
        if inspect.isroutine(origin.factory):  # a class does so itself
            self._check_changes(origin.factory, changes)
        made: Self = origin.factory(**{**given, **changes})
        return made

    def _check_changes(self, factory: Any, changes: Mapping[str, Any]) -> None:
        """Refuse arguments that a factory does not have; one of a part has a path."""
        what, names = texts.name_of(factory).removeprefix("."), _fixed_names(factory)
        unknown = [] if names is None else [name for name in changes if name not in names]
        for name in unknown:
            for part, value in self.arguments.items():
                if isinstance(value, AuthorObject) and name in value.arguments:
                    hint = f'replace(**{{"{part}.{name}": …}})'
                    refuse_kind(f"{what} has no '{name}'", hint, author_place())
        _check_names(what, unknown, names or ())

    if not TYPE_CHECKING:  # a checker reports an unknown name itself

        def __getattr__(self, name):
            if not name.startswith("_"):
                arguments = self.arguments
                if name in arguments:
                    return arguments[name]
            raise AttributeError(f"a {self.noun} has no '{name}'", name=name, obj=self)

        def __dir__(self):
            return sorted({*super().__dir__(), *self.arguments})

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        """Yield the checked values of the calls that the object holds, by name."""
        raise NotImplementedError

    def _record(self, origin: CallRecord) -> None:
        object.__setattr__(self, "_origin", origin)


_NOT_PICKLED: Final = frozenset(("__weakref__", "_kept_digest"))


def _called_value(kind: type[CalledValue], stamp: str, state: Mapping[str, Any]) -> CalledValue:
    """Return a value from a pickle."""
    library_stamp.check_stamp(stamp)
    made = kind.__new__(kind)
    for name, value in state.items():
        object.__setattr__(made, name, value)
    return made


def recorded(made: Made) -> Made:
    """Keep the arguments of a class, or of a function that returns an object, with the object.

    Args:
        made: A class of values, a function, or a class method.
    """
    if isinstance(made, type):
        return cast("Made", _recorded_class(made))
    if isinstance(made, classmethod):
        return cast("Made", classmethod(_recorded_function(made.__func__, of_class=True)))
    return cast("Made", _recorded_function(cast("Any", made), of_class=False))


def refuses_unknown(method: Made) -> Made:
    """Let a method refuse arguments that it does not have as constructors do, with former names."""
    function: Any = method
    names = [*inspect.signature(function).parameters][1:]

    @functools.wraps(function)
    def call(self: Any, *args: Any, **kwargs: Any) -> Any:
        _check_names(function.__name__, kwargs, names)
        return function(self, *args, **kwargs)

    return cast("Made", call)


def argument(name: str) -> property:
    """Return the attribute that shows one argument of an object.

    A shape may have set it otherwise: a ``Gear`` its ``pressure_angle``, if none was given.
    """

    def read(value: Any) -> Any:
        own = getattr(value, "__dict__", {})
        known = own if name in own else value.arguments
        if name not in known:  # a material that is made by another function
            raise AttributeError(name)
        return known[name]

    return property(read, doc=f"The argument ``{name}``.")


def _fixed_names(function: Any) -> list[str] | None:
    """Return the names of a function's parameters; None if it takes any."""
    parameters = inspect.signature(function).parameters.values()
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return [parameter.name for parameter in parameters]


def _recorded_class(made: Any) -> Any:
    initialise = made.__init__
    parameters = list(inspect.signature(initialise).parameters.values())[1:]
    names = _fixed_names(initialise)

    @functools.wraps(initialise)
    def initialise_recorded(self: Any, *args: Any, **kwargs: Any) -> None:
        if names is not None:
            _check_names(made.__name__, kwargs, names[1:])
        initialise(self, *args, **kwargs)
        kind = type(self)
        # A class with an own constructor calls this one with other arguments.
        factory = kind if kind.__init__ is initialise_recorded else made
        self._record(CallRecord(factory, args, kwargs, factory, state_of(self)))

    made.__init__ = initialise_recorded
    for parameter in parameters:
        if parameter.kind not in _OF_MANY and not hasattr(made, parameter.name):
            setattr(made, parameter.name, argument(parameter.name))
    return made


def _check_names(what: str, given: Iterable[str], names: Sequence[str]) -> None:
    """Refuse arguments by name that there are not, at the author's line."""
    for name in given:
        if name not in names:
            hint = renamed(what, name) or did_you_mean(name, names)
            hint = hint or f"it takes {', '.join(names)}"
            refuse_kind(f"{what} has no '{name}'", hint, author_place())


_OF_MANY: Final = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def _recorded_function(function: Callable[..., Any], *, of_class: bool) -> Callable[..., Any]:
    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        value = function(*args, **kwargs)
        given = args[of_class:]
        if not any(value is one for one in _each_of((*given, *kwargs.values()))):
            factory = getattr(args[0], function.__name__) if of_class else call
            value._record(CallRecord(factory, given, kwargs, type(value)))
        return value

    return call


def _each_of(given: Iterable[Any]) -> Iterable[Any]:
    """Yield arguments, and those in lists and dicts."""
    for one in given:
        if isinstance(one, Mapping):
            yield from one.values()
        elif isinstance(one, list | tuple):
            yield from one
        else:
            yield one


def state_of(value: Any) -> dict[str, Any]:
    """Return the public attributes that a shape has besides its node."""
    own = getattr(value, "__dict__", {})
    return {n: v for n, v in own.items() if n != "node" and not n.startswith("_")}


def value_of(checked: Any, *, is_endless: bool = False) -> Any:
    """Return a checked value as an author gives it: a float, a tuple, a slider, an expression.

    A list of numbers or points comes back as a list; an array, which may be large, as a ``Buffer``.

    Args:
        checked: The value.
        is_endless: Whether numbers beyond all distances stand for infinity.
    """
    if isinstance(checked, VaryingNumber):
        return checked.expression
    if type(checked) is Buffer and isinstance(checked.data, list):
        return list(checked.data)
    if not isinstance(checked, Number):
        return checked
    value = checked.value
    if isinstance(value, Expression):
        node = value.node.value if isinstance(value.node, Cast) else value.node
        alone = isinstance(node, Uniform) and len(value.parameters) == 1
        return value.parameters[0] if alone else value
    if not is_endless:
        return value
    return tuple(map(ended, value)) if isinstance(value, tuple) else ended(value)
