"""`ptmcad explore` under clients that do harm: it answers its own page, and prints nothing but its
address.
"""

from __future__ import annotations

import json
import os
import random
import resource
import socket
import struct
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
from support import browser as chromium
from support.browser import Browser
from support.explorer import PATIENCE, Explorer, explorer

pytest.importorskip("aiohttp")

RECORD = """\
name: cusp
system:
  unknowns: {x: real}
  parameters: {c: {default: 0}}
  potential: "x^4/4 + (a + c)*x^2/2 + b*x"
axes: {a: [-2, 2], b: [-1, 1]}
parameters: {c: 0}
"""
QUESTION = {"tab": "t", "values": {}, "fine": False, "framed": False}


@pytest.fixture(scope="module", name="record")
def record_fixture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "cusp.yaml"
    path.write_text(RECORD, encoding="utf-8")
    return path


@pytest.fixture(scope="module", name="own")
def running(record: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    """An explorer whose end shows that it has printed nothing on standard error."""
    with explorer(record, "--out", tmp_path_factory.mktemp("explored")) as found:
        found.enter()
        yield found
        assert found.ask("map").status == 200


def connected(own: Explorer) -> socket.socket:
    return socket.create_connection(("127.0.0.1", own.port), PATIENCE)


def head(own: Explorer, *lines: str, path: str = "/api/map") -> bytes:
    """A request of the page, up to its body."""
    known = [f"{name}: {value}" for name, value in own.own.items()]
    first = [f"POST {path} HTTP/1.1", f"Host: 127.0.0.1:{own.port}"]
    return "\r\n".join([*first, *known, *lines, "", ""]).encode()


def status_of(connection: socket.socket) -> int:
    return int(connection.recv(1 << 12).split(b" ")[1])


BODIES = {
    "no gzip": (("Content-Encoding: gzip", "Content-Length: 7"), b"garbage"),
    "no deflate": (("Content-Encoding: deflate", "Content-Length: 8"), b"\0garbage"),
    "an unknown encoding": (("Content-Encoding: foo", "Content-Length: 2"), b"{}"),
    "no chunk": (("Transfer-Encoding: chunked",), b"zz\r\nabc"),
    "a chunk with another end": (("Transfer-Encoding: chunked",), b'5\r\n{"a":xxxxx\r\n0\r\n\r\n'),
    "a chunk of less than nothing": (("Transfer-Encoding: chunked",), b"-5\r\nabc\r\n"),
    "an unknown transfer": (("Transfer-Encoding: foo",), b"abc"),
    "a length of less than nothing": (("Content-Length: -5",), b""),
    "no UTF-8": (("Content-Length: 2",), b"\xff\xfe"),
    "half an object": (("Content-Length: 7",), b'{"tab":'),
    "another protocol": (("Upgrade: websocket", "Connection: Upgrade", "Content-Length: 2"), b"{}"),
}


@pytest.mark.parametrize("kind", BODIES)
def test_a_damaged_body_is_answered_with_400(own: Explorer, kind: str) -> None:
    """That nothing is printed is seen at the explorer's end."""
    lines, body = BODIES[kind]
    with connected(own) as connection:
        connection.sendall(head(own, *lines) + body)
        assert status_of(connection) == 400


@pytest.mark.slow
def test_a_silent_connection_is_closed(own: Explorer) -> None:
    """Before the first request, within its head or its body, and after an answer."""
    with ExitStack() as stack:
        nothing, part, body, kept = (stack.enter_context(connected(own)) for _ in range(4))
        part.sendall(b"GET / HTTP/1.1\r\nHost:")
        body.sendall(head(own, "Content-Length: 500") + b"{")
        kept.sendall(head(own, "Content-Length: 2") + b"{}")
        for connection in (body, kept):
            assert status_of(connection) == 400
        for connection in (nothing, part, body, kept):
            while connection.recv(1 << 12):
                pass


def cut(connection: socket.socket) -> None:
    """Close with a reset."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


@pytest.mark.parametrize("number", [300, pytest.param(3000, marks=pytest.mark.slow)])
def test_what_is_no_request_does_no_harm(own: Explorer, number: int) -> None:
    """Random bytes, and a question with bytes replaced, removed and put in."""
    drawn, body = random.Random(39), json.dumps(QUESTION).encode()
    whole = head(own, f"Content-Length: {len(body)}") + body
    for k in range(number):
        data = bytearray(whole)
        for _ in range(drawn.choice((1, 2, 5))):
            place = drawn.randrange(len(data))
            more = (b"\r\n", b"\0", b"\xff", b"9" * 30, b":", b"", b"%ff", b"\xed\xa0\x80")
            data[place : place + drawn.randrange(20)] = drawn.choice(more)
        sent = drawn.randbytes(drawn.choice((1, 99, 20_000))) if k % 3 == 0 else bytes(data)
        with suppress(OSError), connected(own) as connection:  # it may close before all is sent
            connection.sendall(sent)
            if k % 2:
                cut(connection)
    assert own.ask("map").status == 200


@pytest.mark.parametrize(
    ("limit", "number"), [(80, 120), pytest.param(1024, 1500, marks=pytest.mark.slow)]
)
def test_idle_connections_keep_nobody_out(record: Path, limit: int, number: int) -> None:
    """More than the process may have files; some have sent a part, and some do not read what they
    asked for.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (limit, hard))
    try:
        running = explorer(record)
        own = running.__enter__()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 2048), hard))
    with ExitStack() as stack:
        stack.push(running)
        stack.callback(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        own.enter()
        get = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{own.port}\r\nCookie: {own.own['Cookie']}\r\n\r\n".encode()
        for k in range(number):
            with suppress(OSError):
                connection = stack.enter_context(connected(own))
                connection.sendall((b"", b"GET / HT", get * 50)[k % 3])
            if k % (number // 4) == 0:
                assert own.ask("map").status == 200
        (child,) = _children(own.process.pid)
        assert len(os.listdir(f"/proc/{child}/fd")) < limit


def _children(pid: int) -> list[int]:
    return [
        int(n)
        for task in Path(f"/proc/{pid}/task").iterdir()
        for n in (task / "children").read_text().split()
    ]


# ---------------------------------------------------------------------------------------------------------------- files


@pytest.fixture(name="saver")
def saver_fixture(record: Path, tmp_path: Path) -> Iterator[tuple[Explorer, Path]]:
    with explorer(record, "--out", tmp_path / "saved") as found:
        found.enter()
        yield found, tmp_path / "saved"


def test_what_is_saved_takes_new_names_alone(saver: tuple[Explorer, Path], tmp_path: Path) -> None:
    """A link that leads nowhere is something too, and nothing else is written then."""
    own, folder = saver
    assert own.ask("save", name="one", formats=[]).data == {"files": ["one.yaml", "one.json"]}
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert set(before) == {"one.yaml", "one.json"}
    (folder / "two.json").symlink_to(tmp_path / "nowhere")
    for name in ("one", "two"):
        refused = own.ask("save", name=name, formats=[], values={"c": "1/2"})
        assert (
            refused.status == 422
            and "is there already: choose another name" in refused.data["error"]
        )
    assert (folder / "two.json").is_symlink() and not (tmp_path / "nowhere").exists()
    (folder / "two.json").unlink()
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_what_clients_that_have_gone_have_asked_for_is_not_made(
    saver: tuple[Explorer, Path],
) -> None:
    """But for what was under way when they went: the worker takes one job at a time, the oldest
    first.
    """
    own, folder = saver
    for k in range(30):
        body = json.dumps(
            {"tab": f"{k}", "values": {"c": f"{k}/97"}, "name": f"gone-{k}", "formats": []}
        ).encode()
        connection = connected(own)
        connection.sendall(head(own, f"Content-Length: {len(body)}", path="/api/save") + body)
        cut(connection)
    assert own.ask("save", name="last", formats=[]).status == 200
    assert len(list(folder.glob("gone-*.json"))) < 15


@pytest.mark.parametrize("kind", ["file", "link"])
def test_a_name_that_is_taken_while_files_are_written_is_not_replaced(
    record: Path, tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By another program, in the moment before the files are put into place: none of them is there
    then.
    """
    from ptmcad.errors import OutputError
    from ptmcad.process.output import text_writer, write_files

    place = tmp_path / "two.json"

    def late(path: Path) -> None:
        text_writer("ours")(path)
        place.symlink_to(tmp_path / "nowhere") if kind == "link" else place.write_text(
            "theirs", encoding="utf-8"
        )

    with pytest.raises(OutputError, match=r"File exists; earlier files are as they were"):
        write_files(tmp_path, {"two.yaml": text_writer("ours"), "two.json": late}, new=True)
    assert [path.name for path in tmp_path.iterdir()] == ["two.json"]
    assert place.is_symlink() if kind == "link" else place.read_text(encoding="utf-8") == "theirs"


# ---------------------------------------------------------------------------------------------------------------- token


@pytest.fixture(name="opened")
def opened_fixture(
    record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[Explorer, Path]]:
    """An explorer that has started the desktop's browser, and the file that this was given."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "own").mkdir()
    program, given = tmp_path / "bin" / "xdg-open", tmp_path / "given"
    program.write_text(
        f'#!/bin/sh\nprintf "%s" "$*" > {given}.part\nmv {given}.part {given}\n', encoding="utf-8"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    monkeypatch.setenv("TMPDIR", str(tmp_path / "own"))
    with explorer(record, "--open") as found:
        end = time.monotonic() + PATIENCE
        while not given.exists():
            assert time.monotonic() < end
            time.sleep(0.01)
        yield found, Path(given.read_text(encoding="utf-8"))
    assert not list((tmp_path / "own").iterdir())


def test_the_token_is_in_no_process_list(opened: tuple[Explorer, Path]) -> None:
    """The browser is given a file that this user alone can read; it is gone when the explorer is."""
    own, file = opened
    assert own.token not in str(file) and own.address in file.read_text(encoding="utf-8")
    assert (file.stat().st_mode & 0o777, file.parent.stat().st_mode & 0o777) == (0o600, 0o700)
    lists = [path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline") if path.exists()]
    assert not any(own.token.encode() in line for line in lists)


@pytest.mark.skipif(chromium.PROGRAM is None, reason=chromium.MISSING)
def test_the_file_leads_a_browser_to_the_page(one: Browser, opened: tuple[Explorer, Path]) -> None:
    """Whose cookie no other site's pages send, nor a file."""
    own, file = opened
    one.visit(file.as_uri(), "typeof view !== 'undefined' && view.shown !== null")
    assert one.run("location.href") == f"http://127.0.0.1:{own.port}/"
    assert one.complaints() == []
