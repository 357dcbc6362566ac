"""Damage to texts and to JSON trees, drawn from a seeded generator.

Guarantee: the same generator state gives the same damage, in every process. Nothing here knows what
the damaged text means: tokens are numbers, words and signs, and a JSON tree is damaged wherever
recursion leads.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

NUMBERS = (
    "0", "1", "-1", "2", "3", "64", "65", "-0", "00", "1/2", "-7/3", "0.1", "1e-30", "1e-400", "1e400", "1e1000",
    "1e1001",
    "1e-1000", "1e999999999", "1e-999999999", "9" * 100, "9" * 2000, "9" * 4299, "9" * 4301, "9" * 100_000,
    "1/" + "9" * 1999,
    "1/0", "0/0", "2147483648", "-2147483649", "9223372036854775808", "18446744073709551616", "1000000", "1e6",
    "1.0", "1.5",
    "1_000", "0x", "0x10", "0b1", "0o7", "1e", "1e+", ".", "1.", ".5", "1..2", "nan", "NaN", "inf", "-Infinity",
    ".nan", ".inf",
    "٣", "１", "²", "1١", "-", "+1", "--1", "1j", "1L", "true", "null", "1:30", "2001-01-01", "0" * 3000 + "1",
)  # fmt: skip
TEXTS = (
    "", " ", "\t", "\0", "\x07", "\x1b[31m", "\x1b]0;t\x07", "\r\n", "\u2028", "\u202e", "\ufeff", "\x85", "\x7f",
    "\x9b", "é",
    "ρ", "rhо", "L２", "−1", "\U0001f600", "%s%n{0}", "../../etc/passwd", "/dev/zero", "a/b", "a\\b", "CON", ".", "..",
    "-", "--", "~", "None", "null", "true", "no", "<<", "*a", "&a", "!!python/object:os.system", "!!binary aGk=",
    "__import__('os').system('true')", "rho.__class__", "rho[0]", "rho(1)", "lambda: 1", "exec", "os", "f'{rho}'",
    "rho**1000000000", "rho^rho", "rho^-1", "1/(rho-rho)", "1/(rho-1)", "((rho^4)^4)^4", "((rho**9)**9)**9",
    "(rho+L2)^64",
    "(rho+L2+1)^32", "2^2^2^2^2^2^2^2", "9^9^9^9", "1e999^9", "(1/3+rho)^40*(1/7+L2)^40", "rho/L2", "1/(rho*L2+1e-300)",
    "(rho-1/3)*(rho-2/3)", "sqrt(rho)", "rho;L2", "rho,L2", "rho L2", "2rho", "F", "L2", "rho", "F3", "k", "l0",
    "x" * 5000,
    "(" * 300, ")" * 300, "-" * 300 + "1", "[" * 300, "{" * 300, "((((rho))))", "rho" + "+rho" * 900,
    "*".join(["(rho+L2)"] * 40),
    "1000000", "x^1000000", "rho^1000000", "rho^999999999999999999999", "rho^64", "L2^30*rho^30", "1e-30", "exact",
    "partial",
)  # fmt: skip
_TOKEN = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?|\w+|\s+|.", re.DOTALL)


def nasty(rng: Random) -> str:
    """A text that something may stumble over."""
    return rng.choice(NUMBERS if rng.random() < 0.5 else TEXTS)


# ------------------------------------------------------------------------------------------------------- bytes


def damaged_bytes(data: bytes, rng: Random, other: bytes = b"") -> bytes:
    """The data after one to four bytewise accidents; `other` is spliced in now and then."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 4))):
        data = rng.choice(_ACCIDENTS)(data, rng, other)
    return data


def _flip(data: bytes, rng: Random, _other: bytes) -> bytes:
    if not data:
        return data
    at = rng.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]


def _cut(data: bytes, rng: Random, _other: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + data[at + rng.choice((1, 2, 10, 100, 10**9)) :]


def _insert(data: bytes, rng: Random, _other: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    piece = (
        rng.randbytes(rng.randrange(1, 9))
        if rng.random() < 0.3
        else nasty(rng).encode("utf-8", "surrogatepass")
    )
    return data[:at] + piece + data[at:]


def _repeat(data: bytes, rng: Random, _other: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    piece = data[at : at + rng.randrange(1, 60)]
    return data[:at] + piece * rng.choice((2, 3, 10, 300)) + data[at:]


def _splice(data: bytes, rng: Random, other: bytes) -> bytes:
    at, to = rng.randrange(len(data) + 1), rng.randrange(len(other) + 1)
    return data[:at] + other[to:]


def _recode(data: bytes, rng: Random, _other: bytes) -> bytes:
    text = data.decode("utf-8", "replace")
    return text.encode(
        rng.choice(("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "utf-7")), "replace"
    )


_Accident = Callable[[bytes, Random, bytes], bytes]
_ACCIDENTS: tuple[_Accident, ...] = (
    _flip,
    _flip,
    _cut,
    _cut,
    _insert,
    _insert,
    _repeat,
    _splice,
    _recode,
)


# ------------------------------------------------------------------------------------------------------- tokens


def damaged_tokens(text: str, rng: Random) -> str:
    """The text with one to four of its tokens replaced, removed, doubled or exchanged."""
    tokens = _TOKEN.findall(text)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 4))):
        if not tokens:
            return nasty(rng)
        at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
        kind = rng.randrange(7)
        if kind <= 1 and (numbers := [n for n, token in enumerate(tokens) if token[:1].isdigit()]):
            tokens[rng.choice(numbers)] = rng.choice(NUMBERS)
        elif kind <= 2:
            tokens[at] = nasty(rng)
        elif kind == 3:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        elif kind == 4:
            tokens[at] = tokens[other]
        elif kind == 5:
            tokens.insert(at, tokens[other])
        else:
            del tokens[at]
    return "".join(tokens)


# ------------------------------------------------------------------------------------------------------- JSON


class Raw(str):
    """A piece of text that is written into the JSON as it stands."""


def damaged_tree(tree: Any, rng: Random) -> str:
    """JSON text of the tree after one to three structural accidents; `tree` is changed."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        places = list(_places(tree))
        if not places:
            break
        # every depth and every list has its chance, however long some lists are
        depth = rng.choice(sorted({len(path) for path, _, _ in places}))
        _, container, key = rng.choice([place for place in places if len(place[0]) == depth])
        _accident(container, key, rng)
    raw: list[str] = []

    def plain(value: Any) -> Any:
        if isinstance(value, Raw):
            raw.append(str(value))
            return f"\x00{len(raw) - 1}\x00"
        if isinstance(value, dict):
            return {name: plain(entry) for name, entry in value.items()}
        return [plain(entry) for entry in value] if isinstance(value, list) else value

    text = json.dumps(plain(tree))
    return re.sub(r'"\\u0000([0-9]+)\\u0000"', lambda match: raw[int(match.group(1))], text)


def _places(tree: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any, Any]]:
    """(path, container, key) of every entry."""
    entries = (
        tree.items()
        if isinstance(tree, dict)
        else enumerate(tree)
        if isinstance(tree, list)
        else ()
    )
    for key, value in entries:
        yield (*path, key), tree, key
        if isinstance(value, dict | list):
            yield from _places(value, (*path, key))


def _accident(container: Any, key: Any, rng: Random) -> None:
    value = container[key]
    kind = rng.randrange(12)
    if kind <= 2:
        container[key] = _anything(rng)
    elif kind <= 4:
        container[key] = _near(value, rng)
    elif kind == 5:
        del container[key]
    elif kind == 6 and isinstance(container, list):
        container.insert(key, json.loads(json.dumps(value)))
    elif kind == 7:
        other = rng.choice(
            list(container) if isinstance(container, dict) else range(len(container))
        )
        container[key], container[other] = container[other], container[key]
    elif kind == 8 and isinstance(value, list) and value:
        container[key] = value * rng.choice((2, 3, 50))
    elif kind == 9 and isinstance(value, dict):
        value[rng.choice((nasty(rng), "unknown", "status"))] = _anything(rng)
    elif kind == 10:
        container[key] = [value] if rng.random() < 0.5 else {"a": value}
    else:
        container[key] = _near(value, rng)


def _anything(rng: Random) -> Any:
    kind = rng.randrange(12)
    if kind == 0:
        return None
    if kind == 1:
        return rng.choice((True, False))
    if kind == 2:
        return rng.choice(
            (0, 1, -1, 2, 5, 10**6, 10**9, -(10**9), 10**18, 2**63, 10**4000, -(10**30))
        )
    if kind == 3:
        return rng.choice((0.5, 1e308, -1e-308, 1.0, float("nan"), float("inf"), -0.0))
    if kind == 4:
        return rng.choice(([], {}, [[]], [None], {"": ""}, "", [0], [0, 0], [0, 0, 0], ["0", "1"]))
    if kind == 5:
        depth = rng.choice((5, 100, 900, 2000, 100_000))
        return Raw(
            rng.choice(
                ("[" * depth + "]" * depth, '{"a":' * depth + "1" + "}" * depth, "[" * depth)
            )
        )
    if kind == 6:
        return Raw(
            rng.choice(
                (
                    "NaN",
                    "Infinity",
                    "-Infinity",
                    "1e400",
                    "-0",
                    "1" * 4301,
                    "01",
                    "'a'",
                    "undefined",
                    "1" * 10**5,
                )
            )
        )
    if kind == 7:
        return rng.choice(
            (
                [0] * 10_000,
                ["1"] * 3000,
                [None] * 100_000,
                "1" * 10**5,
                "x" * 10**5,
                [[0, 0]] * 3000,
            )
        )
    return nasty(rng)


def _near(value: Any, rng: Random) -> Any:
    """Something of the same type, often near the value."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return rng.choice(
            (
                value + 1,
                value - 1,
                -value,
                2 * value,
                0,
                1,
                10**6,
                value + 10**9,
                10**40,
                float(value),
                str(value),
            )
        )
    if isinstance(value, float):
        return rng.choice((-value, value * 1e300, float("nan"), 0.0))
    if isinstance(value, str):
        return _near_text(value, rng)
    if isinstance(value, list):
        return rng.choice((value[1:], value[:-1], value[::-1], value + value[:1], []))
    if isinstance(value, dict):
        keys = sorted(value)
        rng.shuffle(keys)
        return {key: value[key] for key in keys[: len(keys) - rng.randrange(2)]}
    return rng.choice((0, 1, "0", -1, "1/3", []))


def _near_text(text: str, rng: Random) -> str:
    kind = rng.randrange(8)
    numbers = list(re.finditer(r"[0-9]+", text))
    if kind <= 3 and numbers:
        match = rng.choice(numbers)
        old = int(match.group()[:300])
        new = rng.choice(
            (
                str(old + 1),
                str(max(old - 1, 0)),
                str(10 * old),
                "0",
                "1",
                "7",
                "1000000",
                "100",
                "40",
                "9" * 60,
                "9" * 3000,
            )
        )
        return text[: match.start()] + new + text[match.end() :]
    if kind == 4:
        return text[1:] if text.startswith("-") else f"-{text}"
    if kind == 5:
        return f"{text} + {rng.choice(('1', '999999999999', 'rho^7', 'L2^1000000', 'rho^300*L2^300', '1/3'))}"
    if kind == 6:
        return text + rng.choice(("e5", "e-1000", "0" * 50, "/7", "9" * 1500, "^9", "*rho^50"))
    return damaged_tokens(text, rng)
