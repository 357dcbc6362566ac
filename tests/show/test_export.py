"""The discriminant variety in every format: each text is put to its program, or to another reader
of its language.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import sympy
import yaml
from support.few import few
from support.maps import CONFIGS, shipped
from support.programs import (
    eliminated,
    monomials,
    needs_msolve,
    needs_qepcad,
    needs_singular,
    qepcad_session,
    singular,
)
from support.qepcad_cells import Decomposition, decomposition
from support.replacing import replace
from support.singular_slice import SHIPPED
from test_polynomial_text import of_sympy

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.cli import run
from ptmcad.errors import ConfigError, InfiniteSolutionsError
from ptmcad.show.polynomial_text import Style, symbols
from ptmcad.show.varietytext import FORMATS
from ptmcad.text.plane import PlanePolynomial

ROOT = Path(__file__).resolve().parents[2]
QUICK = ("fig2", "fig3", "fig4", "rods")


@cache
def variety(name: str) -> SliceVariety:
    return ptmcad.slice_variety(ptmcad.load(CONFIGS / f"{name}.yaml"))


def polynomials(of: SliceVariety) -> list[PlanePolynomial]:
    return [c.polynomial for c in of.components]


@pytest.mark.parametrize(
    "name",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in SHIPPED],
)
@pytest.mark.slow_cases("fig3", "fig4")
def test_components_are_those_of_the_region_map(name: str) -> None:
    expected = [(c.polynomial, c.kind, c.left_out) for c in shipped(name).components]
    assert [(c.polynomial, c.kind, c.left_out) for c in variety(name).components] == expected
    assert variety(name).complex_solutions == shipped(name).complex_solutions


def test_kinds_and_degrees_of_figure_4() -> None:
    """Reference: one curve of degree 24 in rho and 12 in L2 with 70 terms (the paper's section 4.3,
    corrected).
    """
    (critical,) = variety("fig4").critical
    assert (critical.polynomial.degrees, len(critical.polynomial.terms)) == ((24, 12), 70)
    assert "critical, degree 24 (24 in rho, 12 in L2), 70 terms" in variety("fig4").text()


# ------------------------------------------------------------------------------------------------ programs as text


@pytest.mark.parametrize("name", QUICK)
def test_sympy_program_defines_the_variety(name: str) -> None:
    found: dict[str, list[sympy.Expr]] = {}
    exec(variety(name).text("sympy"), found)  # type: ignore[arg-type]
    names = variety(name).slice.axis_names
    assert [of_sympy(p, names) for p in found["variety"]] == polynomials(variety(name))


LATEX_DISPLAY = re.compile(
    r"^% (\d+): [^\n]*\n\\begin\{align\*\}\n(.*?)\n\\end\{align\*\}$", re.MULTILINE | re.DOTALL
)


def latex_displays(of: SliceVariety) -> list[list[str]]:
    """The right sides of each display, row by row."""
    names = symbols(of.slice.axis_names, Style.LATEX)
    displays = []
    for number, body in LATEX_DISPLAY.findall(of.text("latex")):
        rows = re.split(r" \\\\\n", body)
        left, first = rows[0].split("&")
        assert left.strip() == f"V_{{{number}}}({names[0]}, {names[1]}) ={{}}"
        others = [re.fullmatch(r"\s*& \\quad \{\} ([+-] .*)", row) for row in rows[1:]]
        displays.append([first.strip(), *(match.group(1) for match in others if match)])
        assert all(others)
    return displays


@pytest.mark.parametrize("name", few(["fig3", "fig5-text"], "fig3"))
def test_latex_rows_are_set_and_of_like_width(name: str, tmp_path: Path) -> None:
    """matplotlib's mathtext, which knows no alignment, sets each row; none would leave a page of a
    single column.
    """
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    for rows in latex_displays(variety(name)):
        for row in rows:
            assert 0 < parser.parse(f"${row}$").width < 480  # points, at 12 pt


LONG = f"F3: -1/3 + {10**30 + 1}/{10**31 + 7}*L2"


@pytest.fixture(scope="module", name="odd")
def odd_fixture(tmp_path_factory: pytest.TempPathFactory) -> ptmcad.SliceVariety:
    """A title may have any characters, a value may be long."""
    record = tmp_path_factory.mktemp("odd") / "odd.yaml"
    title = "'ends *) ] #\u2026'"
    record.write_text(
        f"title: {title}\naxes: {{rho: [1, 2], L2: [1, 2]}}\nparameters:\n  {LONG}\n",
        encoding="utf-8",
    )
    return ptmcad.slice_variety(ptmcad.load(record))


@pytest.mark.parametrize("format", FORMATS)
def test_titles_and_long_values_break_nothing(format: str, odd: ptmcad.SliceVariety) -> None:
    """Both appear in comments at most."""
    text = odd.text(format)
    assert text.endswith("\n")
    assert text.isascii()
    if format == "sympy":
        exec(text, {})
    if format == "mathematica":
        bare = re.sub(r"\(\*.*?\*\)", "", text)
        assert re.fullmatch(r"[\w\s{}=;,^*+-]+", bare)
    if format not in ("json", "msolve"):
        assert re.search(r"F3 = .{60}\.\.\.", text)


def test_json_is_described_by_its_schema() -> None:
    schema = json.loads((ROOT / "docs" / "variety.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    for name in SHIPPED:
        of = variety(name)
        document = json.loads(of.text("json"))
        jsonschema.validate(document, schema, cls=jsonschema.Draft202012Validator)
        names = of.slice.axis_names
        assert [
            PlanePolynomial.parse(c["polynomial"], names) for c in document["components"]
        ] == polynomials(of)
        assert [c["kind"] for c in document["components"]] == [c.kind.value for c in of.components]
        document["components"][0]["kind"] = "other"
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(document, schema, cls=jsonschema.Draft202012Validator)


# ---------------------------------------------------------------------------------------------------- QEPCAD


@cache
def qepcad_cells(name: str) -> Decomposition:
    text = variety(name).text("qepcad")
    assert text.endswith("\nquit\n")
    (output,) = qepcad_session([text.removesuffix("quit\n")])
    return decomposition(output, symbols(variety(name).slice.axis_names, Style.QEPCAD))


@needs_qepcad
@pytest.mark.parametrize(
    "name",
    [
        name if name in ("fig2", "fig3") else pytest.param(name, marks=pytest.mark.slow)
        for name in SHIPPED
    ],
)
@pytest.mark.slow_cases("fig3")
def test_qepcad_decomposes_the_window(name: str) -> None:
    """Its true cells lie off the variety and in the window, and there is one in each cell of the
    region map.

    The map may stand over the other axis; then the numbers of cells may differ, but each region is
    met all the same.
    """
    result, found = shipped(name), qepcad_cells(name)
    used = {c.polynomial for c in variety(name).components if not c.left_out}
    assert used <= set(found.factors.values())
    true = [cell for index, cell in found.cells.items() if len(index) == 2 and cell.truth == "T"]
    located = []
    for cell in true:
        x, y = cell.sample
        assert x is not None and y is not None
        at = result.locate(**dict(zip(result.slice.axis_names, (x, y), strict=True)))
        assert at.status is Status.EXACT
        located.append(at)
    assert {at.region for at in located} == set(range(len(result.regions)))
    if result.base == 0:
        assert sorted(at.cell for at in located if at.cell is not None) == list(
            range(len(result.cells))
        )


@needs_qepcad
def test_a_name_that_qepcad_can_not_spell(tmp_path: Path) -> None:
    record = tmp_path / "names.yaml"
    record.write_text("axes: {a_b: [0, 2], ab: [1, 2]}\nparameters: {rho: a_b, L2: ab}\n")
    text = ptmcad.slice_variety(ptmcad.load(record)).text("qepcad")
    assert qepcad_session([text.removesuffix("quit\n")])


# ------------------------------------------------------------------------------------------- the elimination system


def divided_out(
    generator: PlanePolynomial, of: SliceVariety
) -> tuple[set[PlanePolynomial], PlanePolynomial]:
    """The components that divide a polynomial, and what is left when they are divided out."""
    x, y = sympy.symbols("x y")

    def poly(p: PlanePolynomial) -> sympy.Poly:
        return sympy.Poly.from_dict({(i, j): c for i, j, c in p.terms}, x, y)

    rest, found = poly(generator), set()
    for component in of.components:
        factor = poly(component.polynomial)
        while rest.total_degree() >= factor.total_degree():
            quotient, remainder = rest.div(factor)
            if remainder:
                break
            found.add(component.polynomial)
            rest = quotient
    return found, PlanePolynomial.of(
        (int(i), int(j), int(c)) for (i, j), c in rest.clear_denoms()[1].terms()
    )


def check_elimination(generators: Iterable[str], of: SliceVariety, names: tuple[str, str]) -> None:
    """One generator, whose factors are the CRITICAL components and no others."""
    (generator,) = generators
    whole = monomials(generator, names)
    assert all(c.denominator == 1 for c in whole.values())
    found, rest = divided_out(
        PlanePolynomial.of((e[0], e[1], int(c)) for e, c in whole.items()), of
    )
    assert rest.total_degree == 0
    critical = {c.polynomial for c in of.critical}
    assert critical <= found
    assert found == critical


@needs_msolve
@pytest.mark.parametrize(
    "name",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in SHIPPED],
)
def test_msolve_eliminates_to_the_critical_curves(name: str) -> None:
    of = variety(name)
    check_elimination(
        eliminated(of.text("msolve"), len(of.system.unknowns)), of, of.slice.axis_names
    )


EXCLUDED = yaml.safe_load("""
system:
  parameters: {q: {}}
  unknowns: {x: real, inverse: real}
  equations: [x*(x^2 + inverse - a), x*(inverse^2 - x - q)]
  positive: [x]
parameters: {q: b/(3 - a)}
axes: {a: [-2, 2], b: [-2, 2]}
""")
"""Solutions with x = 0 are infinitely many, and where a = 3 the equations have no meaning."""


def test_the_system_has_inverses_of_what_is_not_zero() -> None:
    """Under names that are not taken."""
    lines = ptmcad.slice_variety(ptmcad.slice_from_mapping(EXCLUDED)).text("msolve").splitlines()
    assert lines[0] == "x,inverse,inverse1,inverse2,a,b"
    assert {"x*inverse1-1,", "inverse2*a-3*inverse2-1,"} <= set(lines[2:])


@needs_msolve
@pytest.mark.parametrize(
    "record", [EXCLUDED, "systems/duffing", "systems/escape", "mechanisms/two-bar-chain"]
)
def test_msolve_leaves_out_what_ptmcad_leaves_out(record: Any) -> None:
    slice = (
        ptmcad.load(CONFIGS / f"{record}.yaml")
        if isinstance(record, str)
        else ptmcad.slice_from_mapping(record)
    )
    of = ptmcad.slice_variety(slice)
    generators = eliminated(of.text("msolve"), len(of.system.unknowns))
    # where x = 0 at a solution, at which y = a and so y^2 = q, its inverse leaves; that is no
    # singular solution
    leaving = PlanePolynomial.of(((3, 0, 1), (2, 0, -3), (0, 1, 1)))
    kept = tuple(c for c in of.components if c.polynomial != leaving)
    assert len(of.components) - len(kept) == (record is EXCLUDED)
    check_elimination(generators, replace(of, components=kept), slice.axis_names)


@needs_singular
@pytest.mark.parametrize("name", ["fig2", "fig3", "fig4"])
@pytest.mark.slow_cases("fig3", "fig4")
def test_singular_eliminates_the_same_system(name: str) -> None:
    """The text for msolve, put to another program."""
    of = variety(name)
    variables, characteristic, *lines = of.text("msolve").splitlines()
    names = variables.split(",")
    product = "*".join(names[: len(of.system.unknowns)])
    output = singular(
        f"ring r = {characteristic}, ({variables}), dp;\nideal i = {''.join(lines)};\n"
        f"ideal e = eliminate(std(i), {product});\nprint(string(e));"
    )
    check_elimination("".join(output.split()).split(","), of, of.slice.axis_names)


# --------------------------------------------------------------------------------------------- the command line


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.fast_cases("msolve")
def test_command_prints_or_writes_the_same(
    format: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ["variety", str(CONFIGS / "fig3.yaml"), "--format", format]
    assert run(arguments) == 0
    printed = capsys.readouterr()
    assert printed.out == variety("fig3").text(format)
    assert printed.err == ""
    assert run([*arguments, "--out", "sub/fig3.txt"]) == 0
    assert capsys.readouterr().out == "written   sub/fig3.txt\n"
    assert (tmp_path / "sub" / "fig3.txt").read_text(encoding="utf-8") == printed.out
    assert [path.name for path in (tmp_path / "sub").iterdir()] == ["fig3.txt"]


def test_unknown_format_in_python() -> None:
    with pytest.raises(ConfigError, match="maple"):
        variety("fig3").text("mapel")


def test_degenerate_slice_has_no_variety() -> None:
    with pytest.raises(InfiniteSolutionsError):
        ptmcad.slice_variety(ptmcad.slice_from_options(slice="L1,L2", sets=["rho=0"]))
