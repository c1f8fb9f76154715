"""The doctor: complete, quick to say what is missing, and never itself the patient."""

import importlib.metadata
import subprocess
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from distal.cli import doctor
from distal.cli.doctor import PACKAGES, State, examine
from distal.devices import adapters
from distal.devices.adapters import Adapter

PROJECT = tomllib.loads(Path(__file__).parents[3].joinpath("pyproject.toml").read_text())["project"]


def find(findings, subject):
    return next(f for f in findings if f.subject == subject)


def test_every_package_of_the_project_is_looked_at():
    extras = PROJECT["optional-dependencies"]
    groups = {"": PROJECT["dependencies"]} | {
        name: extras[name] for name in extras if name not in ("all", "test", "twins")
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


@pytest.fixture
def listed_again():
    adapters.listed_in_subprocess.cache_clear()
    yield
    adapters.listed_in_subprocess.cache_clear()


def test_a_hanging_or_dying_driver_is_a_finding(monkeypatch, listed_again):
    def hang(*_, timeout, **__):
        raise subprocess.TimeoutExpired("python", timeout)

    monkeypatch.setattr(subprocess, "run", hang)
    found = find(doctor._gpu(), "adapters")
    assert (found.state, found.detail) == (
        State.OPTIONAL,
        "the driver did not answer within 30 s",
    )
    adapters.listed_in_subprocess.cache_clear()
    died = subprocess.CompletedProcess([], -11, "", "")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: died)
    found = find(doctor._gpu(), "adapters")
    assert found.detail == "the driver crashed when its GPUs were listed (signal 11)"
    assert "apt-get install mesa-vulkan-drivers" in found.remedy


def test_adapters_have_numbers_and_the_one_that_auto_takes_is_marked(monkeypatch):
    rows = [
        Adapter(0, "llvmpipe (LLVM 15)", "CPU", "Vulkan", "Mesa"),
        Adapter(1, "Arc", "IntegratedGPU", "Vulkan"),
        Adapter(2, "RTX", "DiscreteGPU", "OpenGL"),
        Adapter(3, "RTX", "DiscreteGPU", "Vulkan", "555.1"),
    ]
    monkeypatch.setattr(adapters, "listed_in_subprocess", lambda: (rows, ""))
    told = [(f.subject, f.detail) for f in doctor._gpu()]
    assert told == [
        ("0: llvmpipe (LLVM 15)", "CPU, Vulkan, Mesa"),
        ("1: Arc", "IntegratedGPU, Vulkan"),
        ("2: RTX", "DiscreteGPU, OpenGL"),
        ("3: RTX", "DiscreteGPU, Vulkan, 555.1, taken by auto"),
    ]
    monkeypatch.setattr(adapters, "listed_in_subprocess", lambda: (rows[:1], ""))
    auto = find(doctor._gpu(), "auto")
    assert auto.detail == "takes the CPU; no GPU: only llvmpipe, in software"


def test_a_failing_look_is_a_finding_and_the_rest_goes_on(monkeypatch):
    def broken():
        raise RuntimeError("no clock")

    monkeypatch.setattr(doctor, "_cpu_model", broken)
    monkeypatch.setattr(adapters, "listed_in_subprocess", lambda: ([], ""))
    findings = examine()
    assert find(findings, "examination").detail == "RuntimeError: no clock"
    assert find(findings, "numpy").state is State.READY


def test_processor_level_is_told_and_a_wish_it_cannot_grant_is_a_finding(monkeypatch):
    monkeypatch.delenv("DISTAL_CPU", raising=False)
    assert "lanes" in find(doctor._cpu(), "feature level").detail
    monkeypatch.setenv("DISTAL_CPU", "mmx")
    level = find(doctor._cpu(), "feature level")
    assert level.state is State.BROKEN
    assert "mmx" in level.detail
    assert level.remedy == "unset DISTAL_CPU"


def test_cache_is_tried_and_left_as_it_was(tmp_path, monkeypatch):
    folder = tmp_path / "kernels"
    monkeypatch.setenv("DISTAL_CACHE_DIR", str(folder))
    assert "first render makes it" in find(doctor._cache(), "folder").detail
    folder.mkdir(mode=0o700)
    assert "0 kernels" in find(doctor._cache(), "folder").detail
    assert list(folder.iterdir()) == []
    folder.chmod(0o777)
    unsafe = find(doctor._cache(), "folder")
    assert unsafe.state is State.OPTIONAL
    assert "can be written by others" in unsafe.detail
    assert "chmod go-w" in unsafe.remedy
    monkeypatch.setenv("DISTAL_CACHE_DIR", "off")
    assert find(doctor._cache(), "folder").remedy == "unset DISTAL_CACHE_DIR"
