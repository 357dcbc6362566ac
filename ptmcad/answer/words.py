"""What solutions are called: equilibria of a mechanism and solutions of a system, minima, saddles
and maxima.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from fractions import Fraction

from ptmcad.model import Model
from ptmcad.model.work import acting, foreign, moments_at, split_moments


def noun(model: Model, number: int = 2) -> str:
    """Equilibrium or equilibria of a mechanism, solution or solutions of another system.

    >>> from ptmcad.model import ptm
    >>> noun(ptm()), noun(ptm(), 1)
    ('equilibria', 'equilibrium')
    """
    if model.whole is not None:
        return "equilibrium" if number == 1 else "equilibria"
    return "solution" if number == 1 else "solutions"


def with_article(noun: str) -> str:
    """The noun after a or an.

    >>> with_article("equilibrium"), with_article("solution")
    ('an equilibrium', 'a solution')
    """
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def listed(names: Sequence[str], last: str = " and ") -> str:
    """Names in a row.

    >>> listed(["a saddle", "a saddle", "a maximum"]), listed(["a saddle"]), listed([])
    ('a saddle, a saddle and a maximum', 'a saddle', '')
    """
    return last.join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def several(number: int, noun: str) -> str:
    """A number of what has a regular plural.

    >>> several(1, "region"), several(0, "curve")
    ('1 region', '0 curves')
    """
    return f"{number} {noun}{'s' * (number != 1)}"


def counted(model: Model, number: int) -> str:
    """A number with the noun."""
    return f"{number} {noun(model, number)}"


def sought(model: Model, number: int = 2) -> str:
    """The noun for what an operation range has: of stable ones, where it is known which are."""
    return f"{model.criterion.adjective}{noun(model, number)}"


def followed(model: Model) -> str:
    """What is followed along a path: a stable pose, or solution, where it is known which are."""
    return f"{model.criterion.adjective}{model.nouns.pose}"


def stable_of(model: Model, stable: int | None, total: int) -> str:
    """The number of all solutions, after that of stable ones where these are known."""
    return (
        counted(model, total) if stable is None else f"{stable} stable of {counted(model, total)}"
    )


def assignments(
    model: Model, angles: Iterable[str], reals: Iterable[str], named: Callable[[str], str] = str
) -> list[str]:
    """The unknowns with their values, which are given as texts."""
    names = map(named, model.sorted_unknowns)
    return [f"{name} = {value}" for name, value in zip(names, (*angles, *reals), strict=True)]


def index_words(entries: int) -> str:
    """What the entries of an index stand for.

    >>> index_words(3), index_words(4)
    ('minima-saddles-maxima', 'minima-saddles of index 1-saddles of index 2-maxima')
    """
    saddles = (
        ["saddles"] if entries == 3 else [f"saddles of index {k}" for k in range(1, entries - 1)]
    )
    return "-".join(["minima", *saddles, "maxima"])


def count_words(template: str, model: Model, number: int = 2) -> str:
    """The words of a kind of count (`ptmcad.question.counts`) for a model; ``number`` is how many
    there are of it.
    """
    entries = index_words(len(model.unknowns) + 1).split("-")
    many = noun(model, number)
    return template.format(
        noun=many,
        Noun=many.capitalize(),
        index=", ".join(entries),
        indices=listed(entries),
        in_all=model.nouns.total or many,
    )


def untold(model: Model) -> str:
    """Why it is not said which equilibria are stable; empty where it is, and of equations that say
    nothing of it.
    """
    what = foreign(model)
    return what and f"nothing says which are stable, as {what} depends on another unknown"


def of_what(model: Model, parameters: Mapping[str, Fraction]) -> str:
    """What an energy at a point leaves out; empty where no moment works.

    Parameters
    ----------
    model : one that has a potential.
    """
    work = moments_work(model, moments_at(model, parameters))
    return work and f"of springs and loads, without the {work}"


def moments_work(model: Model, unknowns: Collection[str]) -> str:
    """What the moments on some unknowns do, and the forces on those that are no angles, that is in
    no energy; empty where there are none.

    Parameters
    ----------
    model : a mechanism; the work of what varies in a moment is in its energy.
    """
    if not unknowns:
        return ""
    what, several = acting(model, unknowns), len(unknowns) > 1
    mechanism = model.drawable
    if mechanism is not None and split_moments(mechanism)[1]:
        return f"work of the constant part{'s' * several} of the {what}"
    if not set(unknowns) <= set(model.angles):
        return f"work of the {what}"
    return "moments' work" if several else "moment's work"
