"""The best design within bounds, with its exact value and a proof of what no design exceeds.

Guarantee: that of `ptmcad.answer.design`. The search decides where the proof begins, and nothing
else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from time import perf_counter
from typing import Any

from ptmcad.answer.design import BestDesign, Evaluation
from ptmcad.ask.members import in_common
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.extras import require
from ptmcad.options import Options, Progress
from ptmcad.question.config.designed import Aim, Design
from ptmcad.question.config.designkey import design_from
from ptmcad.question.shipped import RecordSource
from ptmcad.text.flint_numbers import simplest_fraction
from ptmcad.text.parsing import share_for
from ptmcad.workbench.designs.designbounds import (
    Lengths,
    Proof,
    bounded,
    bounder_of,
    exact_maximum,
    most_on_lines,
    place_of,
)
from ptmcad.workbench.designs.evaluation import Evaluate, Value, evaluator
from ptmcad.workbench.designs.optimiser import Point, best_of, within

TOLERANCE = Fraction(1, 100)
BOXES = 100_000
SEED = 1
EVALUATIONS = 100
"""For one parameter; `PER_PARAMETER` more for each further one."""
PER_PARAMETER = 100
SIMPLER = (Fraction(1, 2**6), Fraction(1, 2**9), Fraction(1, 2**12), Fraction(1, 2**15))
"""How far from the best design simpler ones are looked for, as shares of the bounds."""
UNPROVED = 3
"""Times as many where no proof follows."""


def design(
    question: RecordSource | Design,
    maximise: str | None = None,
    over: Mapping[str, Sequence[Any]] | None = None,
    *,
    along: str | None = None,
    where: Mapping[str, Any] | None = None,
    pose: str | None = None,
    tolerance: Fraction | float | str = TOLERANCE,
    seed: int = SEED,
    evaluations: int | None = None,
    boxes: int = BOXES,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> BestDesign:
    """The design within bounds that makes a range, an area, a barrier or an expression as large as
    possible.

    Parameters
    ----------
    question : the file of a record, or a mapping like one; its key ``design`` says what the next
        ones do not.
    maximise : ``range`` (the length of the widest interval of ``along`` with the wanted number of
        stable poses), ``area`` (of the regions with that number), ``barrier`` (the energy that it
        takes to leave ``pose`` for another stable one), or a quantity or an expression as of
        ``ptmcad map --value``.
    over : the design parameters with their bounds.
    along : of a range the axis along which it lies, the first one if not given.
    where : conditions: ``stable`` (how many, 2 if not given), ``tension`` (true), ``conditions``
        (inequalities between the design parameters).
    pose : such as ``stable:1``, for a barrier or an expression.
    tolerance : how far the proved bound may lie above the value, as a share of it.
    seed : of the global search.
    evaluations : at most so many designs are evaluated before the proof begins.
    boxes : at most so many boxes of designs are looked at for the proof.
    timeout : seconds after which the search or the proof stops; the answer then has the bound that
        is proved so far.
    progress : called as progress(stage, done, total).

    Raises
    ------
    ConfigError
        For anything wrong with the question or the options.
    HypothesisError
        When every design is degenerate or has infinitely many equilibria.

    >>> import ptmcad
    >>> record = {"system": {"unknowns": {"u": "real"}, "equations": ["u^2 - 1 + (x - a)^2 + (a - 1)^2"]},
    ...           "axes": {"x": [-2, 4], "a": [0, 2]}}
    >>> found = ptmcad.design(record, "range", where={"stable": 2})
    >>> found.best["a"], found.value.exact, found.proved
    (Fraction(1, 1), Fraction(2, 1), True)
    """
    asked = design_from(question, maximise=maximise, over=over, along=along, where=where, pose=pose)
    share = share_for("tolerance", tolerance)
    for key, number in (("evaluations", evaluations), ("boxes", boxes), ("seed", seed)):
        least = 0 if key == "seed" else 1
        if number is not None and (
            isinstance(number, bool) or not isinstance(number, int) or number < least
        ):
            raise ConfigError(f"{number!r:.60} is not a whole number from {least} on", key=key)
    search = _DesignSearch(asked, timeout, progress)
    proof = search.run(share, seed, evaluations, boxes)
    return search.answer(proof, share, seed)


class _DesignSearch:
    """The designs that have been evaluated, and the best of them; ends when the time is over."""

    def __init__(self, asked: Design, timeout: float | None, progress: Progress | None) -> None:
        self.asked, self.report = asked, progress or (lambda _stage, _done, _total: None)
        self.deadline = None if timeout is None else perf_counter() + timeout
        self.value_of: Evaluate | None = None
        self.points: dict[Point, Value | None] = {}
        self.best: tuple[Point, Value] | None = None

    @property
    def over_time(self) -> bool:
        return self.deadline is not None and perf_counter() > self.deadline

    def run(self, tolerance: Fraction, seed: int, evaluations: int | None, boxes: int) -> Proof:
        """Search, and then prove; at the end the best design is evaluated once more by itself."""
        asked = self.asked
        self.report("critical values", 0, 1)
        maxima = exact_maximum(asked)
        if maxima is not None:
            self.value_of = evaluator(asked)
            return self._exactly(maxima, evaluations or EVALUATIONS)
        require("design")
        self.report("discriminant variety", 0, 1)
        bounder = bounder_of(asked, tolerance)
        space = bounder.space if isinstance(bounder, Lengths) else None
        common = (
            in_common(asked.family, Options())
            if asked.aim is Aim.AREA and asked.family is not None
            else None
        )
        self.value_of = evaluator(asked, common, space)
        usual = EVALUATIONS + PER_PARAMETER * (len(asked.over) - 1)
        self._search(seed, evaluations or (UNPROVED * usual if isinstance(bounder, str) else usual))
        if isinstance(bounder, str):
            return Proof(None, bounder)
        proof = bounded(asked, bounder, self._improved, tolerance, boxes, self._go_on)
        if space is not None:
            self._confirm()
        if proof.bound is not None:
            proof = proof._replace(bound=max(proof.bound, most_on_lines(asked)))
        return proof

    def _search(self, seed: int, most: int) -> None:
        bounds = [(axis.low, axis.high) for axis in self.asked.over]

        def evaluate(point: Point) -> Fraction | None:
            if self.over_time:
                raise LimitReached("the time is over")
            self.report("designs", len(self.points), most)
            found = self.look(within(bounds, point))
            return None if found is None else found.value.low

        with suppress(LimitReached):  # the time is over: what was found is there
            best_of(evaluate, len(bounds), seed, most)
        self._simpler()

    def _simpler(self) -> None:
        """Look at the simplest designs near the best one: corners of conditions, and kinks, are
        often there.
        """
        for share in SIMPLER:
            if self.best is None or self.over_time:
                return
            point = []
            for axis, at in zip(self.asked.over, self.best[0], strict=True):
                reach = axis.width * share
                simple = simplest_fraction(at - reach, at + reach)
                point.append(min(max(simple, axis.low), axis.high))
            self.look(tuple(point))

    def _confirm(self) -> None:
        """Evaluate the best design by the variety of its line alone: values must agree.

        A design whose line lies in the variety is left out, and the next best one is taken.
        """
        alone = evaluator(self.asked)
        while self.best is not None:
            point, known = self.best
            found = alone(self._named(point))
            self.points[point] = found
            if found is not None:
                if found.value.low > known.value.high or found.value.high < known.value.low:
                    raise ArithmeticError(
                        f"the range at {point} has two lengths, {known.value} and {found.value}"
                    )
                self.best = (point, found)
                return
            left = [(p, v) for p, v in self.points.items() if v is not None]
            self.best = max(left, key=lambda pair: pair[1].value.low, default=None)

    def _named(self, point: Point) -> dict[str, Fraction]:
        return dict(zip((axis.name for axis in self.asked.over), point, strict=True))

    def look(self, point: Point) -> Value | None:
        """The value at a design, evaluated once."""
        if point not in self.points:
            assert self.value_of is not None  # made before the first look
            found = self.points[point] = self.value_of(self._named(point))
            if found is not None and (
                self.best is None or found.value.low > self.best[1].value.low
            ):
                self.best = (point, found)
        return self.points[point]

    def _improved(self, point: Point | None) -> Fraction:
        if point is not None:
            self.look(point)
        return Fraction(0) if self.best is None else self.best[1].value.low

    def _go_on(self, boxes: int, bound: float, best: float) -> bool:
        self.report(f"boxes, at most {bound:.6g} where {best:.6g} is known...", boxes, boxes + 1)
        return not self.over_time

    def _exactly(self, maxima: Sequence[Any], evaluations: int) -> Proof:
        """The proof by exact critical values of the one parameter, and a curve of values for the
        picture.
        """
        (axis,) = self.asked.over
        places = [place_of(m) for m in maxima]
        inside = [min(max(p, axis.low), axis.high) for p in places]
        wanted = [*inside, *(axis.at(Fraction(k, evaluations)) for k in range(1, evaluations))]
        nearby = axis.width / 2**30
        for place in inside:  # where a place is itself none to count at, next to it
            wanted += [p for p in (place - nearby, place + nearby) if axis.holds(p)]
        for number, value in enumerate(wanted):
            if self.over_time:
                break
            self.report("designs", number, len(wanted))
            self.look((value,))
        where = (
            "; ".join(m.words(axis.name) for m in maxima)
            or "there is no such range within the bounds"
        )
        bound = max((m.width.high for m in maxima), default=Fraction(0))
        return Proof(bound, f"by exact critical values: {where}", maxima=tuple(maxima))

    def answer(self, proof: Proof, tolerance: Fraction, seed: int) -> BestDesign:
        """What was found and proved, as data."""
        asked = self.asked
        best, value = self.best if self.best is not None else (None, None)
        low = self._improved(None)
        if proof.boxes and proof.bound is not None and proof.bound < low:
            raise ArithmeticError(
                f"a design has {float(low)}, more than the bound {float(proof.bound)} of all"
            )
        proved = (
            proof.bound is not None and best is not None and proof.bound <= (1 + tolerance) * low
        )
        return BestDesign(
            name=asked.name,
            model=asked.model,
            maximise=asked.maximise,
            along=next((a for a in asked.axes if a.name == asked.along), None),
            fixed=asked.axes if asked.aim is Aim.AREA else (),
            over=asked.over,
            working=asked.working,
            conditions=tuple(condition.text for condition in asked.conditions),
            best=None if best is None else self._named(best),
            value=None if value is None else value.value,
            span=None if value is None else value.span,
            bound=None if proof.bound is None else max(proof.bound, low),
            tolerance=tolerance,
            proved=proved,
            reason=proof.reason,
            seed=seed,
            points=tuple(
                Evaluation(p, None if v is None else v.value) for p, v in self.points.items()
            ),
            boxes=proof.boxes,
            parameters=asked.text,
            maxima=proof.maxima,
        )
