"""What is known of the memory that is left, and what is refused for want of it."""

import pytest

from distal import Scene, Sphere
from distal.devices import memory_limit
from distal.runtime import executor

MIB = 2**20


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine with files that say what memory it has."""
    monkeypatch.setattr(memory_limit, "_MEMORY", tmp_path / "meminfo")
    monkeypatch.setattr(memory_limit, "_CONTAINER", tmp_path)
    return tmp_path


def has_left(folder, mib):
    (folder / "meminfo").write_text(
        f"MemTotal: 99999999 kB\nMemAvailable: {1024 * (mib - 3)} kB\nSwapFree: 3072 kB\n"
    )


def test_a_machine_without_such_files_says_nothing(machine):
    assert memory_limit.available() is None
    memory_limit.require_of_machine(2**20, "nothing much")


@pytest.mark.parametrize("text", ["", "MemAvailable:\n", "MemAvailable: many kB\nSwapFree: 0 kB"])
def test_files_that_say_something_else(machine, text):
    (machine / "meminfo").write_text(text)
    assert memory_limit.available() is None


def test_memory_and_swap(machine):
    has_left(machine, 500)
    assert memory_limit.available() == 500 * MIB


@pytest.mark.parametrize(("most", "left"), [("max", 500), (str(300 * MIB), 200), ("5", 0)])
def test_the_limit_of_a_container(machine, most, left):
    has_left(machine, 500)
    (machine / "memory.max").write_text(f"{most}\n")
    (machine / "memory.current").write_text(f"{100 * MIB}\n")
    assert memory_limit.available() == left * MIB


@pytest.mark.parametrize(("mode", "needed"), [("direct", "15,360"), ("path", "35,072")])
def test_a_picture_is_refused_before_anything_is_compiled(machine, monkeypatch, mode, needed):
    has_left(machine, 8000)
    monkeypatch.delattr(executor.PythonExecutor, "passes")
    with pytest.raises(MemoryError) as caught:
        Scene(Sphere(1.0)).render(size=(16384, 16384), mode=mode)
    picture = "a picture of 16384x16384 pixels"
    assert str(caught.value) == f"{picture} needs {needed} MiB, and 8,000 MiB are left"
