"""Problem records and options for the fuzzer, grown by a grammar: many are nearly right, some are
right.
"""

from __future__ import annotations

from random import Random

from fuzz.damage import nasty

PARAMETERS = ("L1", "L2", "rho", "k", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x", "l0", "l0_1")
_VALUES = ("0", "1", "2", "-10", "3/2", "0.1", "1e-30", "100", "1/3", "-1e3")


def expression(rng: Random, names: tuple[str, ...], depth: int = 3, odd: float = 0.05) -> str:
    """An arithmetic expression in the names, with a probability of `odd` for each leaf to be
    something else.
    """
    if rng.random() < odd:
        return nasty(rng)
    if depth == 0 or rng.random() < 0.4:
        return rng.choice(names) if names and rng.random() < 0.4 else rng.choice(_VALUES)
    left, right = (expression(rng, names, depth - 1, odd) for _ in range(2))
    kind = rng.randrange(8)
    if kind == 0:
        return f"({left})^{rng.choice(('2', '3', '-1', '0', '1/2', '-2', '17', '10^9'))}"
    if kind == 1:
        return f"-({left})"
    return rng.choice(("{} + {}", "{} - {}", "({})*({})", "({})/({})", "{}*{}", "{}**{}")).format(
        left, right
    )


def window(rng: Random, odd: float = 0.05) -> tuple[str, str]:
    """The ends of a range."""
    if rng.random() < odd:
        return nasty(rng), nasty(rng)
    low = rng.choice(("0", "0", "1", "1/2", "1e-3", "-1", "-10"))
    return low, rng.choice(
        ("2", "4", f"{low}+1e-30", f"{low}+1/1000", "3/2", "0", "1e3", f"{low}+1e-400")
    )


def tame_record(rng: Random) -> str:
    """A record that is mostly right, and cheap to classify: two axes, numbers, at most linear
    links.
    """
    first, second = rng.sample(("L1", "L2", "rho", "k1", "k3", "F3", "F4", "F3x"), 2)
    lines = [
        f"axes: {{{first}: [{_tame_range(rng, first)}], {second}: [{_tame_range(rng, second)}]}}"
    ]
    values = {}
    for name in rng.sample(
        ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x"), rng.randrange(5)
    ):
        if name not in (first, second):
            values[name] = rng.choice(
                ("1", "2", "1/2", "3/4", "10", first, f"{second}/2", f"{first} + {second}")
            )
    lines.append(
        f"parameters: {{{', '.join(f'{name}: {value}' for name, value in values.items())}}}"
    )
    lines.append(f"count: {rng.choice(('stable', 'total', 'index'))}")
    return "\n".join(lines) + "\n"


def _tame_range(rng: Random, name: str) -> str:
    low = rng.choice(("-1", "0", "1") if name.startswith("F") else ("1/10", "1/2", "1"))
    return f"{low}, {low}+{rng.choice(('1/2', '1', '1/100', '1/7'))}"


def record(rng: Random, odd: float = 0.05) -> str:
    """A record."""
    names = rng.sample(PARAMETERS, 2) if rng.random() < 0.8 else ["F", rng.choice(PARAMETERS)]
    if rng.random() < odd:
        names[rng.randrange(2)] = nasty(rng)
    entries = {
        "axes": "{" + ", ".join(f"{n}: [{', '.join(window(rng, odd))}]" for n in names) + "}"
    }
    values = {
        rng.choice(PARAMETERS): _quoted(expression(rng, (*names, "k", "F3"), 3, odd), rng)
        for _ in range(rng.randrange(5))
    }
    if rng.random() < 0.8:
        entries["parameters"] = (
            "{" + ", ".join(f"{name}: {value}" for name, value in values.items()) + "}"
        )
    if rng.random() < 0.5:
        entries["count"] = rng.choice(("stable", "total", "index", "index", nasty(rng)))
    for key in ("name", "title", "notes", "mechanism", "reference", nasty(rng)):
        if rng.random() < 0.15:
            entries[key] = rng.choice(("ptm", "{a: 1}", "[1, 2]", "text", _quoted(nasty(rng), rng)))
    keys = list(entries)
    rng.shuffle(keys)
    return "\n".join(f"{key}: {entries[key]}" for key in keys) + "\n"


def _quoted(text: str, rng: Random) -> str:
    kind = rng.randrange(4)
    if kind == 0:
        return "'" + text.replace("'", "''") + "'"
    if kind == 1:
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return text


def options(rng: Random) -> dict[str, object]:
    """Arguments of `slice_from_options`; ``config`` is the number of a shipped record."""
    found: dict[str, object] = {}
    odd = rng.choice((0.02, 0.1, 0.3))
    names = rng.sample(PARAMETERS, 2)
    if rng.random() < 0.4:
        found["config"] = rng.randrange(17)
    if rng.random() < 0.8:
        found["slice"] = nasty(rng) if rng.random() < odd else ",".join(names)
    found["sets"] = [
        f"{rng.choice(PARAMETERS)}={expression(rng, tuple(names), 3, odd)}"
        if rng.random() > odd
        else nasty(rng)
        for _ in range(rng.randrange(4))
    ]
    found["ranges"] = [
        f"{rng.choice(names)}={':'.join(window(rng, odd))}" if rng.random() > odd else nasty(rng)
        for _ in range(rng.randrange(3))
    ]
    if rng.random() < 0.3:
        found["count"] = rng.choice(("stable", "total", "index", nasty(rng)))
    return found
