"""The application with all commands; the short commands are defined here.

Input: parsed arguments. Output: the results of ``distal.load``, ``distal.compile`` and ``render``.
Heavy packages are imported only by the commands that need them: ``compile`` runs without numpy,
llvmlite and wgpu. ``render``, ``check``, ``probe`` and others have modules of their own.
"""

from __future__ import annotations

from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer
from typer.models import CommandInfo

import distal
from distal.backends import TEXT_TARGETS
from distal.cli import COMMANDS, SHORT
from distal.cli.arguments import UsageError, check_is_not_scene, read_scene
from distal.cli.base import SceneArgument, answer, application, load, reporting
from distal.cli.exit_codes import ExitCode
from distal.cli.messages import say
from distal.cli.surroundings import check_cache
from distal.compiler.driver import COMPILE_TARGETS, IR_TARGET
from distal.diagnostics import readable
from distal.example_files import EXAMPLE_PREFIX, all_examples
from distal.export.texts import files_of
from distal.file_writer import check_destination

for _name in COMMANDS:
    if _name not in SHORT:  # importing a module adds its command
        import_module(f"distal.cli.{_name}")
__all__ = ["TargetName", "application"]


# The targets of ``distal compile``.
_MEMBERS = {name.upper().replace("-", "_"): name for name in COMPILE_TARGETS}
TargetName = StrEnum("TargetName", _MEMBERS)  # type: ignore[misc]  # members are not literals


@application.command()
@reporting
def compile(
    scene: SceneArgument,
    target: Annotated[
        TargetName, typer.Option("--target", help="What to write.", show_default=False)
    ],
    after: Annotated[
        str | None,
        typer.Option(metavar="PASS", help="With --target ir: show the module after this pass."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="A file for the text; its interface is written beside it as .json, "
            "a vertex stage as .vert.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Compile a scene to text: a shader, vector code, or any stage of the compiler."""
    if after is not None and target.value != IR_TARGET:
        raise UsageError("--after belongs to --target ir")
    if after is not None:
        _check_pass(after)
    if output is not None:
        if output.suffix.lower() in (".json", ".vert"):
            raise UsageError(f"'{output}' is where the interface or the vertex stage goes")
        check_is_not_scene(output, scene)
        check_destination(output)
    check_cache()
    artifact = distal.compile(load(scene), target=target.value, after=after)
    stem = "out" if output is None else output.stem
    files = files_of(artifact, target.value, _file_name(scene), stem, described=True)
    if output is not None:
        files.write(output)
        return
    answer(files.text.rstrip("\n"))
    if target.value in TEXT_TARGETS:
        say("note: this is the text alone; with -o FILE, what it reads is written beside it")


@application.command()
@reporting
def examples() -> None:
    """List the gallery and the examples that keep frames; render one as example:NAME."""
    for name, path in sorted(all_examples().items()):
        answer(f"example:{name}\t{path}")


@application.command()
@reporting
def doctor() -> None:
    """Show what this machine can do, and how to install what is missing."""
    from distal.cli.doctor import State, examine
    from distal.cli.doctor_report import show

    facts = examine()
    show(facts)
    if any(fact.state is State.BROKEN for fact in facts):
        raise typer.Exit(ExitCode.FAILED)


def _place(command: CommandInfo) -> int:
    return COMMANDS.index(command.name or getattr(command.callback, "__name__", ""))


application.registered_commands.sort(key=_place)


def _file_name(scene: str) -> str:
    """Return the name of the author's file, from FILE[:NAME] or example:NAME."""
    path = read_scene(scene)[0]
    if path.startswith(EXAMPLE_PREFIX):
        return f"{path.removeprefix(EXAMPLE_PREFIX)}.py"
    return readable(Path(path).name)


def _check_pass(name: str) -> None:
    from distal.passes.pipeline import PASS_NAMES

    if name not in ("lower", *PASS_NAMES):
        raise UsageError(f"there is no pass '{name}'; passes: lower, {', '.join(PASS_NAMES)}")
