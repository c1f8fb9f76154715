"""Small changes of a text that should make a test fail.

Input: the text of a Python file. Output: mutations, each one replacement in the
text. Skipped is what no behaviour depends on: docstrings, annotations, ``__all__``, assertions,
texts of errors and of representations, and decorators that only shape a class.
"""

from __future__ import annotations

import ast
import itertools
import re
from dataclasses import dataclass
from typing import Final

from tools.mutation.project import Index

_COMPARE: Final[dict[type[ast.cmpop], tuple[str, str]]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
_BINARY: Final[dict[type[ast.operator], tuple[str, str]]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "*"),
    ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.BitXor: ("^", "&"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
}
_NAMES: Final = {
    "min": "max",
    "max": "min",
    "sin": "cos",
    "cos": "sin",
    "sinh": "cosh",
    "cosh": "sinh",
    "floor": "ceil",
    "ceil": "floor",
    "any": "all",
    "all": "any",
    "minimum": "maximum",
    "maximum": "minimum",
}
_UNWRAPPED: Final = {"abs", "sqrt", "normalize", "fract", "saturate", "sign", "sorted"}
_PARTS: Final = {"x": "y", "y": "x", "z": "y", "w": "z", "xy": "yx", "xz": "zx", "yz": "zy"}
_SYMMETRIC: Final = {"min", "max", "dot", "distance", "hypot", "isinstance", "cast", "gcd"}
_NO_BEHAVIOUR: Final = {"assert_never", "cast", "TypeVar", "dataclass", "warn", "NewType", "print"}
_KEYED: Final = {"get", "pop", "setdefault", "getattr", "hasattr"}
_EMPTY: Final = {"tuple": "()", "list": "[]", "frozenset": "frozenset()", "dict": "{}"}
_GUARD: Final = 1e-4  # below, a constant guards against zero: a hundredth more means nothing


@dataclass(frozen=True)
class Mutation:
    """One replacement in one file.

    Attributes:
        file: The file's name relative to the source folder.
        function: The outermost function or method, or ``<module>``.
        line: Where it begins.
        was: The lines it touches, white space made single.
        becomes: The same lines afterwards.
        start: First byte of what is replaced.
        end: The byte after it.
        new: What stands there instead.
    """

    file: str
    function: str
    line: int
    was: str
    becomes: str
    start: int
    end: int
    new: str

    @property
    def key(self) -> tuple[str, str, str, str]:
        """What it is known by in the list of survivors: no line number, so that lines may move."""
        return self.file, self.function, self.was, self.becomes

    def applied(self, text: str) -> str:
        """The file's text with the mutation."""
        data = text.encode()
        return (data[: self.start] + self.new.encode() + data[self.end :]).decode()


def mutations(file: str, index: Index) -> list[Mutation]:
    """Every mutation of a file, in the order of the text."""
    finder = _Finder(index.text)
    finder.visit(index.tree)
    data = index.text.encode()
    made = []
    for start, end, new in sorted(set(finder.found)):
        line = data.count(b"\n", 0, start) + 1
        first = data.rfind(b"\n", 0, start) + 1
        last = data.find(b"\n", end)
        last = len(data) if last < 0 else last
        was = " ".join(data[first:last].decode().split())
        after = data[first:start] + new.encode() + data[end:last]
        becomes = " ".join(after.decode().split())
        mutation = Mutation(file, index.owner(line), line, was, becomes, start, end, new)
        if was != becomes:
            made.append(mutation)
    return made


def parses(text: str) -> bool:
    """Whether Python takes a text: of a few mutations it does not."""
    try:
        ast.parse(text)
    except SyntaxError:
        return False
    return True


class _Finder(ast.NodeVisitor):
    """Collects replacements as (first byte, byte after, new text)."""

    def __init__(self, text: str) -> None:
        lines = text.encode().splitlines(keepends=True)
        self.data = text.encode()
        self.starts = [0]
        for line in lines:
            self.starts.append(self.starts[-1] + len(line))
        self.found: list[tuple[int, int, str]] = []
        self.returns: list[str] = []
        self.bound: list[set[str]] = [set()]

    # Places

    def _start(self, node: ast.expr | ast.stmt) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def _end(self, node: ast.expr | ast.stmt) -> int:
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self.starts[node.end_lineno - 1] + node.end_col_offset

    def _text(self, node: ast.expr | ast.stmt) -> str:
        return self.data[self._start(node) : self._end(node)].decode()

    def _replace(self, node: ast.expr | ast.stmt, new: str) -> None:
        self.found.append((self._start(node), self._end(node), new))

    def _operator(self, left: ast.expr, right: ast.expr, old: str, new: str) -> None:
        """Replace the operator between two operands."""
        begin, end = self._end(left), self._start(right)
        between = self.data[begin:end].decode()
        pattern = r"\s+".join(map(re.escape, old.split()))
        found = re.search(rf"\b{pattern}\b" if old[0].isalpha() else pattern, between)
        if found and "#" not in between:
            self.found.append((begin + found.start(), begin + found.end(), new))

    # Definitions

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Decorators, defaults and the body: annotations and the docstring change nothing."""
        if node.name in ("__repr__", "__str__"):
            return
        for part in (*node.decorator_list, *node.args.defaults, *node.args.kw_defaults):
            if part is not None:
                self.visit(part)
        self.returns.append(ast.unparse(node.returns) if node.returns else "")
        given = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
        self.bound.append({argument.arg for argument in given})
        for statement in node.body:
            self.visit(statement)
        self.bound.pop()
        self.returns.pop()

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        """The value alone."""
        if node.value is not None and "TypeAlias" not in ast.unparse(node.annotation):
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        """The value; the whole of it where the name has a value already."""
        names = {t.id for t in node.targets if isinstance(t, ast.Name)}
        if "__all__" in names or "__slots__" in names:
            return
        if names and names <= self.bound[-1]:
            self._replace(node, "pass")
        self.bound[-1] |= names
        self.visit(node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """Dropped, or with another operator."""
        self._replace(node, "pass")
        old, new = _BINARY.get(type(node.op), ("", ""))
        if old:
            self._operator(node.target, node.value, old + "=", new + "=")
        self.visit(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        """Dropped, when it is no docstring."""
        if isinstance(node.value, ast.Call) and _called(node.value) not in _NO_BEHAVIOUR:
            self._replace(node, "pass")
            self.visit(node.value)

    def visit_Raise(self, node: ast.Raise) -> None:
        """Dropped; its text is another test's matter."""
        self._replace(node, "pass")

    def visit_Assert(self, node: ast.Assert) -> None:
        """States what holds anyway."""

    def visit_Continue(self, node: ast.Continue) -> None:
        """Dropped."""
        self._replace(node, "pass")

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """A text for people."""

    # Conditions and results

    def visit_If(self, node: ast.If) -> None:
        """Negated; what is for the type checker alone is left."""
        if ast.unparse(node.test) != "TYPE_CHECKING":
            self._negate(node.test)
            self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        """Negated."""
        self._negate(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """Negated."""
        self._negate(node.test)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        """Each condition negated."""
        for condition in node.ifs:
            self._negate(condition)
        self.generic_visit(node)

    def _negate(self, test: ast.expr) -> None:
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            return  # the operand without "not" is another mutation
        if isinstance(test, ast.Compare) and len(test.ops) == 1:
            op = test.ops[0]
            if isinstance(op, ast.Eq | ast.NotEq | ast.Is | ast.IsNot | ast.In | ast.NotIn):
                return  # as is the other comparison
        self._replace(test, f"(not ({self._text(test)}))")

    def visit_Return(self, node: ast.Return) -> None:
        """Another value of the same type."""
        if node.value is None:
            return
        annotation = self.returns[-1] if self.returns else ""
        plain = annotation.partition("[")[0]
        constant = isinstance(node.value, ast.Constant)
        if annotation == "bool" and not constant:
            self._replace(node.value, f"not ({self._text(node.value)})")
        elif annotation in ("float", "vec2", "vec3", "vec4") and not constant:
            self._replace(node.value, f"0.0 * ({self._text(node.value)})")
        elif annotation.endswith("| None") and not constant:
            self._replace(node.value, "None")
        elif plain in _EMPTY and ast.unparse(node.value) not in ("()", "[]", "{}"):
            self._replace(node.value, _EMPTY[plain])
        self.visit(node.value)

    # Expressions

    def visit_Constant(self, node: ast.Constant) -> None:
        """A number changed, a truth turned round."""
        value = node.value
        if value is True or value is False:
            self._replace(node, repr(not value))
        elif isinstance(value, int):
            self._replace(node, repr(value + 1))
            if value > 0:
                self._replace(node, repr(value - 1) if value > 1 else f"(-{value})")
        elif isinstance(value, float):
            factor = 10.0 if abs(value) < _GUARD else 1.01
            self._replace(node, repr(value * factor) if value else "0.01")
            if value:
                self._replace(node, f"(-{self._text(node)})")

    def visit_Compare(self, node: ast.Compare) -> None:
        """Each comparison, and texts that are compared with."""
        left = node.left
        for op, right in zip(node.ops, node.comparators, strict=True):
            self._operator(left, right, *_COMPARE[type(op)])
            for side in (left, right):
                for part in side.elts if isinstance(side, ast.Tuple) else [side]:
                    self._key(part)
            left = right
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """Another operator."""
        if type(node.op) in _BINARY:
            self._operator(node.left, node.right, *_BINARY[type(node.op)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """``and`` for ``or``."""
        old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        for left, right in zip(node.values, node.values[1:], strict=False):
            self._operator(left, right, old, new)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """The operand alone."""
        if isinstance(node.op, ast.Not | ast.USub):
            self._replace(node, f"({self._text(node.operand)})")
        if not (isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant)):
            self.visit(node.operand)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        """Another part of a vector."""
        if node.attr in _PARTS:
            end = self._end(node)
            self.found.append((end - len(node.attr.encode()), end, _PARTS[node.attr]))
        self.visit(node.value)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        """Another key."""
        self._key(node.slice)
        self.generic_visit(node)

    def visit_Dict(self, node: ast.Dict) -> None:
        """Other keys."""
        for key in node.keys:
            if key is not None:
                self._key(key)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        """Another function, neighboring arguments exchanged, or the argument alone."""
        name = _called(node)
        if name in _NO_BEHAVIOUR or name.endswith(("Error", "Warning")):
            return
        if name in _NAMES:
            end = self._end(node.func)
            self.found.append((end - len(name.encode()), end, _NAMES[name]))
        if name in _UNWRAPPED and len(node.args) == 1 and not node.keywords:
            self._replace(node, f"({self._text(node.args[0])})")
        if name in _KEYED:
            for argument in node.args[:2]:
                self._key(argument)
        if name not in _SYMMETRIC:
            self._exchange(node.args)
        self.generic_visit(node)

    def _exchange(self, arguments: list[ast.expr]) -> None:
        for left, right in itertools.pairwise(arguments):
            alike = type(left) is type(right) and not isinstance(left, ast.Starred)
            if alike and self._text(left) != self._text(right):
                between = self.data[self._end(left) : self._start(right)].decode()
                new = self._text(right) + between + self._text(left)
                self.found.append((self._start(left), self._end(right), new))

    def _key(self, node: ast.expr) -> None:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value:
            self._replace(node, repr(node.value + "_"))

    def visit_match_case(self, node: ast.match_case) -> None:
        """The guard and the body: a pattern is a type."""
        if node.guard is not None:
            self._negate(node.guard)
            self.visit(node.guard)
        for statement in node.body:
            self.visit(statement)


def _called(node: ast.Call) -> str:
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    return node.func.id if isinstance(node.func, ast.Name) else ""
