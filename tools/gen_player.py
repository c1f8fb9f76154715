"""Write the parts of the page's player whose one definition is Python: ``web/src/generated/``.

The rules of camera movement (``distal/scene/viewing/interaction.py``), the range of a view's values
(``distal/scene/packed_values.py``), sRGB's curve (``distal/lang/srgb.py``), the key bindings
(``distal/scene/viewing/key_bindings.py``) and the names of what guides a camera
(``distal/render/guide.py``) or inspects a scene (``distal/render/ruler.py``,
``distal/scene/viewing/measuring.py``) are translated to TypeScript. Run it
after any change of these, then build the player; a test fails when it was forgotten.
"""

from __future__ import annotations

import ast
import importlib
import json
import re
import sys
from pathlib import Path
from typing import NoReturn

from distal.compiler.driver import compile
from distal.render import ruler
from distal.render.guide import ACTIONS, NUMBERS
from distal.scene import section
from distal.scene.lowering import ruler as uniforms
from distal.scene.steering import ACTION, GOAL_PREFIX, PREFIX, SIZE
from distal.scene.viewing.key_bindings import BINDINGS, HELP
from distal.triangles import arithmetic as triangle_arithmetic
from distal.triangles import lattice, range_coder, shapes, stream

ROOT = Path(__file__).parents[1]
SOURCES = ROOT / "src" / "distal"
FOLDER = ROOT / "web" / "src" / "generated"

NOTE = "// Made by tools/gen_player.py from src/distal/{}: change that, and run it.\n"
OPERATORS: dict[type[ast.AST], str] = {
    **{ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"},
    **{ast.USub: "-", ast.Not: "!", ast.And: "&&", ast.Or: "||"},
    **{ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "===", ast.NotEq: "!=="},
    **{ast.Is: "===", ast.IsNot: "!=="},
}
# A scene's vector is a number here: the curve is the same for each channel.
TYPES = {"float": "number", "int": "number", "bool": "boolean", "vec3": "number"}
CALLS = {
    **{name: f"Math.{name}" for name in ("min", "max")},
    **{f"math.{name}": f"Math.{name}" for name in ("floor", "ceil", "log", "log10")},
    **{name: "" for name in ("int", "float")},  # numbers that are whole, or floats, already
}


class Translator:
    """One module's functions and constants.

    Attributes:
        known: The names of other modules' functions that it may call.
    """

    def __init__(self, path: str, known: tuple[str, ...] = ()) -> None:
        self.path = path
        self.known = known
        self.source = (SOURCES / path).read_text(encoding="utf-8")
        self.tree = ast.parse(self.source)
        self.module = importlib.import_module(
            f"distal.{path.removesuffix('.py').replace('/', '.')}"
        )
        self.functions = {f.name for f in self.tree.body if isinstance(f, ast.FunctionDef)}

    def constants(self) -> str:
        """The module's constants."""
        lines = []
        for node in self.tree.body:
            if isinstance(node, ast.AnnAssign):
                assert isinstance(node.target, ast.Name) and node.value is not None
                if isinstance(node.value, ast.Name):  # of another module: its value
                    text = f"{getattr(self.module, node.value.id):.17g}"
                else:
                    text = self.expression(node.value)
                lines.append(f"export const {node.target.id} = {text};")
        return "\n".join(lines) + "\n"

    def function(self, node: ast.FunctionDef) -> str:
        """One function."""
        first, *others = node.args.args
        defaults = [None] * (1 + len(others) - len(node.args.defaults)) + node.args.defaults
        parameters = [
            f"{camel(arg.arg)}: {self.type(arg.annotation)}"
            + ("" if default is None else f" = {self.expression(default)}")
            for arg, default in zip([first, *others], defaults, strict=True)
        ]
        scope = {arg.arg for arg in node.args.args}
        body = self.block(node.body, scope, 1)
        doc = (ast.get_docstring(node) or "").split("\n")[0].replace("``", "`")
        head = "" if node.name.startswith("_") else f"/** {doc} */\nexport "
        name = camel(node.name)
        result = self.type(node.returns)
        return f"{head}function {name}({', '.join(parameters)}): {result} {{\n{body}}}\n"

    def block(self, body: list[ast.stmt], scope: set[str], depth: int) -> str:
        """Statements."""
        return "".join(self.statement(s, scope, depth) for s in body)

    def statement(self, node: ast.stmt, scope: set[str], depth: int) -> str:
        """One statement, with its line's end."""
        pad = "  " * depth
        match node:
            case ast.Expr(ast.Constant(str())):
                return ""
            case ast.Return(value) if value is not None:
                return f"{pad}return {self.expression(value)};\n"
            case ast.Assign([ast.Name(name)], value):
                word = "" if name in scope else "let "
                scope.add(name)
                return f"{pad}{word}{camel(name)} = {self.expression(value)};\n"
            case ast.If(test, body, orelse):
                text = f"{pad}if ({self.expression(test)}) {{\n"
                text += self.block(body, set(scope), depth + 1) + f"{pad}}}"
                if orelse:
                    text += f" else {{\n{self.block(orelse, set(scope), depth + 1)}{pad}}}"
                return text + "\n"
            case ast.While(test, body, []):
                inside = self.block(body, set(scope), depth + 1)
                return f"{pad}while ({self.expression(test)}) {{\n{inside}{pad}}}\n"
            case ast.For(ast.Name(i), ast.Call(ast.Name("range"), [count], []), body, []):
                inside = self.block(body, scope | {i}, depth + 1)
                head = f"for (let {i} = 0; {i} < {self.expression(count)}; {i}++)"
                return f"{pad}{head} {{\n{inside}{pad}}}\n"
            case _:
                self.refuse(node)

    def expression(self, node: ast.expr) -> str:
        """An expression; a nested one is in parentheses."""
        text = self.bare(node)
        inner = isinstance(node, ast.BinOp | ast.BoolOp | ast.Compare | ast.IfExp | ast.UnaryOp)
        return f"({text})" if inner else text

    def bare(self, node: ast.expr) -> str:
        """An expression without parentheses around it."""
        match node:
            case ast.Constant(None):
                return "null"
            case ast.Constant(bool(value)):
                return str(value).lower()
            case ast.Constant(int() | float() as value):
                return repr(value).removesuffix(".0")
            case ast.Name(name):
                return camel(name)
            case ast.Attribute(ast.Name("math"), "pi"):
                return "Math.PI"
            case ast.Tuple(elements):
                return f"[{', '.join(map(self.expression, elements))}]"
            case ast.Subscript(value, index):
                return f"{self.expression(value)}[{self.expression(index)}]!"
            case ast.UnaryOp(op, value) if type(op) in OPERATORS:
                return f"{OPERATORS[type(op)]}{self.expression(value)}"
            case ast.BinOp(left, op, right) if type(op) in OPERATORS:
                return f"{self.expression(left)} {OPERATORS[type(op)]} {self.expression(right)}"
            case ast.BoolOp(op, values):
                return f" {OPERATORS[type(op)]} ".join(map(self.expression, values))
            case ast.Compare(left, [op], [right]) if type(op) in OPERATORS:
                return f"{self.expression(left)} {OPERATORS[type(op)]} {self.expression(right)}"
            case ast.IfExp(test, yes, no):
                return " ".join(
                    (self.expression(test), "?", self.expression(yes), ":", self.expression(no))
                )
            case ast.Call(function, args, []):
                return self.call(ast.unparse(function), args, node)
            case _:
                self.refuse(node)

    def call(self, name: str, args: list[ast.expr], node: ast.expr) -> str:
        """A call of a function that both languages have."""
        texts = list(map(self.expression, args))
        if name == "select" and len(args) == 3:
            return f"({texts[0]} ? {texts[1]} : {texts[2]})"
        if name == "len":
            return f"{texts[0]}.length"
        if name in CALLS:
            return f"{CALLS[name]}({', '.join(texts)})"
        if name in self.functions or name in self.known:
            return f"{camel(name)}({', '.join(texts)})"
        self.refuse(node)

    def type(self, node: ast.expr | None) -> str:
        """A type of TypeScript."""
        match node:
            case ast.Name(name) if name in TYPES:
                return TYPES[name]
            case ast.Subscript(ast.Name("Sequence"), element):
                return f"readonly {self.type(element)}[]"
            case ast.BinOp(left, ast.BitOr(), ast.Constant(None)):
                return f"{self.type(left)} | null"
            case _:
                self.refuse(node or self.tree)

    def refuse(self, node: ast.AST) -> NoReturn:
        """Stop: what is not known is not guessed."""
        line = getattr(node, "lineno", 0)
        raise SystemExit(f"{self.path}:{line}: gen_player knows no {type(node).__name__} here")


def camel(name: str) -> str:
    """The name as TypeScript's habit has it; constants keep theirs."""
    if name.isupper():
        return name
    start = "_" if name.startswith("_") else ""
    return start + re.sub(r"_(\w)", lambda found: found[1].upper(), name.lstrip("_"))


def interaction() -> str:
    """The rules of a hand."""
    path = "scene/viewing/interaction.py"
    made = Translator(path, ("fixed", "precise"))
    functions = [made.function(f) for f in made.tree.body if isinstance(f, ast.FunctionDef)]
    head = NOTE.format(path) + '\nimport { fixed, precise } from "../numbers";\n'
    return "\n".join([head, made.constants(), *functions])


def packed_values() -> str:
    """The range of a view's values."""
    path = "scene/packed_values.py"
    made = Translator(path)
    functions = [made.function(f) for f in made.tree.body if isinstance(f, ast.FunctionDef)]
    return "\n".join([NOTE.format(path), made.constants(), *functions])


def srgb() -> str:
    """SRGB's curve, for one channel."""
    path = "lang/srgb.py"
    made = Translator(path)
    functions = [
        made.function(f)
        for f in made.tree.body
        if isinstance(f, ast.FunctionDef)
        and any(ast.unparse(d) == "func" for d in f.decorator_list)
    ]
    return "\n".join([NOTE.format(path), *functions])


def bindings() -> str:
    """The keys of pages, and the lines of their help."""
    shared = [b for b in BINDINGS if b.in_page]
    actions = [camel(a) for b in shared for a in (b.action, b.opposite) if a is not None]
    names = " | ".join(f'"{action}"' for action in actions)
    keys = {key: camel(b.action) for b in shared for key in b.keys if not b.in_path_page}
    own = {key: camel(b.action) for b in shared for key in b.keys if b.in_path_page}
    opposites = {key: camel(b.opposite) for b in shared if b.opposite for key in b.keys}
    lines = [[h.keys, h.meaning, camel(h.needs)] for h in HELP if h.in_page]
    rows, turned = (
        "".join(f"  {json.dumps(key)}: {json.dumps(table[key])},\n" for key in table)
        for table in (keys, opposites)
    )
    rows += f"  ...(PATHS && {json.dumps(own)}),\n"
    texts = [json.dumps(line, ensure_ascii=False) for line in lines]
    of_paths = [line[2] in own.values() for line in lines]
    helps = "".join(
        f"  ...(PATHS ? [{text} as const] : []),\n" if own_line else f"  {text},\n"
        for text, own_line in zip(texts, of_paths, strict=True)
    )
    return (
        f"{NOTE.format('scene/viewing/key_bindings.py')}\nexport type Action = {names};\n\n"
        f"export const KEYS: Record<string, Action> = {{\n{rows}}};\n\n"
        "/** The actions of digits with shift. */\n"
        f"export const OPPOSITES: Record<string, Action> = {{\n{turned}}};\n\n"
        'export type Needs = Action | "camera" | "mouse";\n\n'
        f"export const HELP: readonly (readonly [string, string, Needs])[] = [\n{helps}];\n"
    )


def guide() -> str:
    """What the program that guides a camera reads and gives, and the actions it knows."""

    def listed(name: str, texts: tuple[str, ...]) -> str:
        return f"export const {name} = {json.dumps([camel(text) for text in texts])} as const;\n"

    names = {"PREFIX": PREFIX, "GOAL_PREFIX": GOAL_PREFIX, "ACTION": ACTION, "SIZE": SIZE}
    constants = "".join(f"export const {n} = {json.dumps(v)};\n" for n, v in names.items())
    head = f"{NOTE.format('render/guide.py')}\n"
    return head + constants + listed("ACTIONS", ACTIONS) + listed("NUMBERS", NUMBERS)


def inspect() -> str:
    """What the programs of inspection read and give, its numbers, the keys of its pages."""
    names = {
        "SIZE": uniforms.SIZE,
        "POINTER": uniforms.POINTER,
        "START": uniforms.START,
        "END": uniforms.END,
        "NORMAL": section.NORMAL.name,
        "OFFSET": section.OFFSET.name,
        "HATCH": section.HATCH.name,
        "POINTS": ruler.POINTS,
        "UNSEEN": ruler.UNSEEN,
    }
    lists = {
        "KINDS": ruler.KINDS,
        "PLACE_NUMBERS": ruler.PLACE_NUMBERS,
        "RULER_NUMBERS": ruler.RULER_NUMBERS,
        "CUT_AXES": ruler.CUT_AXES,
        "CUT_NUMBERS": ruler.CUT_NUMBERS,
    }
    keys = {key: camel(b.action) for b in BINDINGS if b.in_inspect_page for key in b.keys}
    lines = [(h.keys, h.meaning, camel(h.needs)) for h in HELP if camel(h.needs) in keys.values()]
    shown = json.dumps(lines, ensure_ascii=False)
    path = "scene/viewing/measuring.py"
    made = Translator(path, ("rounded",))
    functions = [made.function(f) for f in made.tree.body if isinstance(f, ast.FunctionDef)]
    parts = [
        NOTE.format("render/ruler.py and " + path) + '\nimport { rounded } from "./interaction";\n',
        "".join(f"export const {n} = {json.dumps(v)};\n" for n, v in names.items()),
        "".join(
            f"export const {n} = {json.dumps([camel(x) for x in v])} as const;\n"
            for n, v in lists.items()
        ),
        "/** Keys of pages to inspect, and the lines of their help. */\n"
        f"export const INSPECT_KEYS = {json.dumps(keys)} as const;\n"
        f"export const INSPECT_HELP = {shown} as const;\n",
        made.constants(),
        *functions,
    ]
    return "\n".join(parts)


def triangles() -> str:
    """The numbers of pictures as triangles, and the functions that color them."""
    names = {
        **{"SIGNATURE": stream.SIGNATURE.decode("ascii"), "HEAD": stream.HEAD.size},
        **{"MOST_SIDE": lattice.MOST_SIDE, "HALVES": lattice.HALVES},
        **{"PLACES": triangle_arithmetic.PLACES, "CONTEXTS": stream.CONTEXTS},
        **{n: getattr(shapes, n) for n in ("LEAST_CUT_PX", "MOST_CUT_PX")},
        **{
            n: getattr(range_coder, n)
            for n in ("ALWAYS", "NEVER", "RATES", "UNARY", "NUMBER_CONTEXTS")
        },
        **{n: getattr(stream, f"_{n}") for n in stream_names()},
    }
    lines = [f"export const {n} = {json.dumps(v)};\n" for n, v in names.items()]
    for name in ("seen_corner", "seen_color"):
        text = compile(getattr(triangle_arithmetic, name), "glsl-es300").text
        kept = (line.strip() for line in text.splitlines() if not line.startswith("//"))
        lean = "\n".join(line for line in kept if line)
        lines.append(f"export const {name.upper()} = {json.dumps(lean)};\n")
    return NOTE.format("triangles/") + "\n" + "".join(lines)


def stream_names() -> list[str]:
    """The numbers of contexts of a file of triangles, and of its steps."""
    plain = (name.removeprefix("_") for name in vars(stream) if re.fullmatch("_[A-Z_]+", name))
    return [name for name in plain if name != "ROUNDING"]


FILES = {
    "triangles.ts": triangles,
    "interaction.ts": interaction,
    "packed_values.ts": packed_values,
    "srgb.ts": srgb,
    "bindings.ts": bindings,
    "guide.ts": guide,
    "inspect.ts": inspect,
}


def main() -> None:
    """Write the files."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in FILES.items():
        (FOLDER / name).write_text(text(), encoding="utf-8")
        sys.stdout.write(f"{(FOLDER / name).relative_to(ROOT)}\n")


if __name__ == "__main__":
    main()
