"""The doctor: complete, quick to say what is missing, and never itself the patient."""

import importlib.metadata
import subprocess
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

from distal import doctor
from distal.doctor import PACKAGES, State, examine

PROJECT = tomllib.loads(Path(__file__).parents[3].joinpath("pyproject.toml").read_text())["project"]


def find(findings, subject):
    return next(f for f in findings if f.subject == subject)


def test_every_package_of_the_project_is_looked_at():
    extras = PROJECT["optional-dependencies"]
    groups = {"": PROJECT["dependencies"]} | {
        name: extras[name] for name in extras if name not in ("all", "test")
    }
    declared = {(Requirement(r).name, extra) for extra, rows in groups.items() for r in rows}
    assert {(p.name, p.extra) for p in PACKAGES} == declared


def test_missing_packages_come_with_the_command_that_mends(monkeypatch):
    def version(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", version)
    findings = list(doctor._packages())
    assert find(findings, "numpy").state is State.BROKEN
    assert find(findings, "numpy").remedy == "pip install numpy"
    assert find(findings, "wgpu").state is State.OPTIONAL
    assert find(findings, "wgpu").remedy == "pip install 'distal[gpu]'"


def test_a_hanging_or_dying_driver_is_a_finding(monkeypatch):
    def hang(*_, timeout, **__):
        raise subprocess.TimeoutExpired("python", timeout)

    monkeypatch.setattr(subprocess, "run", hang)
    assert doctor._gpu_adapters() == ([], "the driver did not answer within 30 s")
    died = subprocess.CompletedProcess([], -11, "", "")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: died)
    assert doctor._gpu_adapters() == ([], "exit code -11")


def test_a_failing_look_is_a_finding_and_the_rest_goes_on(monkeypatch):
    def broken():
        raise RuntimeError("no clock")

    monkeypatch.setattr(doctor, "_cpu_model", broken)
    monkeypatch.setattr(doctor, "_gpu_adapters", lambda: ([], ""))
    findings = examine()
    assert find(findings, "examination").detail == "RuntimeError: no clock"
    assert find(findings, "numpy").state is State.READY
