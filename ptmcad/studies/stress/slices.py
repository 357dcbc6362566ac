"""The named stress cases that ask for a region map or for the intervals along a line.

Guarantee: as for `ptmcad.studies.stress.points`. Areas are in the product of the axes' units.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ptmcad.studies.stress.case import Case, LineAnswer, MapAnswer, SliceQuestion
from ptmcad.studies.stress.constructions import beside_cusp, beside_fold
from ptmcad.studies.stress.points import CONSTRUCTED, CUSP, FOLD, NO_LOAD, SCALING, THEOREM, ten

ZERO, TWO = Fraction(0), Fraction(2)
LOADED = {"F3": -10, "F4": -10}
SQUARE = {"rho": (ZERO, TWO), "L2": (ZERO, TWO)}
FIG4 = SliceQuestion(LOADED, SQUARE)
FIG2 = SliceQuestion({}, {"L2": (ZERO, Fraction(4)), "rho": (ZERO, Fraction(4))})
FIG4_AREA = (Fraction("0.74638067"), Fraction("0.74638068"))
"""Of two stable equilibria in the window of the paper's fig. 4; see the manual."""
ASTROID = "limit of a long bar 2: and two are stable where |2 rho - L2|^(2/3) + |f3 + f4|^(2/3) < L1^(2/3)"
PAPER = "the paper's fig. 4, whose area is known by two other programs"


def slice_cases() -> Iterator[Case]:
    """Maps, then lines."""
    yield from _scaled_maps()
    yield from _limits()
    yield from _tiny_windows()
    yield from _certified_maps()
    yield from _lines()


def _scaled_maps() -> Iterator[Case]:
    for e in (-12, 12):
        s = ten(e)
        question = SliceQuestion({"k": 100 * s, "F3": -10 * s, "F4": -10 * s}, SQUARE)
        yield Case(
            f"map-units-force-1e{e}", "maps", s, question, FIG4, MapAnswer((1, 2), FIG4_AREA), f"{SCALING}: {PAPER}"
        )
    for e in (-9, 9):
        s = ten(e)
        question = SliceQuestion({"L1": s, "F3": -10 * s, "F4": -10 * s}, dict(rho=(ZERO, 2 * s), L2=(ZERO, 2 * s)))
        area = (FIG4_AREA[0] * s * s, FIG4_AREA[1] * s * s)
        yield Case(f"map-units-length-1e{e}", "maps", s, question, FIG4, MapAnswer((1, 2), area), f"{SCALING}: {PAPER}")
        unloaded = SliceQuestion({"L1": s}, dict(L2=(ZERO, 4 * s), rho=(ZERO, 4 * s)))
        area = (Fraction(7, 2) * s * s,) * 2
        yield Case(f"map-unloaded-length-1e{e}", "maps", s, unloaded, FIG2, MapAnswer((1, 1, 1, 2), area), THEOREM)


def _limits() -> Iterator[Case]:
    # without load the strip |L2 - 1| < 2 rho < L2 + 1 has the area 3/2 in the window of fig. 4
    near = (Fraction(3, 2) - ten(-3), Fraction(3, 2) + ten(-3))
    for e in (-30, -12, -6):
        question = SliceQuestion({"F3": -ten(e), "F4": -ten(e)}, SQUARE)
        yield Case(f"map-forces-1e{e}", "maps", ten(e), question, FIG4, MapAnswer((1, 2), near), NO_LOAD, slow=e < -6)
    question = SliceQuestion({"F3": -ten(30), "F4": -ten(30)}, SQUARE)
    yield Case(
        "map-forces-1e30", "maps", ten(30), question, FIG4, MapAnswer((1,), (ZERO, ZERO)), "limit of large loads"
    )
    for e in (9, 30):
        s = ten(e)
        question = SliceQuestion(LOADED, dict(rho=(ZERO, s), L2=(ZERO, s)))
        # with f = (F3 + F4)/k = -1/5 the strip has the width (1 - (1/5)^(2/3))^(3/2) = 0.53375 but at its beginning
        strip = (s * Fraction("0.533"), s * Fraction("0.5345"))
        yield Case(f"map-window-1e{e}", "maps", s, question, FIG4, MapAnswer((1, 2), strip), ASTROID, slow=e > 9)


def _tiny_windows() -> Iterator[Case]:
    w = ten(-20)
    inside = SliceQuestion({}, _around(w, L2=Fraction(3, 2), rho=Fraction(7, 10)))
    yield Case("window-inside-1e-20", "windows", w, inside, FIG2, MapAnswer((2,), (w * w * 4, w * w * 4)), THEOREM)
    # the line 2 rho = L2 + 1 through the middle cuts the window in two parts of equal area
    across = SliceQuestion({}, _around(w, L2=Fraction(3, 2), rho=Fraction(5, 4)))
    yield Case("window-line-1e-20", "windows", w, across, FIG2, MapAnswer((1, 2), (w * w * 2, w * w * 2)), THEOREM)
    for name, at, beside, axes in (
        ("fold", FOLD, beside_fold, ("F3", "rho")), ("cusp", CUSP, beside_cusp, ("F4", "F4x")),
    ):  # fmt: skip
        p = dict(at.parameters)
        wide = dict(F3=(p["F3"] - 10, p["F3"] + 10), rho=(ZERO, TWO))
        if name == "cusp":
            wide = _around(Fraction(10), F4=p["F4"], F4x=p["F4x"])
        tame = SliceQuestion(_without(p, axes), wide)
        question = SliceQuestion(_without(p, axes), _around(w, **{n: p[n] for n in axes}))
        yield Case(f"window-{name}-1e-20", "windows", w, question, tame, MapAnswer((1, 2)), CONSTRUCTED, slow=True)
        moved = dict(beside(at, Fraction(1, 1000)))
        away = SliceQuestion(_without(moved, axes), _around(w, **{n: moved[n] for n in axes}))
        yield Case(f"window-beside-{name}-1e-20", "windows", w, away, tame, MapAnswer((2,)), CONSTRUCTED)
    digits = Fraction(1234567891234567891234567891234567891234, 10**40)
    long = SliceQuestion({"F3": -10 + ten(-40), "F4": -10 - digits * ten(-30)}, SQUARE)
    area = (Fraction("0.74638"), Fraction("0.746381"))
    source = f"the sibling's answer changes by less than 1e-9: {PAPER}"
    yield Case("map-digits-40", "maps", ten(40), long, FIG4, MapAnswer((1, 2), area), source, slow=True)


def _certified_maps() -> Iterator[Case]:
    share = Fraction(1, 10)
    window = dict(rho=(Fraction(1, 2), TWO), L2=(Fraction(1, 2), TWO))
    sibling = SliceQuestion({**LOADED, "l0": Fraction(1, 5)}, window, share)
    for e in (-12, 12):
        s = ten(e)
        question = SliceQuestion({"k": 100 * s, "F3": -10 * s, "F4": -10 * s, "l0": Fraction(1, 5)}, window, share)
        yield Case(
            f"certified-units-1e{e}", "certified maps", s, question, sibling, MapAnswer((1, 2)), SCALING, slow=True
        )
    question = SliceQuestion({**LOADED, "l0": ten(-12)}, window, share)
    yield Case("certified-free-length-1e-12", "certified maps", ten(-12), question, sibling, MapAnswer((1, 2)),
               f"limit of free lengths zero: {PAPER}", slow=True)  # fmt: skip


def _lines() -> Iterator[Case]:
    at = {"L2": Fraction(3, 2)}
    tame = SliceQuestion(LOADED, SQUARE, along="rho", at=at)
    ends = ((Fraction("0.498130"), Fraction("0.498132")), (Fraction("1.041432"), Fraction("1.041434")))
    paper = "scaling: the paper's range at L2 = 3/2, known by two other programs"
    for e in (-12, 12):
        s = ten(e)
        question = SliceQuestion(
            {"k": 100 * s, "F3": -10 * s, "F4": -10 * s}, SQUARE, along="rho", at={"L2": Fraction(3, 2)}
        )
        yield Case(f"line-units-force-1e{e}", "lines", s, question, tame, LineAnswer((1, 2, 1), ends), paper)
    for e in (-9, 9):
        s = ten(e)
        question = SliceQuestion({"L1": s, "F3": -10 * s, "F4": -10 * s}, dict(rho=(ZERO, 2 * s), L2=(ZERO, 2 * s)),
                                 along="rho", at={"L2": 3 * s / 2})  # fmt: skip
        scaled = tuple((low * s, high * s) for low, high in ends)
        yield Case(f"line-units-length-1e{e}", "lines", s, question, tame, LineAnswer((1, 2, 1), scaled), paper)
    straight = SliceQuestion({}, SQUARE, along="rho", at=at)
    for e in (-20, -30):
        second = 1 + ten(e)
        question = SliceQuestion({}, SQUARE, along="rho", at={"L2": second})
        exact = ((ten(e) / 2,) * 2, ((second + 1) / 2,) * 2)
        answer = LineAnswer((1, 2, 1), exact)
        yield Case(f"line-symmetry-1e{e}", "lines", ten(e), question, straight, answer, THEOREM)
    digits = Fraction(1234567891234567891234567891234567891234, 10**40)
    question = SliceQuestion({}, SQUARE, along="rho", at={"L2": 1 + digits})
    exact = ((digits / 2,) * 2, ((2 + digits) / 2,) * 2)
    yield Case("line-digits-40", "lines", ten(40), question, straight, LineAnswer((1, 2, 1), exact), THEOREM)


def _around(half: Fraction, **middle: Fraction) -> dict[str, tuple[Fraction, Fraction]]:
    return {name: (value - half, value + half) for name, value in middle.items()}


def _without(parameters: dict[str, Fraction], axes: tuple[str, str]) -> dict[str, Fraction]:
    return {name: value for name, value in parameters.items() if name not in axes}
