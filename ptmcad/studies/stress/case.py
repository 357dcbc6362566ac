"""A stress case: a question with extreme numbers, and the answer with where it comes from.

Guarantee: all numbers are exact. An expected answer says what is known beforehand; what it leaves
open is empty. Names are unique. The named cases are data, ``cases.yaml``, whose head says how they
are written. Their counts follow from a theorem or a construction named in ``source``, and do not
come from the program. The theorems are those of the manual: without load two equilibria are stable,
of six, exactly if |L2 - L1| < 2 rho < L1 + L2, else one of four; loads that are small (large)
enough against k rho and k L change nothing else (leave four, one of them stable); equations stay
the same when stiffnesses and forces, or lengths and force/stiffness, are scaled together. Areas are
in the product of the axes' units.

A degenerate equilibrium is constructed exactly: at the parameters a rational pose is an equilibrium
with a singular Hessian, and the signs that distinguish the sides, of which one has more equilibria,
are computed in rational numbers.

Derivation. The potential is phi_1(th1) + phi_2(th2) + G cos(th1 + th2), with G = k3 L1 L2 and phi_i
a sine wave. So at an equilibrium, writing h_ij for the Hessian, c12 and s12 for cosine and sine of
th1 + th2,

    h12 = -G c12,    U_111 = U_222 = 0,    U_112 = U_122 = G s12,
    U_1111 = -h11,   U_2222 = -h22,        every mixed fourth derivative is -h12.

*Fold.* With h11 h22 = h12^2, kernel v = (h12, -h11) and b = 3 G s12 v1 v2 (v1 + v2) not zero, a
load that changes the gradient along v by a has two more equilibria near by on the side where a
b < 0 (saddle-node). They are a minimum and a saddle if the other eigenvalue, whose sign is that of
h11, is positive, and else a saddle and a maximum.

*Cusp.* With h11 = h12 = h22 = h the kernel is v = (1, -1) and b = 0. The fourth derivative along
the centre manifold is q = U(v, v, v, v) - 3 w.w / (2 h) with U(v, v, v, v) = 0 and w = -G s12 (1,
1), so q = -3 (G s12)^2 / h. Changing h22 by d while the pose stays an equilibrium gives
d s^2 / 2 + q s^4 / 24 along v: three equilibria where d q < 0, else one.

On the torus there are 4 or 6 equilibria in all (minima - saddles + maxima = 0), so the counts on
both sides follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from typing import Any

from ptmcad.errors import ConfigError, shown
from ptmcad.model import ptm
from ptmcad.studies.byhand import on_circle
from ptmcad.studies.texts import texts_beside
from ptmcad.text.expressions import constant
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import did_you_mean

ALL = "all"
"""The name that stands for every named case."""
TEXTS = texts_beside(__file__, "cases.yaml")

Span = tuple[Fraction, Fraction]
Parameters = Mapping[str, Fraction]
Pose = tuple[Fraction, Fraction, Fraction, Fraction]
"""cos th1, sin th1, cos th2, sin th2."""
FEW = (4, 1)
"""Equilibria and stable ones on the side that has fewer."""


@dataclass(frozen=True, slots=True)
class Question:
    """What ptmcad is asked: without axes `ptmcad.solve`, with axes `ptmcad.classify` or, along one,
    `ptmcad.intervals`.

    Attributes
    ----------
    parameters : of the paper's mechanism; of a point all of them but free lengths that are zero.
    tolerance : the share of the window that the certified engine may leave undetermined; None for
        the exact engine.
    along, fixed : the axis that varies along a line, and the value of the other one.
    """

    parameters: Parameters
    axes: Mapping[str, Span] = field(default_factory=dict)
    tolerance: Fraction | None = None
    along: str = ""
    fixed: Parameters = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """What is asked, in a word."""
        if not self.axes:
            return "point"
        return "line" if self.along else "map" if self.tolerance is None else "certified map"


@dataclass(frozen=True, slots=True)
class Case:
    """One stress case.

    Attributes
    ----------
    stiffness : what is extreme, as one positive number: a ratio of stiffnesses, lengths or forces,
        or the distance from a fold; the plot's horizontal axis.
    source : where the expected answer comes from.
    expected : as it is shown: 6/2 of a point (all and stable equilibria), 1 2 1 of maps and lines
        (stable counts, of regions in increasing order, of intervals in theirs); empty where a
        second method alone knows it.
    bounds : of a map, for the area where two equilibria are stable; of a line, for the ends between
        intervals of different counts.
    slow : whether it takes more than about a second.
    """

    name: str
    family: str
    stiffness: Fraction
    question: Question
    source: str
    expected: str = ""
    bounds: tuple[Span, ...] = ()
    slow: bool = False


def free_lengths(parameters: Parameters) -> bool:
    """Whether a spring has one."""
    return any(name.startswith("l0") and value for name, value in parameters.items())


def point(**given: Fraction | int | str) -> Question:
    """A point of the paper's mechanism: L1 = 1, L2 = 3/2, rho = 7/10, k = 100 and no load unless
    given.
    """
    p = {name: Fraction(value) for name, value in {**TEXTS["point"], **given}.items()}
    springs, free = dict.fromkeys(ptm().stiffnesses, p.pop("k")), p.pop("l0")
    lengths = dict.fromkeys(ptm().free_lengths, free) if free else {}
    return Question(springs | lengths | p)


# ------------------------------------------------------------------------------------------------ degenerate equilibria


@dataclass(frozen=True, slots=True)
class Degenerate:
    """Parameters of a degenerate equilibrium.

    Attributes
    ----------
    many : (total, stable) on the side that has more.
    side : sign of the change in `beside` that leads to ``many``.
    """

    parameters: Parameters
    pose: Pose
    cusp: bool
    many: tuple[int, int]
    side: int

    def beside(self, distance: Fraction) -> Parameters:
        """The parameters at a distance; positive is towards more equilibria.

        Of a fold F3 is changed by so many times the force k2 rho; of a cusp h22 by so many times k3
        L2^2, while the pose is kept an equilibrium.
        """
        p, (_, _, c2, s2) = self.parameters, self.pose
        change = self.side * distance
        if not self.cusp:
            return {**p, "F3": p["F3"] + change * p["k2"] * p["rho"]}
        # h22 / L2 = (a2 - k3 L1 c1) / c2 and F4 = (a2 s2 - k3 L1 s12) / c2
        shift = change * p["k3"] * p["L2"] * c2
        return {**p, "F4x": p["F4x"] - shift, "F4": p["F4"] + shift * s2 / c2}


def degenerate(
    tangents: Sequence[Fraction],
    *,
    cusp: bool,
    lengths: Sequence[Fraction] = (Fraction(1), Fraction(3, 2)),
    rho: Fraction = Fraction(7, 10),
    springs: Sequence[Fraction] = (Fraction(100),) * 3,
) -> Degenerate:
    """Loads under which a pose, by its half angles' tangents, lies on a fold, with F3x zero, or at
    a cusp of the folds.

    Raises
    ------
    ValueError
        When there are none: a cosine, h11, h12 or the derivative that distinguishes the sides is zero.
    """
    (first, second), (k1, k2, k3) = lengths, springs
    (c1, s1), (c2, s2) = map(on_circle, tangents)
    c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    if c1 == 0 or c2 == 0:
        raise ValueError("no vertical load balances a vertical bar")
    h12 = -k3 * first * second * c12
    h11 = h12 if cusp else first * ((k2 + k3) * rho - k3 * second * c2) / c1
    if h11 == 0:
        raise ValueError("h11 is zero")
    third = -3 * k3 * first * second * s12 * h12 * h11 * (h12 - h11)
    if s12 == 0 or (third == 0 and not cusp):
        raise ValueError("the derivative along the kernel is zero")
    # a larger F3 adds -L1 c1 to the first component of the gradient
    towards = h11 if cusp else first * c1 * h12 * third
    # (k2 + k3) rho + F3x = a1 and (k1 + k3) rho - F4x = a2
    a1, a2 = k3 * second * c2 + h11 * c1 / first, k3 * first * c1 + h12 * h12 / h11 * c2 / second
    parameters = {
        "L1": first,
        "L2": second,
        "rho": rho,
        "k1": k1,
        "k2": k2,
        "k3": k3,
        "F3": s1 * (a1 - k3 * second * c2) / c1 - k3 * second * s2,
        "F4": (a2 * s2 - k3 * first * s12) / c2,
        "F3x": a1 - (k2 + k3) * rho,
        "F4x": (k1 + k3) * rho - a2,
    }
    return Degenerate(
        parameters, (c1, s1, c2, s2), cusp, (6, 2) if h11 > 0 else (6, 1), 1 if towards > 0 else -1
    )


NAMED = {
    name: degenerate([Fraction(t) for t in tangents], cusp="cusp" in name)
    for name, tangents in TEXTS["degenerate"].items()
}
"""Those that the named cases lie beside."""


# --------------------------------------------------------------------------------------------------------- named cases


@cache
def named_cases() -> tuple[Case, ...]:
    """Every named case."""
    return tuple(_case(entry, e) for entry in TEXTS["cases"] for e in entry["e"])


def _case(entry: Mapping[str, Any], e: int) -> Case:
    known = {"s": Fraction(10) ** e, **_numbers(TEXTS["numbers"], {})}
    return Case(
        name=entry["name"].format(e=e),
        stiffness=known["s"],
        question=_question(entry["question"], known),
        bounds=_numbers(entry.get("bounds", []), known),
        slow=e in entry.get("slow", ()),
        **{key: entry[key] for key in ("family", "source", "expected") if key in entry},
    )


def _question(entry: Mapping[str, Any], known: Parameters) -> Question:
    base: Parameters = {}
    if "at" in entry:
        base = NAMED[entry["at"]].beside(_numbers(entry.get("beside", 0), known))
    names = ("parameters", "axes", "tolerance", "fixed")
    given = {name: _numbers(entry[name], {**known, **base}) for name in names if name in entry}
    values = {**base, **given.pop("parameters", {})}
    if "axes" not in given:
        return point(**values)
    values = {name: value for name, value in values.items() if name not in given["axes"]}
    return Question(values, along=entry.get("along", ""), **given)


def _numbers(node: Any, known: Parameters) -> Any:
    """What has expressions for numbers, with their values."""
    if isinstance(node, dict):
        return {key: _numbers(value, known) for key, value in node.items()}
    if isinstance(node, list):
        return tuple(_numbers(value, known) for value in node)
    return parse(str(node), {name: constant(value) for name, value in known.items()}).constant()


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The cases of these names and families; all of them for ``all`` and when none is given.

    Raises
    ------
    ConfigError
        For a name that is neither.
    """
    cases = named_cases()
    known = {ALL, *(name for case in cases for name in (case.name, case.family))}
    for name in names:
        if name not in known:
            raise ConfigError(
                f"{shown(repr(name), 60)} is no stress case and no family: ptmcad stress --list shows them"
                f"{did_you_mean(name, tuple(sorted(known)))}",
                key="NAMES",
            )
    return tuple(c for c in cases if not names or {ALL, c.name, c.family} & set(names))
