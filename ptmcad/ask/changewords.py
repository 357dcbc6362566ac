"""What changes from one arrangement of regions to another, in words.

Guarantee: none: regions of two members are taken for the same where a sample of the one lies in the
other and the counts agree. Near enough to the change they are; no decision rests on it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from ptmcad.answer.arrangement import SIDES
from ptmcad.answer.counts import key_text
from ptmcad.answer.words import index_words, noun
from ptmcad.exact.cad.decomposition import Link, members, region_numbers
from ptmcad.exact.slicearrangement import Picture
from ptmcad.text.numerals import text_of

_Same = tuple[list[int], list[int]]
"""Regions before and after that are one region, or parts of one."""


def described(before: Picture, after: Picture) -> tuple[str, ...]:
    """What happens to the regions on the way, a sentence each; never nothing."""
    groups = _groups(before, after)
    found = [*_births(before, after, groups)]
    kept = {old[0]: new[0] for old, new in groups if len(old) == len(new) == 1}
    found += _sides(before, after, kept)
    found += _contacts(before, after, kept)
    return tuple(dict.fromkeys(found)) or ("regions lie in another order along the window's sides",)


def _groups(before: Picture, after: Picture) -> list[_Same]:
    number = len(before.arrangement.keys)
    keys = (*before.arrangement.keys, *after.arrangement.keys)
    links: list[Link] = [(a, number + b, 1) for a, b in _shared(before, after)]
    links += [(a, number + b, 1) for b, a in _shared(after, before)]
    groups = members(region_numbers(keys, links))
    return [([n for n in g if n < number], [n - number for n in g if n >= number]) for g in groups]


def _shared(one: Picture, other: Picture) -> Iterator[tuple[int, int]]:
    """Regions of the one, and those of the other in which their samples lie."""
    for region, point in zip(one.neighbours.region_of, one.cut.points, strict=True):
        found = other.region_at(point)
        if found is not None:
            yield region, found


def _births(before: Picture, after: Picture, groups: list[_Same]) -> Iterator[str]:
    appear, vanish = (Counter[tuple[int, ...]]() for _ in range(2))
    for old, new in groups:
        many, others = len(old), len(new)
        key = before.arrangement.keys[old[0]] if many else after.arrangement.keys[new[0]]
        of = _of(before, key)
        if not many:
            appear[key] += 1
        elif not others:
            vanish[key] += 1
        elif many == 1 and others > 1:
            yield f"{_article(before, key)} region of {of} splits into {others}"
        elif others == 1 and many > 1:
            yield f"{many} regions of {of} join"
        elif many > 1:
            yield f"{many} regions of {of} become {others}"
    for table, one, several in ((appear, "appears", "appear"), (vanish, "vanishes", "vanish")):
        for key, number in table.items():
            of = _of(before, key)
            yield (
                f"a region of {of} {one}" if number == 1 else f"{number} regions of {of} {several}"
            )


def _sides(before: Picture, after: Picture, kept: dict[int, int]) -> Iterator[str]:
    """Which regions reach a side, or leave it."""
    for a, b in kept.items():
        key = before.arrangement.keys[a]
        name = f"{_article(before, key)} region of {_of(before, key)}"
        touched = (before.arrangement.touched(a), after.arrangement.touched(b))
        for side, earlier, later in zip(SIDES, *touched, strict=True):
            if bool(earlier) != bool(later):
                yield f"{name} {'leaves' if earlier else 'reaches'} {_side(before, side)}"


def _contacts(before: Picture, after: Picture, kept: dict[int, int]) -> Iterator[str]:
    """Which regions become neighbours, or are neighbours no more."""
    earlier = {
        tuple(sorted((kept[a], kept[b])))
        for a, b in before.arrangement.neighbours
        if {a, b} <= kept.keys()
    }
    stay = set(kept.values())
    later = {pair for pair in after.arrangement.neighbours if set(pair) <= stay}
    for pairs, verb in (
        (later - earlier, "become neighbours"),
        (earlier - later, "are neighbours no more"),
    ):
        for pair in sorted(pairs):
            first, second = (_of(after, after.arrangement.keys[n]) for n in pair)
            yield f"regions of {first} and of {second} {verb}"


def _article(picture: Picture, key: tuple[int, ...]) -> str:
    return "the" if picture.arrangement.keys.count(key) == 1 else "a"


def _side(picture: Picture, side: str) -> str:
    """A side as text, such as rho = 2."""
    end, axis = side.split()
    found = picture.problem.slice.axes["xy".index(axis)]
    return f"{found.name} = {text_of(found.low if end == 'low' else found.high)}"


def _of(picture: Picture, key: tuple[int, ...]) -> str:
    """What is counted, with its number."""
    slice = picture.problem.slice
    if len(key) > 1:
        return f"{key_text(key)} {index_words(len(key))}"
    return f"{key[0]} {'stable ' if slice.count.is_of_stable else ''}{noun(slice.model, key[0])}"
