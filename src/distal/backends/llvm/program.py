"""Translate one module to LLVM text.

Input: a module after the passes, and the shape of the machine's vectors. Output: the text of an
LLVM module with the kernels that are needed: pixels of a picture, the per-frame part, a batch of
points. A function that is not inlined becomes an LLVM function, once for each set of varying
arguments.
"""

from __future__ import annotations

from collections import Counter

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.costs import LaneCosts
from distal.backends.llvm.expressions import LaneExpressions
from distal.backends.llvm.lanes import Lanes, Leaf, Leaves, leaf_kinds
from distal.backends.llvm.layout import JOB_OFFSET, KernelLayout
from distal.backends.llvm.statements import Statements
from distal.backends.llvm.storage import Mask
from distal.backends.llvm.uniformity import Uniformity
from distal.backends.llvm.writer import LlvmWriter
from distal.diagnostics import CompileError
from distal.ir.nodes import Call, Expr, Function, Module
from distal.ir.types import Kind
from distal.ir.walk import expressions_in

# The register width of each level, so that LLVM neither splits nor avoids full vectors.
_REGISTER_BITS = {"avx512": 512, "avx2": 256, "sse4.2": 128, "neon": 128}

INLINE_COST = 120
# Arrays are on a thread's stack, with a value for each lane; ``devices.threads`` enlarges it.
ARRAY_BYTES = 8 * 2**20
_SMALL_ARRAY_BYTES = 2**18


class LaneProgram:
    """The state that the functions of one LLVM module share.

    Attributes:
        module: The IR module.
        lanes: The vector shape.
        layout: The slots of the inputs.
        costs: The costs of functions and blocks.
        declarations: Declarations of LLVM intrinsics.
        polls: Whether a loop checks the stop flag.
    """

    def __init__(self, module: Module, lanes: Lanes) -> None:
        self.module = module
        self.lanes = lanes
        self.layout = KernelLayout.of(module)
        self.costs = LaneCosts(module.functions)
        self.declarations: set[str] = set()
        self.polls = False
        self._array_bytes = 0
        self._functions = {f.name: f for f in module.functions}
        self._sites = Counter(
            e.function
            for f in module.functions
            for e in expressions_in(f.body)
            if isinstance(e, Call)
        )
        self._variants: dict[tuple[str, tuple[bool, ...], bool], tuple[str, bool]] = {}
        self._definitions: list[str] = []
        self._tables: dict[Leaves, str] = {}

    def may_be_long(self) -> bool:
        """Return whether the code so far has long loops or large arrays on the stack."""
        return self.polls or self._array_bytes > _SMALL_ARRAY_BYTES

    # Services for the writers of functions

    def take_memory(self, size: int, function: Function) -> None:
        """Add an array's size to the total.

        Args:
            size: Bytes.
            function: The function that contains the array, for the message.

        Raises:
            CompileError: All arrays together are too large.
        """
        self._array_bytes += size
        if self._array_bytes > ARRAY_BYTES:
            raise CompileError.at(
                f"the arrays of '{function.source_name}' are too large for the CPU, which keeps "
                f"{self.lanes.count} of each",
                function.span,
                "put constant numbers into a Buffer",
            )

    def arithmetic(self) -> LaneArithmetic:
        """Return the arithmetic of a new function."""
        return LaneArithmetic(self.lanes, LlvmWriter(), self.declarations)

    def table(self, leaves: Leaves) -> str:
        """Return the name of a constant table, with one slot for each leaf."""
        name = self._tables.get(leaves)
        if name is None:
            name = self._tables[leaves] = f"@table{len(self._tables)}"
            parts = ", ".join(self._table_slot(leaf) for leaf in leaves)
            types = ", ".join(self._slot_type(leaf.kind) for leaf in leaves)
            self._definitions.append(
                f"{name} = private unnamed_addr constant {{ {types} }} {{ {parts} }}, align 64"
            )
        return name

    def _slot_type(self, kind: Kind) -> str:
        if kind is Kind.FLOAT:
            return self.lanes.scalar(kind)
        return "i32" if self.lanes.slot == 4 else "i64"

    def _table_slot(self, leaf: Leaf) -> str:
        value = {"true": "1", "false": "0"}.get(leaf.names[0], leaf.names[0])
        return f"{self._slot_type(leaf.kind)} {value}"

    def call(self, caller: LaneExpressions, name: str, args: tuple[Expr, ...]) -> Leaves:
        """Call a function with the caller's active lanes.

        Args:
            caller: The expressions of the calling function.
            name: The called function.
            args: The arguments.
        """
        function = self._functions[name]
        # The specialise pass has already bound static arguments (textures).
        varying = tuple(caller.uniformity.varies(a) for a in args)
        values = [caller.value(a) for a in args]
        values = [
            caller.arithmetic.spread_all(v) if vary else v
            for v, vary in zip(values, varying, strict=True)
        ]
        masked = any(varying) and caller.mask is not None
        if self._inlined(name):
            mask = caller.mask if any(varying) else None
            return self.run(caller.arithmetic, function, values, varying, mask)
        symbol, result_varies = self._variant(function, varying, masked)
        operands = ["ptr %job"]
        if masked:
            assert caller.mask is not None
            operands += [f"{self.lanes.vector(Kind.BOOL)} {m}" for m in caller.mask]
        for leaf in (leaf for value in values for leaf in value):
            type = self.lanes.type(leaf.kind, uniform=leaf.uniform)
            operands += [f"{type} {n}" for n in leaf.names]
        kinds = leaf_kinds(function.result)
        returned = self._result_type(kinds, uniform=not result_varies)
        result = caller.writer.value(f"call {returned} {symbol}({', '.join(operands)})")
        return self._unpacked(caller.writer, result, returned, kinds, uniform=not result_varies)

    def _inlined(self, name: str) -> bool:
        """Return whether to inline a function: if it is small, or has a single call.

        Vector registers are not preserved by calls, so calling a small function costs more than
        its body.
        """
        if self._functions[name].apart:
            return False
        return self.costs.function(name) <= INLINE_COST or self._sites[name] == 1

    def _result_type(self, kinds: tuple[Kind, ...], *, uniform: bool) -> str:
        per_leaf = 1 if uniform else self.lanes.chunks
        names = (t for k in kinds for t in (self.lanes.type(k, uniform=uniform),) * per_leaf)
        return f"{{ {', '.join(names)} }}"

    def _unpacked(
        self, writer: LlvmWriter, result: str, type: str, kinds: tuple[Kind, ...], *, uniform: bool
    ) -> Leaves:
        per_leaf = 1 if uniform else self.lanes.chunks
        names = [
            writer.value(f"extractvalue {type} {result}, {i}") for i in range(len(kinds) * per_leaf)
        ]
        return tuple(
            Leaf(kind, tuple(names[i * per_leaf : (i + 1) * per_leaf]), uniform)
            for i, kind in enumerate(kinds)
        )

    # Functions

    def _variant(
        self, function: Function, varying: tuple[bool, ...], masked: bool
    ) -> tuple[str, bool]:
        """Return the LLVM function for a set of varying parameters; whether its result varies."""
        key = function.name, varying, masked
        known = self._variants.get(key)
        if known is None:
            letters = "".join("v" if v else "u" for v in varying) + ("m" if masked else "")
            symbol = f'@"{_escaped(function.name)}.{letters}"'
            # The result varies if one of the arguments does.
            known = self._variants[key] = symbol, any(varying)
            self._define(function, varying, masked, symbol)
        return known

    def _define(
        self, function: Function, varying: tuple[bool, ...], masked: bool, symbol: str
    ) -> None:
        arithmetic = self.arithmetic()
        lanes, writer = self.lanes, arithmetic.writer
        params = ["ptr %job"]
        mask: Mask = None
        if masked:
            mask = tuple(f"%mask{c}" for c in range(lanes.chunks))
            params += [f"{lanes.vector(Kind.BOOL)} {m}" for m in mask]
        bound: list[Leaves] = []
        for p, (param, vary) in enumerate(zip(function.params, varying, strict=True)):
            leaves = []
            for i, kind in enumerate(leaf_kinds(param.type)):
                count = lanes.chunks if vary else 1
                names = tuple(f"%p{p}.{i}.{c}" for c in range(count))
                params += [f"{lanes.type(kind, uniform=not vary)} {n}" for n in names]
                leaves.append(Leaf(kind, names, not vary))
            bound.append(tuple(leaves))
        prologue(writer)
        result_varies = any(varying)
        result = self.run(arithmetic, function, bound, varying, mask)
        if result_varies:
            result = arithmetic.spread_all(result)
        kinds = leaf_kinds(function.result)
        returned = self._result_type(kinds, uniform=not result_varies)
        packed = "poison"
        for i, (type, name) in enumerate(
            (lanes.type(leaf.kind, uniform=leaf.uniform), name)
            for leaf in result
            for name in leaf.names
        ):
            packed = writer.value(f"insertvalue {returned} {packed}, {type} {name}, {i}")
        writer.line(f"ret {returned} {packed}")
        self._definitions.append(
            f"; {function.source_name}\n"
            f"define internal {returned} {symbol}({', '.join(params)}) #0 {{\n{writer.text()}\n}}"
        )

    def run(
        self,
        arithmetic: LaneArithmetic,
        function: Function,
        args: list[Leaves],
        varying: tuple[bool, ...],
        mask: Mask,
    ) -> Leaves:
        """Write a function's body at the current position.

        Args:
            arithmetic: Writes the operations.
            function: The function.
            args: The leaves of the arguments.
            varying: Which arguments vary between lanes.
            mask: The active lanes; None: all.
        """
        names = frozenset(p.name for p, vary in zip(function.params, varying, strict=True) if vary)
        expressions = LaneExpressions(self, arithmetic, Uniformity(function, names))
        expressions.mask = mask
        statements = Statements(expressions, function)
        for param, leaves in zip(function.params, args, strict=True):
            if param.name in statements.indexed:
                uniform = param.name not in names
                stored = expressions.stored(param.type, leaves, uniform=uniform)
                expressions.environment[param.name] = stored
            else:
                expressions.environment[param.name] = leaves
        statements.block(function.body)
        return statements.result

    # The module

    def define(self, text: str) -> None:
        """Add a definition."""
        self._definitions.append(text)

    def text(self, name: str) -> str:
        """Return the whole LLVM module."""
        bits = _REGISTER_BITS[self.lanes.level]
        attributes = (
            f'attributes #0 = {{ nounwind "no-builtins" "min-legal-vector-width"="{bits}" '
            f'"prefer-vector-width"="{bits}" }}'
        )
        parts = (
            f'source_filename = "{_escaped(name)}"',
            *self._definitions,
            *sorted(self.declarations),
            attributes,
            "!0 = !{}",
        )
        return "\n\n".join(parts) + "\n"


def prologue(writer: LlvmWriter) -> None:
    """Load the pointers of a job; unused ones are removed later."""
    for name in ("stop", "uniforms", "frame", "resources"):
        at = writer.value(f"getelementptr i8, ptr %job, i64 {JOB_OFFSET[name]}")
        writer.line(f"%{name} = load ptr, ptr {at}, !invariant.load !0")


def _escaped(name: str) -> str:
    """Return a name with the escapes of LLVM's quoted names."""
    return "".join(
        chr(b) if 32 <= b < 127 and b not in b'"\\' else f"\\{b:02X}" for b in name.encode()
    )
