"""Maps by a predicate are proved from the checker's own margins, whichever engine made them, and
false ones refused.

The predicate: the first bar of the paper's mechanism points upwards.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question import counts
from ptmcad.question.config import load
from ptmcad.question.counts import KINDS, Count, Margin
from ptmcad.text.tree import Call, Name
from ptmcad.verification import kinds
from ptmcad.verification.derivation import Derivation, derivation_of
from ptmcad.verification.kinds import CheckedKind, CheckedMargin, kind_of
from ptmcad.verification.report import Violation

pytest.importorskip("numba")
UPWARDS = Call("sin", Name("th1"))


def upwards(point: Derivation) -> Iterator[CheckedMargin]:
    yield CheckedMargin(point.ring.value(UPWARDS))


@pytest.fixture(params=["certified", "exact"])
def true(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> RegionMap:
    kind = KINDS[Count.ADMISSIBLE]
    assert kind.predicate is not None
    predicate = replace(
        kind.predicate,
        margins=lambda _: iter([Margin("", UPWARDS)]),
        is_symmetric=False,
        needs_free_lengths=False,
    )
    monkeypatch.setitem(KINDS, Count.ADMISSIBLE, replace(kind, predicate=predicate))
    monkeypatch.setitem(counts.PREDICATES, "admissible", predicate)
    row = CheckedKind(
        kind_of(Count.ADMISSIBLE).is_of, upwards, boundary="level", undecided="th1 may be 0"
    )
    monkeypatch.setitem(kinds._KINDS, Count.ADMISSIBLE, row)
    found: RegionMap = ptmcad.classify(
        load("fig4"), count="admissible", engine=request.param, jobs=1
    )
    return found


def recounted(r: RegionMap, by: int) -> RegionMap:
    """One region with as many more solutions at which the predicate holds, all cells of it."""
    region = r.regions[-1]
    further = {"admissible": region.further["admissible"] + by}
    cells = [replace(c, further=further) if n in region.cells else c for n, c in enumerate(r.cells)]
    return replace(
        r, regions=(*r.regions[:-1], replace(region, further=further)), cells=tuple(cells)
    )


def test_maps_by_a_predicate(true: RegionMap) -> None:
    assert len({region.further["admissible"] for region in true.regions}) > 1
    report = ptmcad.verify(true, boxes=4)
    assert report.ok, report.violation
    for by in (-1, 1):
        false = ptmcad.verify(recounted(true, by), boxes=0)
        assert false.violation is not None
        assert false.violation.startswith(
            "counts" if by > 0 or true.regions[-1].further["admissible"] else "form"
        )


def test_no_exact_map_by_a_predicate_where_conditions_say_what_is_stable() -> None:
    """The exact engine makes none; a forged one would be checked by the last of all conditions
    alone.
    """
    row = CheckedKind(kind_of(Count.ADMISSIBLE).is_of, upwards, boundary="level")
    loop = derivation_of(load("four-bar").model)
    assert loop.stability
    with pytest.raises(Violation, match="no exact maps by a predicate"):
        row.with_margins(loop)
    assert kind_of(Count.STABLE).with_margins(loop) is loop
