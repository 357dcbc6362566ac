"""A picture's stamp: the SHA-256 of the JSON that it was written with, which tells whether both are of one set.

Guarantee: what is drawn stays as it was; readers of each format pass over the stamp, which ``grep -a sha256`` shows.
It is a text chunk of a PNG, and a comment in an SVG, a PDF and an EPS.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from hashlib import sha256
from pathlib import Path

_END_OF_PNG = 12
"""Bytes of a PNG's last chunk, which is empty."""


def _png(content: bytes, stamp: bytes) -> bytes:
    chunk = b"tEXtSource\0" + stamp
    length = (len(chunk) - len(b"tEXt")).to_bytes(4)
    text = length + chunk + zlib.crc32(chunk).to_bytes(4)
    return content[:-_END_OF_PNG] + text + content[-_END_OF_PNG:]


def _svg(content: bytes, stamp: bytes) -> bytes:
    return content + b"<!-- " + stamp.replace(b"--", b"- -") + b" -->\n"


def _postscript(content: bytes, stamp: bytes) -> bytes:
    body, end, rest = content.rpartition(b"%%EOF")
    return body + b"% " + stamp + b"\n" + end + rest


_STAMPED: Mapping[bytes, Callable[[bytes, bytes], bytes]] = {
    b"\x89PNG": _png,
    b"<?xm": _svg,
    b"%PDF": _postscript,
    b"%!PS": _postscript,
}
"""How pictures whose content begins so are stamped."""


def stamp(pictures: list[Path], voucher: Path) -> None:
    """Give every picture among the files the stamp of a JSON document that is written.

    Raises
    ------
    OSError
        When a file cannot be read or written.
    """
    if voucher.suffix != ".json":
        return
    text = f"sha256 of {voucher.name}: {sha256(voucher.read_bytes()).hexdigest()}"
    for path in pictures:
        content = path.read_bytes()
        if content[:4] in _STAMPED:
            path.write_bytes(_STAMPED[content[:4]](content, text.encode("ascii", "replace")))
