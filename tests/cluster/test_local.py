"""The cluster of ``--cluster local``: nobody else gets in, and nothing of it stays."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import distributed
import psutil
import pytest
from distributed.security import Security

from distal.cluster import ClusterError, connected, connecting
from distal.lang import Frame, image, vec3
from distal.video import video
from tests.cluster.schedulers import wait

# What another user can try: to talk to a port without TLS, and to read files of a process.
STRANGER = """
import encodings.idna, json, os, socket, ssl, sys
ports, files, user = json.loads(sys.argv[1])
if user:
    os.setgroups([])
    os.setgid(user)
    os.setuid(user)
answers, read = {}, []
for port in ports:
    # A message of Dask's protocol: how long it is, how many frames it has and how long they are.
    message = b"".join(number.to_bytes(8, "little") for number in (25, 1, 9))
    message += b"\\x81\\xa2op\\xa4ping"
    for text in (message, b"GET /json/identity.json HTTP/1.0\\r\\n\\r\\n", b""):
        with socket.create_connection(("127.0.0.1", port), 5) as plain:
            try:
                plain.settimeout(0.3)
                plain.sendall(text)
                answer = plain.recv(100)
            except OSError:
                answer = b""
            # 21 is the type of a TLS alert.
            answers.setdefault(port, []).append(answer[:1] not in (b"", b"\\x15"))
    context = ssl._create_unverified_context()
    try:
        with context.wrap_socket(socket.create_connection(("127.0.0.1", port), 1)) as secret:
            answers[port].append(bool(secret.recv(100)))
    except OSError:
        answers[port].append(False)
for file in files:
    try:
        os.listdir(file) if os.path.isdir(file) else open(file, "rb").read()
        read.append(file)
    except OSError:
        pass
print(json.dumps([sorted(port for port in answers if any(answers[port])), read]))
"""


@image
def plain(frame: Frame) -> vec3:
    """A picture."""
    return vec3(frame.coord.x / 64.0, frame.coord.y / 48.0, 0.5 + 0.5 * frame.time)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder for temporary files that everybody can enter, as the system's."""
    tmp_path_factory.getbasetemp()  # not in it
    with tempfile.TemporaryDirectory() as path, pytest.MonkeyPatch.context() as changed:
        os.chmod(path, 0o755)
        changed.setattr(tempfile, "tempdir", path)
        yield Path(path)


@pytest.fixture(scope="module")
def cluster(folder):
    """Two workers, and the addresses on which they and their scheduler listen."""
    before = listening()
    with connected("local:2") as pool:
        yield pool, listening() - before
    assert not list(folder.iterdir())


@pytest.fixture
def pool(cluster):
    """Two workers."""
    return cluster[0]


@pytest.fixture
def ports(cluster):
    """The ports of the cluster."""
    return {port for _, port in cluster[1]}


def listening():
    """The addresses on which this process and its children listen."""
    own = psutil.Process()
    return {
        tuple(connection.laddr)
        for process in (own, *own.children(recursive=True))
        for connection in process.net_connections("inet")
        if connection.status == psutil.CONN_LISTEN
    }


def workers():
    """The processes of the workers."""
    found = []
    for child in psutil.Process().children():
        with suppress(psutil.Error):  # it ends just now
            if "local_worker" in " ".join(child.cmdline()):
                found.append(child)
    return found


def stranger(ports, files=(), user=0):
    """The ports that answer a stranger, and the files that one reads."""
    made = subprocess.run(
        [sys.executable, "-I", "-c", STRANGER, json.dumps([list(ports), list(files), user])],
        **{"capture_output": True, "text": True, "timeout": 60, "cwd": "/"},
    )
    assert made.returncode == 0, made.stderr
    return json.loads(made.stdout)


def test_one_port_each_on_this_machine_alone(cluster):
    pool, addresses = cluster
    assert len(addresses) == 3 and {host for host, _ in addresses} == {"127.0.0.1"}
    known = pool.client.scheduler_info(n_workers=-1)["workers"]
    assert all(address.startswith("tls://127.0.0.1:") for address in known)


def test_a_stranger_gets_no_answer(ports, tmp_path):
    before = listening()
    assert stranger(ports)[0] == []
    plain = {"host": "127.0.0.1", "port": 0, "dashboard_address": "127.0.0.1:0"}
    options = {**plain, "local_directory": str(tmp_path)}
    scheduler = {"cls": distributed.Scheduler, "options": options}
    with distributed.SpecCluster({}, scheduler):
        # The same questions to a scheduler without TLS, and to its pages.
        assert len(stranger({port for _, port in listening() - before})[0]) == 2


@pytest.mark.parametrize("protocol", ["tcp", "tls"])
def test_a_client_without_the_credentials_is_refused(ports, protocol):
    security = Security.temporary() if protocol == "tls" else None
    for port in ports:
        with pytest.raises(OSError):
            distributed.Client(
                f"{protocol}://127.0.0.1:{port}",
                security=security,
                timeout=1.0,
                set_as_default=False,
            )


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs two users")
def test_another_user_reaches_nothing(ports, folder):
    of_processes = ("environ", "mem", "fd", "fd/0", "maps")
    files = [f"/proc/{worker.pid}/{name}" for worker in workers() for name in of_processes]
    files += map(str, folder.rglob("*"))
    assert len(files) > 12
    assert stranger(ports, files, user=65534) == [[], []]


def test_the_key_is_in_no_file_argument_or_variable(pool, folder):
    assert len(workers()) == 2
    for worker in workers():
        public = " ".join((*worker.cmdline(), *worker.environ().values()))
        assert "PRIVATE KEY" not in public and "CERTIFICATE" not in public
    texts = [path.read_bytes() for path in folder.rglob("*") if path.is_file()]
    assert texts and not any(b"PRIVATE KEY" in text for text in texts)


@pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are those of POSIX")
def test_ctrl_c_of_a_terminal_reaches_no_worker(pool):
    assert workers() and all(os.getpgid(worker.pid) != os.getpgid(0) for worker in workers())


def test_a_film_has_the_same_bits(pool, tmp_path):
    options = {"duration": 0.5, "fps": 12, "size": (64, 48), "quality": "lossless"}
    for name, cluster in (("alone.mp4", None), ("together.mp4", pool)):
        video(plain, tmp_path / name, cluster=cluster, **options)
    assert (tmp_path / "alone.mp4").read_bytes() == (tmp_path / "together.mp4").read_bytes()


def test_a_worker_that_ends_is_replaced(pool):
    first = workers()
    first[0].kill()
    wait(lambda: len(workers()) == len(pool.client.nthreads()) == 2)
    assert workers() != first
    assert (plain.render((64, 400), cluster=pool).array == plain.render((64, 400)).array).all()


COMMAND = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
{before}
from distal.cli import main
sys.argv = ["distal", "render", "example:raymarcher", "--size", "48x32", "-o", "a.png"]
sys.argv += ["--cluster", "local:1", "--progress", "json"]
main()
"""
NO_SEMAPHORES = """
import _multiprocessing
class SemLock:
    SEM_VALUE_MAX = 1
    def __init__(self, *_):
        raise FileNotFoundError(2, "No such file or directory")
_multiprocessing.SemLock = SemLock
"""


def command(folder, before):
    temporary = folder / "temporary"
    temporary.mkdir()
    paths = os.pathsep.join(sys.path)
    made = subprocess.run(
        [sys.executable, "-c", COMMAND.format(before=before)],
        **{"cwd": folder, "capture_output": True, "text": True, "timeout": 100},
        env={**os.environ, "PYTHONPATH": paths, "TMPDIR": str(temporary)},
    )
    assert not list(temporary.iterdir())
    errors = [line for line in made.stderr.splitlines() if not line.startswith("{")]
    return made.returncode, errors


def test_without_semaphores(tmp_path):
    """They are in /dev/shm, which is not everywhere."""
    code, _ = command(tmp_path, NO_SEMAPHORES)
    assert code == 0 and (tmp_path / "a.png").exists()


def test_without_cryptography(tmp_path):
    assert command(tmp_path, "sys.modules['cryptography'] = None") == (
        1,
        ["error: cryptography is missing: pip install 'distal[cluster]'"],
    )


def test_workers_that_end_as_they_start(tmp_path):
    """The last line of one says why."""
    broken = tmp_path / "broken"
    (broken / "distributed").mkdir(parents=True)
    (broken / "distributed" / "__init__.py").write_text("raise OSError('no luck')")
    before = f"import distributed; sys.path.insert(0, {str(broken)!r})"
    code, [error] = command(tmp_path, before)
    assert code == 1 and error.startswith("error: the workers of 'local' end as they start: ")
    assert "distributed cannot be loaded: OSError: no luck" in error


def test_no_folder_for_temporary_files(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "nowhere"))
    said = r"^'local' needs a folder for temporary files: .*No such file or directory"
    with pytest.raises(ClusterError, match=said), connected("local:1"):
        pass


def test_the_process_that_started_it_is_killed(tmp_path):
    """Its workers end with it, and remove the folder."""
    code = (
        "import os, sys, time\nfrom distal.cluster import connected\n"
        "with connected('local:2') as pool:\n    print('up', flush=True)\n    time.sleep(60)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": str(tmp_path)}
    with subprocess.Popen(
        [sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"up\n"
        begun = psutil.Process(process.pid).children()
        assert len(begun) == 2 and list(tmp_path.iterdir())
        os.kill(process.pid, signal.SIGKILL)
    assert not psutil.wait_procs(begun, timeout=30)[1]
    assert not list(tmp_path.iterdir())


def test_the_system_has_no_list_of_processes(monkeypatch):
    monkeypatch.setattr(connecting.sys, "platform", "linux")
    monkeypatch.setattr(Path, "exists", lambda path: False)
    said = r"^Dask needs /proc, which is not there; without"
    with pytest.raises(ClusterError, match=said), connected("local:1"):
        pass


@pytest.mark.parametrize(
    ("address", "is_open"),
    [
        ("tcp://10.0.0.7:8786", True),
        ("ws://cluster.example:8786", True),
        ("tcp://[2001:db8::1]:8786", True),
        ("tls://10.0.0.7:8786", False),
        ("tcp://127.0.0.1:8786", False),
        ("tcp://[::1]:8786", False),
        ("tcp://localhost:8786", False),
    ],
)
def test_which_schedulers_are_open_to_a_network(address, is_open):
    assert connecting._is_open(address) == is_open
