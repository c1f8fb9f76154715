"""Record the operations of a function, and bound its derivatives by its inputs.

Input: a module, and values that may be anywhere between two ends: arguments, parameters, the time.
Output: steps as those of a tape, whose values and derivatives have intervals in many cells at once.
A tape has the coordinates of a point as inputs and one result; here every argument is an input, and
there are as many results as the function's has floats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.ir.nodes import Module
from distal.ir.types import Type, component_count
from distal.tape.derivative_bounds import JUMPS, Derivatives
from distal.tape.from_ir import PRECISION, followed
from distal.tape.interval_rules import Ends, interval_of
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.steps import TapeStep
from distal.tape.tape import TapeError

Doubles: TypeAlias = NDArray[np.float64]

# A step that is not computed: its ends are given.
_INPUT: Final = TapeStep("input", ())


class _RecordedScalars(Scalars):
    """Collects steps; equal ones are one value.

    Attributes:
        steps: The steps.
        known: The ends of inputs that are known from the beginning, by step.
    """

    def __init__(self) -> None:
        super().__init__(PRECISION)
        self.steps: list[TapeStep] = []
        self.known: dict[int, Ends] = {}
        self._places: dict[Any, int] = {}

    def value(self, scalar: Scalar) -> int:
        """Return the step of a scalar."""
        if isinstance(scalar, Varying):
            return scalar.value
        number = float(scalar)
        # Zeros of both signs are equal as keys, and NaN is not equal to itself: so text.
        return self._added(repr(number), TapeStep("const", (), number))

    def operation(self, name: str, *operands: Scalar) -> Varying:
        """Add an operation."""
        places = tuple(self.value(operand) for operand in operands)
        if name == "mul" and places[0] == places[1]:
            name, places = "square", places[:1]
        step = TapeStep(name, places)
        return Varying(self._added(step, step))

    def input(self, ends: Ends | None) -> Varying:
        """Add a value that is not computed: one between two ends, or one given later."""
        at = self._added(object(), _INPUT)
        if ends is not None:
            self.known[at] = ends
        return Varying(at)

    def _added(self, key: Any, step: TapeStep) -> int:
        at = self._places.get(key)
        if at is None:
            at = self._places[key] = len(self.steps)
            self.steps.append(step)
        return at


class RecordedFunction:
    """The operations of a function.

    Args:
        module: The module.
        types: The types of the entry's parameters.
        uniforms: The ends of those uniforms that are no constants, for each component.
        resources: Buffers by name.

    Attributes:
        inputs: The steps of the components of each parameter.
        results: The steps of the floats of the result.

    Raises:
        TapeError: The function has something that cannot be recorded.
    """

    def __init__(
        self,
        module: Module,
        types: Sequence[Type],
        uniforms: Mapping[str, Sequence[Ends]],
        resources: Mapping[str, Any],
    ) -> None:
        scalars = _RecordedScalars()
        args = [tuple(scalars.input(None) for _ in range(component_count(t))) for t in types]
        known = {name: tuple(map(scalars.input, ends)) for name, ends in uniforms.items()}
        found = followed(module, args, known, resources, scalars)
        self.results = [scalars.value(scalar) for scalar in found]
        self.inputs = [[scalar.value for scalar in arg] for arg in args]
        self._steps, self._known = scalars.steps, scalars.known

    def values(self, inputs: Sequence[Sequence[Ends]]) -> Doubles:
        """Return the ends of each step in each cell, (steps, 2, cells); NaN where nothing is known.

        Args:
            inputs: The ends of the components of each parameter, (cells,) each.
        """
        given = dict(self._known)
        for places, parts in zip(self.inputs, inputs, strict=True):
            given |= zip(places, parts, strict=True)
        count = max((low.size for low, _ in given.values()), default=1)
        held: list[Ends] = []
        with np.errstate(all="ignore"):
            for i, step in enumerate(self._steps):
                if step.name == "const":
                    number = np.asarray(step.number)
                    held.append((number, number))
                else:
                    own = given.get(i)
                    operands = (held[k] for k in step.operands)
                    held.append(interval_of(step.name, *operands) if own is None else own)
        ends = [[np.broadcast_to(end, (count,)) for end in pair] for pair in held]
        return np.array(ends, np.float64)

    def refuse_jumps(self) -> None:
        """Refuse a function that may jump: its derivatives say nothing of its slope.

        Raises:
            TapeError: It may jump.
        """
        names = {step.name for step in self._steps}
        if jumps := sorted(names & {*JUMPS}):
            raise TapeError(f"it may jump: it uses {jumps[0]}")

    def reads(self, parameter: int) -> list[int]:
        """Return which components of a parameter the results depend on."""
        needed = set(self.results)
        for i in range(len(self._steps) - 1, -1, -1):
            if i in needed:
                needed.update(self._steps[i].operands)
        return [axis for axis, at in enumerate(self.inputs[parameter]) if at in needed]

    def derivatives(self, values: Doubles, parameter: int) -> list[tuple[Doubles, Doubles]]:
        """Return the derivatives of each result by the components of a parameter.

        Returns:
            For each result its derivatives' ends, (2, components, cells), and a bound on the length
            of all of them together, (cells,). NaN or infinite where nothing is known.

        Args:
            values: Those that ``values`` returned.
            parameter: The position of the parameter.
        """
        axes = {at: axis for axis, at in enumerate(self.inputs[parameter])}
        return Derivatives(self._steps, values, len(axes), axes).of(self.results)
