"""A scheduler by TLS, with certificates that the test makes: who has one is served, others not."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time

import dask
import pytest
from distributed import Client
from distributed.security import Security

from distal.cluster import ClusterError, WorkerPool, connected
from distal.lang import Frame, image, vec3
from tests.cluster.schedulers import end, scheduler, wait, worker

trustme = pytest.importorskip("trustme")


@image
def plain(frame: Frame) -> vec3:
    """A picture."""
    return vec3(frame.coord.x / 64.0, frame.coord.y / 48.0, 0.5)


def certificates(folder, name):
    """The environment of a process with a certificate of an authority of its own."""
    authority = trustme.CA()
    issued = authority.issue_cert("127.0.0.1", "localhost")
    files = {part: str(folder / f"{name}-{part}.pem") for part in ("ca", "cert", "key")}
    authority.cert_pem.write_to_path(files["ca"])
    issued.private_key_pem.write_to_path(files["key"])
    for number, part in enumerate(issued.cert_chain_pems):
        part.write_to_path(files["cert"], append=number > 0)
    tls = "DASK_DISTRIBUTED__COMM__TLS"
    roles = {
        f"{tls}__{role}__{part}": files[part.lower()]
        for role in ("SCHEDULER", "WORKER", "CLIENT")
        for part in ("CERT", "KEY")
    }
    return {
        f"{tls}__CA_FILE": files["ca"],
        **roles,
        "DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION": "True",
    }


@pytest.fixture(scope="module")
def secure(tmp_path_factory):
    """The address of a scheduler with a worker, and the environment that they trust."""
    folder = tmp_path_factory.mktemp("tls")
    trusted = certificates(folder, "own")
    file = folder / "scheduler.json"
    with scheduler(file, "--protocol", "tls", environment=trusted):
        started = worker(file, environment=trusted)
        try:
            yield json.loads(file.read_text())["address"], trusted, folder
        finally:
            end(started)


COMMAND = """
import sys
from distal.cli import main
sys.argv = ["distal", *{arguments!r}]
main()
"""


def rendered(address, environment, path):
    """Run ``distal render`` with an environment."""
    arguments = ["render", "example:raymarcher", "--size", "48x32", "-o", str(path)]
    code = COMMAND.format(arguments=[*arguments, "--cluster", address, "--progress", "json"])
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=100,
    )


def test_a_picture_by_tls(secure, tmp_path):
    address, trusted, _ = secure
    assert address.startswith("tls://127.0.0.1:")
    ca, cert, key = (
        trusted[f"DASK_DISTRIBUTED__COMM__TLS__{name}"]
        for name in ("CA_FILE", "CLIENT__CERT", "CLIENT__KEY")
    )
    own = Security(
        tls_ca_file=ca, tls_client_cert=cert, tls_client_key=key, require_encryption=True
    )
    with Client(address, security=own, set_as_default=False) as client:
        wait(lambda: client.nthreads())
        together = plain.render((64, 48), cluster=WorkerPool(client))
    assert (together.array == plain.render((64, 48)).array).all()
    # The command takes them from Dask's configuration.
    made = rendered(address, trusted, tmp_path / "a.png")
    assert made.returncode == 0 and (tmp_path / "a.png").exists(), made.stderr


def test_without_a_certificate(secure):
    address = secure[0]
    begin = time.monotonic()
    with pytest.raises(ClusterError) as caught, connected(address):
        pass
    assert str(caught.value) == (
        f"{address} needs a certificate: Dask's settings distributed.comm.tls.ca-file, client.cert "
        "and client.key name the files"
    )
    assert time.monotonic() - begin < 15


def test_with_a_certificate_that_is_not_there(secure):
    address = secure[0]
    names = ("ca-file", "client.cert", "client.key")
    with (
        dask.config.set({f"distributed.comm.tls.{name}": "nowhere.pem" for name in names}),
        pytest.raises(ClusterError) as caught,
        connected(address),
    ):
        pass
    start = f"the certificate for {address} cannot be read: "
    assert str(caught.value).startswith(start) and "client.key name it" in str(caught.value)


def test_with_a_certificate_of_another_authority(secure, tmp_path):
    address, _, folder = secure
    made = rendered(address, certificates(folder, "other"), tmp_path / "b.png")
    assert made.returncode == 1 and not (tmp_path / "b.png").exists()
    errors = [line for line in made.stderr.splitlines() if not line.startswith("{")]
    assert len(errors) == 1 and "Traceback" not in made.stderr, made.stderr
    assert errors[0].startswith(f"error: no scheduler answers at {address}: ")
    assert "certificate" in errors[0].lower()


def test_without_encryption(secure, tmp_path):
    address = secure[0].replace("tls://", "tcp://")
    with pytest.raises(ClusterError) as caught, connected(address):
        pass
    assert str(caught.value).startswith(f"no scheduler answers at {address}: ")
