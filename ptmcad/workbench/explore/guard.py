"""Who may ask the explorer's server: the browser to which the terminal's address was given, and
nobody else.

Guarantee: the token of the address is good once; what it is exchanged for is a cookie, which
scripts cannot read and which no other site's pages send, and a secret in the page, without which
nothing is computed or written. Neither is in an address, nor in any log. Requests for another
host's name (DNS rebinding) or from another origin are refused.

Not guaranteed: cookies belong to a host, not to a port: another server on this machine that the
same browser visits is sent it. Programs of the same user can read this one's memory anyway.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field

_HOSTS = ("127.0.0.1", "localhost")
HEADER = "X-Ptmcad-Secret"


def _secret() -> str:
    return secrets.token_urlsafe(32)


@dataclass(slots=True)
class Guard:
    """The secrets of one server.

    Attributes
    ----------
    port : that it listens on.
    token : of the address; empty once it has been exchanged.
    cookie : what the browser sends with every request.
    secret : what the page sends with every question.
    """

    port: int
    token: str = field(default_factory=_secret)
    cookie: str = field(default_factory=_secret)
    secret: str = field(default_factory=_secret)

    @property
    def cookie_name(self) -> str:
        """Of its own for every port, so that two explorers do not overwrite each other's."""
        return f"ptmcad-explore-{self.port}"

    @property
    def address(self) -> str:
        """What is opened first."""
        return f"http://127.0.0.1:{self.port}/?token={self.token}"

    def is_addressed(self, headers: Mapping[str, str]) -> bool:
        """Whether a request is for this server by its own name, and from a page of its own, or
        none.
        """
        hosts = [f"{host}:{self.port}" for host in _HOSTS]
        host, origin = headers.get("Host", ""), headers.get("Origin")
        return host in hosts and origin in (None, f"http://{host}")

    def knows(self, cookies: Mapping[str, str]) -> bool:
        """Whether a request comes from the browser that exchanged the token."""
        return _same(cookies.get(self.cookie_name, ""), self.cookie)

    def trusts(self, headers: Mapping[str, str]) -> bool:
        """Whether a question comes from the page itself."""
        own = (
            headers.get("Origin") is not None
            and headers.get("Sec-Fetch-Site", "same-origin") == "same-origin"
        )
        return own and _same(headers.get(HEADER, ""), self.secret)

    def exchange(self, token: str) -> bool:
        """Whether a token is the one that has not been used; it is used up then."""
        if not self.token or not _same(token, self.token):
            return False
        self.token = ""
        return True


def _same(given: str, own: str) -> bool:
    """In a time that does not tell how much of it is right."""
    return hmac.compare_digest(given.encode("utf-8", "surrogateescape"), own.encode())
