"""The table of the kinds of count: complete, and its margins are what they are called."""

from __future__ import annotations

from fractions import Fraction
from math import hypot

import pytest
import yaml
from support.replacing import replace

import ptmcad
from ptmcad.answer.words import count_words
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism
from ptmcad.model.evaluate import value_at
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.question.counts import KINDS, Count
from ptmcad.question.slice import count_fault
from ptmcad.verification.kinds import kind_of


@pytest.mark.parametrize("count", list(Count))
def test_each_kind_has_a_row_that_fits_every_model(count: Count) -> None:
    kind = KINDS[count]
    assert count in kind.implied and kind.rank in range(len(Count))
    for record in ("fig4", "cubic"):
        model = load(record).model
        texts = [count_words(words, model) for words in (kind.legend, kind.tail, kind.page)]
        assert all(texts) and not any("{" in text for text in texts)
    assert kind.predicate is None or kind.is_of_stable


def test_a_margin_has_the_sign_of_the_length_less_the_free_length() -> None:
    slice = load("three-cables")
    predicate = Count.ADMISSIBLE.kind.predicate
    assert predicate is not None and isinstance(slice.model, Mechanism)
    margins = list(predicate.margins(slice.model))
    assert [margin.text for margin in margins] == [
        f"the length of spring {name} less its free length" for name in ("k", "BP", "CP")
    ]
    anchors = ((-1.0, 0.0), (1.0, 0.0), (0.0, -2.0))
    for x, y in (
        (Fraction(1, 3), Fraction(-1, 2)),
        (Fraction(3, 2), Fraction(1)),
        (Fraction(0), Fraction(-3)),
    ):
        values = {"x": x, "y": y, "l0": Fraction(1)}
        for margin, (a, b) in zip(margins, anchors, strict=True):
            assert (value_at(margin.value, values) > 0) is (hypot(float(x) - a, float(y) - b) > 1)


def test_a_count_that_makes_no_sense_is_refused_whoever_asks() -> None:
    equations = yaml.safe_load("""
        name: cubic
        system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}
        axes: {a: [-1, 1], b: [-1, 1]}
    """)
    slice = slice_from_mapping(equations)
    for count, why in (
        ("index", "no index"),
        ("stable", "nothing says what a stable"),
        ("admissible", "no springs"),
    ):
        with pytest.raises(ConfigError, match=why):
            slice_from_mapping({**equations, "count": count})
        with pytest.raises(ConfigError, match=why):
            ptmcad.classify(slice, count=count)


def test_margins_are_in_the_unknowns_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """With X-joints points depend on angles that follow others: no margin is made of these,
    whichever count asks.
    """
    kind = KINDS[Count.ADMISSIBLE]
    assert kind.predicate is not None
    asks = replace(kind, predicate=replace(kind.predicate, needs_free_lengths=False))
    monkeypatch.setitem(KINDS, Count.ADMISSIBLE, asks)
    for name, found in (
        ("x-joint", "with x-joints admissible is not counted yet"),
        ("four-bar", ""),
    ):
        slice = load(name)
        fault = count_fault(Count.ADMISSIBLE, slice.model, slice.parameters)
        assert fault.split(":")[0] == found
        assert kind_of(Count.ADMISSIBLE).is_of(slice.model) is (not found)
