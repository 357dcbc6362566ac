"""The explorer's local server: one page, its scripts, and the questions that it asks.

Guarantee: it listens on 127.0.0.1 alone; without cookie every request but the first one with the
token is refused, whatever its path; bodies are small JSON; every answer has headers that keep it
out of caches, frames and other sites. Whatever clients send, or do not send, it holds a bounded
number of connections, none of them silent for long, answers the others, and prints nothing. It ends
with its process and takes its workers with it.
"""

from __future__ import annotations

import asyncio
import json
import logging
import os
import socket
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, NoReturn

from aiohttp import web
from aiohttp.http_exceptions import HttpProcessingError

from ptmcad.errors import ConfigError
from ptmcad.text.codec import TRUTH, Codec, line, listed, named, record
from ptmcad.text.node import Node
from ptmcad.workbench.explore.explorepage import ASSETS, asset, page, refusal
from ptmcad.workbench.explore.guard import Guard
from ptmcad.workbench.explore.jobqueue import JobQueue
from ptmcad.workbench.explore.jobs import Tasks
from ptmcad.workbench.explore.panel import SliderPanel

MAX_BODY = 1 << 14
MAX_CONNECTIONS = 64
"""That are open, or a quarter of the files that the process may have open; the others wait in the
system's queue.
"""
SILENT_SECONDS = 10.0
"""After which a connection without a request under way is closed, before the first one as well, and
for a body.
"""
_PAUSE = 0.1
"""Seconds until another look at what is full."""
MAX_ENTRIES, MAX_TEXT = 60, 100
"""Of a mapping in a question, and characters of a text."""
HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
}
STATUS = {"done": 200, "superseded": 409, "refused": 422, "lost": 503}
KINDS = {"map": ("fine", "framed"), "point": ("at",), "record": (), "save": ("name", "formats")}
"""The entries of a question of each kind, besides its tab and the sliders' values."""
_LOG = logging.getLogger("ptmcad.explore")
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class _Server:
    """The page's side and the workers': one for maps and files, another one for points, so that
    these do not wait.
    """

    def __init__(self, panel: SliderPanel, folder: Path, guard: Guard) -> None:
        self.panel, self.guard = panel, guard
        maps, points = (JobQueue(Tasks(panel, folder).answer) for _ in range(2))
        self.workers = {"map": maps, "save": maps, "point": points, "record": points}
        self.asking: set[web.RequestHandler] = set()

    async def accept(self, own: socket.socket, make: web.Server) -> NoReturn:
        """Take connections; where as many are open as may be, the oldest without a question under
        way makes room.
        """
        loop = asyncio.get_running_loop()
        most = min(MAX_CONNECTIONS, os.sysconf("SC_OPEN_MAX") // 4)
        while True:
            while len(make.connections) >= most:
                ends = [
                    c.transport for c in make.connections if c.transport and c not in self.asking
                ]
                for end in ends[:1]:
                    end.abort()  # what it has not read of an answer is not waited for
                await asyncio.sleep(0 if ends else _PAUSE)
            try:
                accepted, _ = await loop.sock_accept(own)
                await loop.connect_accepted_socket(make, accepted)
            except (
                OSError
            ):  # the client has gone already, or there is no room for another file at the moment
                await asyncio.sleep(_PAUSE)

    def application(self) -> web.Application:
        """The routes, behind the guard."""
        app = web.Application(middlewares=[self._guarded], client_max_size=MAX_BODY)
        app.router.add_get("/", self._page)
        for name in ASSETS:
            app.router.add_get(f"/{name}", self._asset)
        for kind in KINDS:
            app.router.add_post(f"/api/{kind}", self._question)
        app.on_response_prepare.append(_with_headers)
        return app

    @web.middleware
    async def _guarded(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse whoever is not known, before anything is looked at, and answer all refusals in
        words.
        """
        if not self.guard.is_addressed(request.headers):
            return _refused(403, "this is no request of the explorer's own page")
        token = request.query.get("token")
        if token is not None and request.method == "GET" and request.path == "/":
            return self._exchanged(request, token)
        if not self.guard.knows(request.cookies):
            return _refused(
                403,
                "the address with the token, which the terminal shows, opens the explorer, once",
            )
        if request.method not in ("GET", "POST"):
            return _refused(405, "there is nothing to do in this way")
        try:
            return await handler(request)
        except web.HTTPException as error:
            return _refused(error.status, error.reason.lower())

    def _exchanged(self, request: web.Request, token: str) -> web.Response:
        """The cookie for the token; a browser that has it already is let in by any token."""
        known = self.guard.knows(request.cookies)
        if not known and not self.guard.exchange(token):
            return _refused(
                403,
                "this address has been used already, or was never right: start ptmcad explore again",
            )
        # the cookie is sent with what a page of this server asks for: not where a file, or another
        # site, has led here
        led = request.headers.get("Sec-Fetch-Site") == "cross-site"
        answer = web.Response(
            status=200 if led else 303,
            headers={"Refresh": "0; url=/"} if led else {"Location": "/"},
        )
        if not known:
            answer.set_cookie(
                self.guard.cookie_name,
                self.guard.cookie,
                httponly=True,
                samesite="Strict",
                path="/",
            )
        return answer

    async def _page(self, _request: web.Request) -> web.Response:
        return web.Response(
            text=page(self.panel, self.guard.secret), content_type="text/html", charset="utf-8"
        )

    async def _asset(self, request: web.Request) -> web.Response:
        name = request.path.removeprefix("/")
        return web.Response(text=asset(name), content_type=ASSETS[name][1], charset="utf-8")

    async def _question(self, request: web.Request) -> web.Response:
        if not self.guard.trusts(request.headers):
            return _refused(403, "this question does not come from the explorer's own page")
        if request.content_type != "application/json":
            return _refused(415, "a question is JSON")
        kind = request.path.rpartition("/")[2]
        try:
            async with asyncio.timeout(SILENT_SECONDS):
                job = job_of(kind, await request.read())
            self.panel.values(job["values"])  # what is wrong with them is said without a worker
        except (
            ValueError,
            OSError,
            web.RequestPayloadError,
        ) as error:  # or it is too slow, gone, or cut in no chunks
            return web.json_response(
                {"error": str(error) or "a question comes whole, and at once"}, status=400
            )
        except ConfigError as error:
            return web.json_response({"error": str(error)}, status=422)
        self.asking.add(request.protocol)
        try:
            ended, body = await self.workers[kind].ask(job.pop("tab"), job)
        finally:
            self.asking.remove(request.protocol)
        return web.Response(body=body, status=STATUS[ended], content_type="application/json")


def job_of(kind: str, body: bytes) -> dict[str, Any]:
    """The job in a question's body.

    Raises
    ------
    ValueError
        For anything that the page would not send.
    """
    try:
        question = Node(json.loads(body.decode("utf-8")), "")
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise ValueError("a question is JSON, and this is none") from error
    found: dict[str, Any] = record(
        dict, **{name: _PARTS[name] for name in ("tab", "values", *KINDS[kind])}
    ).read(question)
    return {"kind": kind, **found}


_TEXT = line(MAX_TEXT)
_PARTS: dict[str, Codec[Any]] = {
    "tab": _TEXT, "values": named(_TEXT, most=MAX_ENTRIES), "at": named(_TEXT, most=MAX_ENTRIES), "fine": TRUTH,
    "framed": TRUTH, "name": _TEXT, "formats": listed(_TEXT, most=9),
}  # fmt: skip


def _refused(status: int, reason: str) -> web.Response:
    """A refusal as a page, for a person who opens an address."""
    return web.Response(
        text=refusal(status, reason), status=status, content_type="text/html", charset="utf-8"
    )


async def _with_headers(_request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(HEADERS)
    response.headers["Server"] = "ptmcad"


def _is_own_fault(record: logging.LogRecord) -> bool:
    """Whether a message is about an error of this program: what is sent that is no HTTP is
    answered, and no news.
    """
    return not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))


def listening(port: int) -> socket.socket:
    """A socket on 127.0.0.1.

    Raises
    ------
    ConfigError
        When the port is taken, or not this user's to take.
    """
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.setblocking(False)
        found.bind(("127.0.0.1", port))
        found.listen(256)
    except OSError as error:
        found.close()
        raise ConfigError(
            f"port {port} cannot be listened on: {error.strerror}", key="--port"
        ) from error
    return found


async def serve(
    panel: SliderPanel, folder: Path, port: int, announce: Callable[[str], None]
) -> NoReturn:
    """Serve until this process is ended.

    Parameters
    ----------
    folder : where figures go that the page saves.
    port : to listen on; 0 for any that is free.
    announce : called with the address once it can be opened.

    Raises
    ------
    ConfigError
        When the port cannot be listened on.
    """
    own = listening(port)
    guard = Guard(own.getsockname()[1])
    server = _Server(panel, folder, guard)
    _LOG.addFilter(_is_own_fault)
    app = server.application()
    runner = web.AppRunner(
        app, access_log=None, logger=_LOG, handle_signals=False, shutdown_timeout=0.1, lingering_time=1,
        keepalive_timeout=SILENT_SECONDS, handler_cancellation=True, auto_decompress=False,
    )  # fmt: skip
    await runner.setup()
    assert runner.server is not None
    try:
        async with asyncio.TaskGroup() as tasks:
            for worker in {id(w): w for w in server.workers.values()}.values():
                tasks.create_task(worker.run())
            tasks.create_task(server.accept(own, runner.server))
            announce(guard.address)
    finally:
        await runner.cleanup()
        own.close()
    raise AssertionError("workers run until they are cancelled")
