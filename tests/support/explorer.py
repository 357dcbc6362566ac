"""`ptmcad explore` as a process, and a client of its server that sends whatever a test wants."""

from __future__ import annotations

import http.client
import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

PATIENCE = 60.0


class Reply(NamedTuple):
    """What came back."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def data(self) -> Any:
        return json.loads(self.body)


class Explorer:
    """A running explorer.

    Attributes
    ----------
    address : what the terminal shows.
    own : the headers of the page's questions, once it has been entered.
    entered : those of the answer to the token.
    """

    def __init__(self, process: subprocess.Popen[str], address: str):
        self.process, self.address = process, address
        self.port = int(re.findall(r":(\d+)/", address)[0])
        self.token = address.partition("token=")[2]
        self.own: dict[str, str] = {}
        self.entered: dict[str, str] = {}

    def send(
        self,
        method: str,
        path: str,
        body: str | bytes | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Reply:
        """One request, with no other headers than HTTP needs and those given."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        try:
            connection.request(method, path, body, dict(headers or {}))
            answer = connection.getresponse()
            return Reply(answer.status, dict(answer.getheaders()), answer.read())
        finally:
            connection.close()

    def enter(self) -> None:
        """Exchange the token, and read the page's secret."""
        first = self.send("GET", f"/?token={self.token}")
        assert first.status == 303, first
        self.entered = first.headers
        cookie = first.headers["Set-Cookie"].partition(";")[0]
        text = self.send("GET", "/", headers={"Cookie": cookie}).body.decode()
        data = json.loads(re.findall(r'id="data">(.*?)</script>', text)[0])
        self.own = {"Cookie": cookie, "Origin": f"http://127.0.0.1:{self.port}", "X-Ptmcad-Secret": data["secret"],
                    "Content-Type": "application/json"}  # fmt: skip

    def ask(self, kind: str, tab: str = "test", **question: Any) -> Reply:
        """A question as the page asks it."""
        body = {
            "tab": tab,
            "values": {},
            **({"fine": False, "framed": False} if kind == "map" else {}),
            **question,
        }
        return self.send("POST", f"/api/{kind}", json.dumps(body), self.own)


@contextmanager
def explorer(*arguments: str | Path) -> Iterator[Explorer]:
    """The command, until the end of the block; it must end in silence then."""
    process = subprocess.Popen(
        [sys.executable, "-m", "ptmcad", "explore", *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found, process.communicate(timeout=PATIENCE)
        yield Explorer(process, found[0])
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=PATIENCE)
    assert not err and "Traceback" not in out, err
