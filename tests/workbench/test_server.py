"""The server under requests that its page would not send, and with workers that die."""

from __future__ import annotations

import json
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.explorer import PATIENCE, Explorer, Reply, explorer
from support.maps import CONFIGS

from ptmcad.cli import run

pytest.importorskip("aiohttp")
RECORD = CONFIGS / "families" / "equal-loads.yaml"
PATHS = (
    "/",
    "/explore.js",
    "/page.css",
    "/api/map",
    "/nowhere",
    "/../../etc/passwd",
    "/%2e%2e/page.py",
    "//x",
    "/api/",
)


@pytest.fixture(scope="module", name="own")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    folder = tmp_path_factory.mktemp("explored")
    with explorer(RECORD, "--out", folder) as found:
        for path in PATHS:  # before the token has been exchanged
            assert found.send("GET", path).status == found.send("POST", path, "{}").status == 403, (
                path
            )
        found.enter()
        yield found


def said(reply: Reply) -> str:
    """The reply's text, which has neither a traceback nor a path of this machine."""
    text = reply.body.decode()
    assert "Traceback" not in text and 'File "' not in text and str(CONFIGS.parent) not in text
    return text


def test_every_answer_is_kept_from_caches_frames_and_other_sites(own: Explorer) -> None:
    for path, headers in (
        ("/", own.own),
        ("/", {}),
        ("/nowhere", own.own),
        ("/explore.js", own.own),
    ):
        found = own.send(
            "GET", path, headers={k: v for k, v in headers.items() if k == "Cookie"}
        ).headers
        assert found["Cache-Control"] == "no-store" and found["X-Content-Type-Options"] == "nosniff"
        policy = found["Content-Security-Policy"]
        assert (
            "default-src 'none'" in policy
            and "unsafe" not in policy
            and "frame-ancestors 'none'" in policy
        )


def test_the_cookie_is_kept_from_scripts_and_other_sites_and_secrets_are_in_no_address(
    own: Explorer,
) -> None:
    assert own.entered["Location"] == "/"
    parts = own.entered["Set-Cookie"].split("; ")
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= set(parts)
    assert own.token not in parts[0] and own.own["X-Ptmcad-Secret"] not in parts[0]


def test_the_token_is_good_once(own: Explorer) -> None:
    again = own.send("GET", f"/?token={own.token}")
    assert again.status == 403 and "used already" in said(again)
    assert "Set-Cookie" not in again.headers
    # the browser that has it may open the address in another tab
    known = own.send("GET", f"/?token={own.token}", headers={"Cookie": own.own["Cookie"]})
    assert (known.status, known.headers["Location"]) == (303, "/")
    for token in ("", "x", own.token[:-1], own.token + "x", "%00", "ü"):
        assert (
            own.send("GET", f"/?token={token.encode().hex() if token == 'ü' else token}").status
            == 403
        )


def test_without_the_cookie_there_is_nothing(own: Explorer) -> None:
    for path in PATHS:
        for headers in (
            {},
            {"Cookie": "a=b"},
            {"Cookie": own.own["Cookie"][:-1]},
            {"Cookie": own.own["Cookie"] + "x"},
        ):
            assert own.send("GET", path, headers=headers).status == 403, (path, headers)
    for missing in ("Cookie", "Origin", "X-Ptmcad-Secret"):
        headers = {k: v for k, v in own.own.items() if k != missing}
        assert own.send("POST", "/api/map", "{}", headers).status == 403, missing


@pytest.mark.parametrize(
    "wrong",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Host": "127.0.0.1"},
        {"Host": ""},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "https://127.0.0.1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"X-Ptmcad-Secret": "ä"},
    ],
)
def test_other_hosts_and_origins_are_refused(own: Explorer, wrong: dict[str, str]) -> None:
    body = json.dumps({"tab": "t", "values": {}, "fine": False, "framed": False})
    found = own.send("POST", "/api/map", body, {**own.own, **wrong})
    assert found.status == 403
    said(found)


def test_other_paths_and_methods(own: Explorer) -> None:
    cookie = {"Cookie": own.own["Cookie"]}
    for path in (
        "/nowhere",
        "/api",
        "/api/",
        "/api/map/x",
        "/explore.py",
        "/../explore.css",
        "/..%2fserver.py",
        "/page.css/",
    ):
        assert own.send("GET", path, headers=cookie).status == 404, path
    for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "HEAD"):
        assert own.send(method, "/", headers=cookie).status == 405, method
    assert own.send("BREW", "/", headers=cookie).status in (400, 405)
    assert own.send("POST", "/", "{}", own.own).status == 405
    assert own.send("GET", "/api/map", headers=own.own).status == 405


VALID = {"tab": "t", "values": {"F": "-10"}, "fine": False, "framed": False}


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ("", 400), ("{", 400), ("null", 400), ("[]", 400), ("NaN", 400), ('{"tab":1}', 400), ("[" * 10_000, 400),
        (b"\xff\xfe", 400), ("x" * 100_000, 413), (json.dumps({**VALID, "more": 1}), 400),
        (json.dumps(VALID).replace('"-10"', "NaN"), 400), (json.dumps(VALID).replace('"-10"', "1e400"), 400),
        (json.dumps(VALID).replace('"-10"', "-10"), 400), (json.dumps({**VALID, "fine": 1}), 400),
        (json.dumps({**VALID, "tab": "t" * 1000}), 400),
        (json.dumps({**VALID, "values": {f"x{k}": "1" for k in range(99)}}), 400),
        (json.dumps({**VALID, "values": {"F": "inf"}}), 422), (json.dumps({**VALID, "values": {"F": "1e999999"}}), 422),
        (json.dumps({**VALID, "values": {"F": "\x00"}}), 400), (json.dumps({**VALID, "values": {"F": "9" * 90}}), 422),
        (json.dumps({**VALID, "values": {"nobody": "1"}}), 422),
        (json.dumps({**VALID, "values": {"F": "\ud800"}}), 400),
    ],
)  # fmt: skip
def test_bodies_that_the_page_would_not_send(own: Explorer, body: str | bytes, status: int) -> None:
    found = own.send("POST", "/api/map", body, own.own)
    assert found.status == status
    said(found)


def test_a_body_has_to_say_that_it_is_json(own: Explorer) -> None:
    headers = {**own.own, "Content-Type": "text/plain"}
    assert own.send("POST", "/api/map", json.dumps(VALID), headers).status == 415


def test_names_that_lead_elsewhere_are_refused(own: Explorer) -> None:
    for name in ("../x", "/tmp/x", "a/../b", "..", "x\n", "CON"):
        found = own.ask("save", name=name, formats=["svg"])
        assert found.status in (400, 422), name
        said(found)


def test_what_is_no_http_does_no_harm(own: Explorer) -> None:
    for data in (
        b"\x16\x03\x01\x02\x00\x01",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET " + b"a" * 100_000,
        b"\r\n\r\n",
        b"POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n",
    ):
        with socket.create_connection(("127.0.0.1", own.port), PATIENCE) as connection:
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR)
            try:
                text = connection.recv(1 << 16)
            except ConnectionResetError:
                text = b""
        assert b"200" not in text[:20] and b"Traceback" not in text
    assert own.ask("map").status == 200


def test_it_listens_on_this_machine_alone(own: Explorer) -> None:
    for address in {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None)} - {
        "127.0.0.1"
    }:
        with pytest.raises(OSError):
            socket.create_connection((address, own.port), 1).close()


def test_the_last_question_of_a_tab_supersedes_those_that_wait(own: Explorer) -> None:
    """Whoever is superseded is told so; other tabs are not touched."""
    replies: dict[str, Reply] = {}

    def ask(name: str, tab: str, value: str) -> None:
        replies[name] = own.ask("map", tab=tab, values={"F": value}, fine=True)

    threads = []
    for name, tab, value in [
        *((f"own {k}", "one", str(-5 - k)) for k in range(6)),
        ("other", "two", "-30"),
    ]:
        threads.append(threading.Thread(target=ask, args=(name, tab, value)))
        threads[-1].start()
        time.sleep(0.02)
    for thread in threads:
        thread.join(PATIENCE)
    assert replies["own 5"].status == replies["other"].status == 200
    assert {replies[f"own {k}"].status for k in range(5)} <= {200, 409}
    assert 409 in {replies[f"own {k}"].status for k in range(5)}


def _children(pid: int) -> list[int]:
    return [
        int(n)
        for task in Path(f"/proc/{pid}/task").iterdir()
        for n in (task / "children").read_text().split()
    ]


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="processes are found in /proc")
def test_a_worker_that_dies_is_replaced_and_all_end_with_the_server() -> None:
    with explorer(RECORD) as found:
        found.enter()
        assert found.ask("map").status == 200
        (child,) = _children(found.process.pid)
        before = _children(child)
        assert len(before) == 2
        for worker in before:
            os.kill(worker, signal.SIGKILL)
        first = found.ask("map")
        assert first.status in (200, 503)
        if first.status == 503:
            assert "another one is there now" in first.data["error"]
        assert found.ask("map").status == 200
        after = _children(child)
        os.kill(
            found.process.pid, signal.SIGKILL
        )  # not even the process that watches may say goodbye
        end = time.monotonic() + PATIENCE
        while any(Path(f"/proc/{pid}/exe").exists() for pid in (child, *after)):
            assert time.monotonic() < end, "a process is left"
            time.sleep(0.02)


@pytest.mark.parametrize(
    ("number", "status"),
    [
        (signal.SIGINT, 130),
        pytest.param(signal.SIGTERM, 143, marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, 129, marks=pytest.mark.slow),
    ],
)
def test_it_ends_with_the_terminal(number: signal.Signals, status: int) -> None:
    with explorer(RECORD) as found:
        found.enter()
        found.process.send_signal(number)
        assert found.process.wait(PATIENCE) == status


def test_bad_records_and_ports_are_refused(
    own: Explorer, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments, word in (
        ([str(RECORD), "--port", str(own.port)], "cannot be listened on"),
        (["no-such.yaml"], "no-such.yaml"),
        ([str(RECORD), "--slider", "nobody=1:2"], "has no slider"),
    ):
        assert run(["explore", *arguments]) == 2
        assert word in capsys.readouterr().err
