"""The moments about the joints as Python's source, from the description, for rivals that run in processes of their own.

Guarantee: the source computes the first and second derivatives of the potential, without free lengths, up to rounding,
for floats and for arrays alike; it is as short as what one would write by hand, and needs nothing of this package.

With equations e1 = (dU/dth1)/f1 = 0 and e2 = (dU/dth2)/f2 = 0, from which the common factors f1 and f2 of their terms
are taken, and cosines and sines c1, s1, c2, s2, the source defines

- `coefficients`, from parameters by name: what depends on nothing else, first arguments of all other functions;
- `factors`, likewise: f1 and f2;
- `first`: C and S of e1 = C c1 + S s1, from c2 and s2;
- `second`: the part of e2 that is free of c1 and s1, and the other one, at both angles;
- `slopes`: derivatives of e1, then of e2, by th1 and th2; `equations`: e1, e2 and then the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.mechanism import ptm
from ptmcad.studies.equilibria import derivatives
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.terms import signed_terms

CIRCLES = ("c1", "s1", "c2", "s2")
_FIRST = 2
"""Of these belong to the first angle."""

Powers = tuple[int, ...]


@lru_cache(maxsize=1)
def source() -> str:
    """All functions, as the text of a module."""
    names = [name for name in ptm().parameters if name not in ptm().free_lengths]
    ring = fmpq_mpoly_ctx.get([*names, *CIRCLES], Ordering.lex)
    values = dict(zip((*names, *CIRCLES), ring.gens(), strict=True))
    c1, s1, c2, s2 = (values[name] for name in CIRCLES)
    found = derivatives({name: values[name] for name in names}, ((c1, s1), (c2, s2)), _refused)
    (g1, g2), (h11, h12, h22) = found.gradient, found.hessian
    f1, f2 = (g.term_content() for g in (g1, g2))
    slopes = h11 / f1, h12 / f1, h12 / f2, h22 / f2
    writer = _Writer(names)
    functions = [
        writer.function("first", CIRCLES[_FIRST:], [(g1 / f1).derivative(name) for name in CIRCLES[:_FIRST]]),
        writer.function("second", CIRCLES, _by_first_angle(g2 / f2, len(names))),
        writer.function("slopes", CIRCLES, slopes),
        writer.function("equations", CIRCLES, (g1 / f1, g2 / f2, *slopes)),
        *(writer.of_parameters(name, told) for name, told in (("coefficients", writer.taken), ("factors", [f1, f2]))),
    ]
    return "\n\n".join(functions)


def _refused(square: object) -> object:
    raise NotImplementedError("springs with a free length")


def _product(number: int, circle: str) -> str:
    return f"a[{number}]" if circle == "1" else f"a[{number}]*{circle}"


def _by_first_angle(p: fmpq_mpoly, skipped: int) -> list[fmpq_mpoly]:
    """The terms without the first angle, and the others."""
    parts: tuple[dict[Powers, fmpq], dict[Powers, fmpq]] = ({}, {})
    for powers, c in p.to_dict().items():
        parts[any(powers[skipped : skipped + _FIRST])][powers] = c
    return [p.context().from_dict(part) for part in parts]


class _Writer:
    """What depends on parameters only is taken out of all functions, and written once."""

    def __init__(self, names: Sequence[str]):
        self.names = names
        self.taken: list[fmpq_mpoly] = []

    def function(self, name: str, arguments: Sequence[str], polynomials: Sequence[fmpq_mpoly]) -> str:
        """A function of the coefficients and of cosines and sines; what occurs in it twice is computed once."""
        written = [list(self._products(p)) for p in polynomials]
        sums = list(dict.fromkeys(circle for products in written for _, _, circle in products if " " in circle))
        short = {circle: f"t{k}" for k, circle in enumerate(sums)}
        told = [" ".join(f"{sign} {_product(k, short.get(circle, circle))}" for sign, k, circle in p) for p in written]
        body = [f"{name} = {circle}" for circle, name in short.items()]
        body.append(f"return {', '.join(text.removeprefix('+ ') for text in told)}")
        return f"def {name}(a, {', '.join(arguments)}):\n" + "".join(f"    {line}\n" for line in body)

    def of_parameters(self, name: str, polynomials: Sequence[fmpq_mpoly]) -> str:
        """A function of the parameters alone."""
        return f"def {name}(p):\n    return {', '.join(self._parameters_text(p) for p in polynomials)}\n"

    def _products(self, p: fmpq_mpoly) -> Iterator[tuple[str, int, str]]:
        """Sign, number of the coefficient, and the sum in cosines and sines: all with one coefficient in one sum."""
        by_circle: dict[Powers, dict[Powers, fmpq]] = {}
        for powers, c in p.to_dict().items():
            at, circle = powers[: len(self.names)] + (0,) * len(CIRCLES), powers[len(self.names) :]
            by_circle.setdefault(circle, {})[at] = c
        sums: dict[int, list[tuple[Powers, int]]] = {}
        for circle, terms in by_circle.items():
            number, sign = self._number(p.context().from_dict(terms))
            sums.setdefault(number, []).append((circle, sign))
        for number, told in sums.items():
            sign = told[0][1]
            texts = signed_terms(((circle, sign * own) for circle, own in told), CIRCLES, "{}**{}")
            yield "+" if sign > 0 else "-", number, " ".join(texts)

    def _number(self, coefficient: fmpq_mpoly) -> tuple[int, int]:
        """Of a coefficient among those that were taken out, and its sign."""
        for k, known in enumerate(self.taken):
            if coefficient in (known, -known):
                return k, 1 if coefficient == known else -1
        self.taken.append(coefficient)
        return len(self.taken) - 1, 1

    def _parameters_text(self, p: fmpq_mpoly) -> str:
        spelled = [f"p[{name!r}]" for name in self.names]
        terms = ((powers[: len(spelled)], to_fraction(c)) for powers, c in p.to_dict().items())
        return " ".join(signed_terms(terms, spelled, "{}**{}", number=str))
