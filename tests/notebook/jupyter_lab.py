"""A JupyterLab server for tests, with folders of its own and no way to a network.

Input: an empty folder and the cells of a notebook. Output: the address that shows them. Where
JupyterLab is missing, a test skips aloud on the error raised here.
"""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

START_S: Final = 90.0  # 3 s alone; other work on the machine may make it many times that
_NOTEBOOK: Final = "cells.ipynb"
_OPTIONS: Final = (
    *("--no-browser", "--allow-root", "--ip=127.0.0.1", "--port=0", "--expose-app-in-browser"),
    *("--IdentityProvider.token=", "--ServerApp.password=", "--ServerApp.disable_check_xsrf=True"),
    *("--LabApp.news_url=", "--LabApp.extension_manager=readonly", "--LabApp.collaborative=False"),
)


class LabUnavailableError(RuntimeError):
    """JupyterLab or its kernel is not installed; a test skips aloud on it."""


@contextmanager
def laboratory(folder: Path, cells: Sequence[str]) -> Iterator[str]:
    """JupyterLab with one notebook; yields the notebook's address.

    Raises:
        LabUnavailableError: JupyterLab or its kernel is missing.
    """
    for name in ("jupyterlab", "ipykernel"):
        if importlib.util.find_spec(name) is None:
            raise LabUnavailableError(f"{name} is missing: pip install jupyterlab")
    root, home = folder / "notebooks", folder / "home"
    root.mkdir()
    home.mkdir()
    (root / _NOTEBOOK).write_text(json.dumps(_notebook(cells)))
    places = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    own = {name: str(home / name.lower()) for name in places}
    command = [sys.executable, "-m", "jupyterlab", *_OPTIONS, f"--ServerApp.root_dir={root}"]
    with (home / "log").open("w") as log:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, **own, "HOME": str(home)},
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        try:
            address = _address(process, home / "jupyter_runtime_dir", home / "log")
            yield f"{address}lab/tree/{_NOTEBOOK}"
        finally:
            # The kernel is in the group that the server leads.
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def _address(process: subprocess.Popen[bytes], runtime: Path, log: Path) -> str:
    end = time.monotonic() + START_S
    while time.monotonic() < end:
        if process.poll() is not None:
            raise AssertionError(f"JupyterLab ended: {log.read_text()[-2000:]}")
        for file in runtime.glob("jpserver-*.json"):
            text = file.read_text()
            if text.endswith("}"):  # whole
                return str(json.loads(text)["url"])
        time.sleep(0.1)
    raise AssertionError(f"JupyterLab does not start: {log.read_text()[-2000:]}")


def _notebook(cells: Sequence[str]) -> dict[str, Any]:
    made = [
        {
            "cell_type": "code",
            "id": f"cell{number}",
            "metadata": {},
            "execution_count": None,
            "outputs": [],
            "source": text,
        }
        for number, text in enumerate(cells)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {"cells": made, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
