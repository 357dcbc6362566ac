"""What a record asks and what that will cost, before anything is computed.

Guarantee: the number of complex solutions is exact at the point that is named, and so at all points but those of some
curves; the cost is a rough class, from that number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.ask.engines import is_certified
from ptmcad.mechanism import Mechanism, ptm
from ptmcad.question.slice import Slice, merged

MAX_UNKNOWNS = 4
"""Beyond, even one point takes too long for a question that should be answered at once."""
MAX_CERTIFIED = 3
"""Unknowns that the certified engine takes."""
_CLASSES = (
    (6, "a second or less"),
    (10, "seconds"),
    (16, "from seconds to minutes"),
    (20, "minutes to hours: try --timeout, and counts along lines by ptmcad range"),
)
_BEYOND = "hours or more: ask for counts at points or along lines instead"


@dataclass(frozen=True, slots=True)
class Check:
    """What a record asks.

    Attributes
    ----------
    complex_solutions : at ``sample``; None where they were not counted, or where there are infinitely many there.
    engine : the one that ``--engine auto`` takes.
    cost : in words.
    """

    slice: Slice
    sample: tuple[Fraction, Fraction]
    complex_solutions: int | None
    engine: str
    cost: str


def check(slice: Slice) -> Check:
    """What a slice asks and what that will cost."""
    # thirds and sevenths of the window: rarely on a curve that a person has in mind
    sample = tuple(a.low + (a.high - a.low) * share for a, share in zip(slice.axes, (_ACROSS, _UP), strict=True))
    at = (sample[0], sample[1])
    if is_certified(slice, "auto"):
        if len(slice.model.unknowns) > MAX_CERTIFIED:
            cost = f"no engine makes this map yet: with free lengths there may be {MAX_CERTIFIED} unknowns"
        elif slice.model == ptm() or len(slice.model.unknowns) == 1:
            cost = "seconds for half a percent, and longer for less"
        else:
            cost = "seconds to minutes for a percent, more where springs get short"
        return Check(slice, at, None, "certified", cost)
    if len(slice.model.unknowns) > MAX_UNKNOWNS:
        return Check(slice, at, None, "exact", _BEYOND)
    found = _complex_solutions(slice, at)
    if found is None:
        return Check(slice, at, None, "exact", "none: there are infinitely many solutions, or none, at the sample")
    return Check(slice, at, found, "exact", next((cost for most, cost in _CLASSES if found <= most), _BEYOND))


_ACROSS, _UP = Fraction(10, 21), Fraction(19, 35)


def _complex_solutions(slice: Slice, at: tuple[Fraction, Fraction]) -> int | None:
    from ptmcad.algebra.polynomials import from_fraction
    from ptmcad.exact.counting import solutions_at
    from ptmcad.exact.stages import point_values, problem_of

    problem = problem_of(slice)
    return solutions_at(problem.system, point_values(problem.parameters, (from_fraction(at[0]), from_fraction(at[1]))))[
        0
    ]


def check_text(found: Check) -> Iterator[str]:
    """The answer as lines of text."""
    slice, model = found.slice, found.slice.model
    what = "mechanism" if isinstance(model, Mechanism) else "system"
    yield f"{what:<12}{model.name}"
    yield f"{'unknowns':<12}{', '.join(f'{name} ({kind.value})' for name, kind in model.unknowns.items())}"
    if isinstance(model, Mechanism):
        parts = {
            "bars": len(model.bars), "bodies": len(model.bodies), "springs": len(model.springs),
            "torsion springs": len(model.torsion), "loads": len(model.loads), "moments": len(model.moments),
        }  # fmt: skip
        yield f"{'parts':<12}{', '.join(f'{number} {name}' for name, number in parts.items() if number)}"
    values = {name: e.to_text(slice.axis_names) for name, e in slice.parameters.items() if name not in slice.axis_names}
    fixed = [f"{name} = {value}" for name, value in merged(values, model).items()]
    yield f"{'parameters':<12}{', '.join(fixed) or 'none but the axes'}"
    yield f"{'axes':<12}{', '.join(f'{a.name} from {a.low} to {a.high}' for a in slice.axes)}"
    yield f"{'count':<12}{slice.count.value}"
    at = ", ".join(f"{a.name} = {value}" for a, value in zip(slice.axes, found.sample, strict=True))
    number = "not counted" if found.complex_solutions is None else str(found.complex_solutions)
    yield f"{'solutions':<12}{number}{'' if found.complex_solutions is None else f' complex ones at {at}'}"
    yield f"{'engine':<12}{found.engine}"
    yield f"{'cost':<12}{found.cost}"
