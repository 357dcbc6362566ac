"""Areas and shares as text: the same in tables, legends, insets and pages, and nowhere where they
were not computed.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import pytest
from support.certified_maps import circle
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer.comparison import Change, Comparison
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.comparing import comparison_figure, difference_words
from ptmcad.show.render.legend import Entry, entries
from ptmcad.show.render.printing import settings
from ptmcad.show.style import DEFAULT
from ptmcad.show.table import in_order, region_area, table
from ptmcad.text.numerals import percent, share_text


@pytest.fixture(scope="module")
def bare() -> RegionMap:
    return ptmcad.classify(ptmcad.load(CONFIGS / "fig4.yaml"), areas=False)


@pytest.fixture(scope="module")
def certified() -> RegionMap:
    return circle(7)


def words(legend: Iterable[Entry]) -> str:
    return "\n".join(line for entry in legend for line in entry.lines)


def test_a_comparison_tells_its_own_areas_only(bare: RegionMap) -> None:
    with settings(DEFAULT):
        figure = comparison_figure(bare.compare(bare), 100, DEFAULT)
    assert not [text.get_text() for text in figure.texts if "area" in text.get_text()]


def test_a_region_alone_with_its_count_has_the_area_of_the_count(certified: RegionMap) -> None:
    legend = words(entries(certified, False)).replace("\n", " ")
    counts = [region.stable for region in certified.regions]
    alone = [n for n, stable in enumerate(counts) if counts.count(stable) == 1]
    assert alone
    for number in alone:
        assert f"area {region_area(certified, number)}" in legend
        assert region_area(certified, number) in table(certified)


def test_shares_are_rounded_up_wherever_they_are_told(certified: RegionMap) -> None:
    share = percent(certified.undetermined)
    assert Fraction(share.removesuffix(" %")) / 100 >= certified.undetermined
    assert f"{share} undetermined" in table(certified)
    assert f"undetermined {share}" in words(entries(certified, False))
    assert percent(Fraction("0.043034")) == "4.4 %"


def test_a_comparison_says_its_share_at_the_prompt_as_in_words() -> None:
    found = Comparison(
        *[shipped("fig4")] * 3, (Change(0, 1, 0, (Fraction("1.559386"), Fraction("1.559387"))),)
    )
    assert share_text(found.share, False) == "38.98 %"
    assert "38.98 % differ" in repr(found)
    assert "38.98 % of the window" in difference_words(found)[0]


@pytest.mark.parametrize(
    ("texts", "ordered"),
    [
        (["10 in all", "2 in all", "4 in all"], ["2 in all", "4 in all", "10 in all"]),
        (["(2, 10, 1)", "(2, 9, 1)", "?"], ["?", "(2, 9, 1)", "(2, 10, 1)"]),
    ],
)
def test_counts_are_in_the_order_of_numbers(texts: list[str], ordered: list[str]) -> None:
    assert sorted(texts, key=in_order) == ordered
