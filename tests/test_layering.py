"""The layering that docs/architecture.md describes, read off the import statements."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ptmcad"
MODULES = sorted(PACKAGE.rglob("*.py"))

EXACT = (
    "interval",
    "algebra",
    "models",
    "cad",
    "counting",
    "balls",
    "statics",
    "solving",
    "variety",
    "area",
    "regions",
    "regionmap",
    "exactmap",
    "interval",
    "assembly",
    "locate",
    "ranges",
    "verification",
    "paper",
    "stress",
    "bench",
)
FLINT_POLYNOMIALS = ("poly", "mpoly", "mpoly_ctx", "mpoly_vec", "series")


def part(path: Path) -> str:
    """The folder or module right under the package that a file belongs to, such as ``cad`` or ``slice``."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> Iterator[tuple[str, str]]:
    """Every import in a file, at any depth: pairs of the module and the name taken from it, or an empty name."""
    package = [PACKAGE.name, *path.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, ""
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            module = ".".join(filter(None, (base, node.module or "")))
            for alias in node.names:
                yield module, alias.name


def imported_parts(path: Path) -> set[str]:
    """The parts of ptmcad that a file imports, in either way of writing it."""
    found = set()
    for module, name in imports(path):
        names = f"{module}.{name}".split(".")
        if names[0] == PACKAGE.name and len(names) > 1:
            found.add(names[1])
    return found - {""}


def relative(path: Path) -> str:
    return str(path.relative_to(ROOT))


def test_relative_imports_are_resolved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reader of imports itself: nothing escapes it by being written another way."""
    monkeypatch.setattr(sys.modules[__name__], "PACKAGE", tmp_path / "ptmcad")
    module = tmp_path / "ptmcad" / "interval" / "boxes.py"
    module.parent.mkdir(parents=True)
    module.write_text("import ptmcad.cad\nfrom ptmcad import algebra\nfrom ..variety import x\nfrom . import y\n")
    assert imported_parts(module) == {"cad", "algebra", "variety", "interval"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_only_render_imports_matplotlib(path: Path) -> None:
    tops = {module.partition(".")[0] for module, _ in imports(path)}
    assert part(path) == "render" or not tops & {"matplotlib", "mpl_toolkits"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_flint_stays_in_the_exact_engine(path: Path) -> None:
    """FLINT's numbers and balls are used where counts are made; its polynomials in algebra/ and in its checks."""
    names = {name for module, name in imports(path) if module.partition(".")[0] == "flint"}
    used = {
        node.attr
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "flint"
    }
    if names or used:
        assert part(path) in (*EXACT, "interval")
    if part(path) not in {"algebra", "verification", "stress"}:
        assert not [name for name in names | used if name.endswith(FLINT_POLYNOMIALS)]


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_the_engines_are_independent(path: Path) -> None:
    """A check of one engine by the other proves something only while they share no mathematics."""
    if part(path) == "interval":
        assert not imported_parts(path) & {"algebra", "cad", "variety", "counting", "area"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_plane_geometry_is_of_no_engine(path: Path) -> None:
    """What is connected outside of rectangles is a question about integers."""
    if part(path) == "cover":
        assert imported_parts(path) <= {"cover"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_verification_shares_no_code_with_what_it_verifies(path: Path) -> None:
    """Only the result's own data classes, and FLINT, are common to both; and the engine never asks its checker."""
    if part(path) == "verification":
        assert imported_parts(path) <= {
            "verification", "regionmap", "cover", "plane", "expressions", "slice", "errors", "numerals", "syntax",
            "mechanism",
        }  # fmt: skip
        assert "ptmcad.mechanism.evaluate" not in {module for module, _ in imports(path)}
    elif part(path) not in {"cli", "__init__"}:
        assert "verification" not in imported_parts(path)


def test_verification_loads_nothing_of_the_engine(tmp_path: Path) -> None:
    """Not even through another module."""
    code = (
        "import sys, ptmcad\n"
        "ptmcad.verify\n"
        "engine = ('algebra', 'cad', 'models', 'variety', 'counting', 'regions', 'pipeline', 'exactmap', 'locate')\n"
        "loaded = [name for name in sys.modules if name.startswith(tuple('ptmcad.' + e for e in engine))\n"
        "          and not name.startswith('ptmcad.regionmap')]\n"
        "assert not loaded, loaded\n"
    )
    loaded_after(code, tmp_path)


WATCHING = {
    "__main__": {"cli", "supervisor"},
    "supervisor": {"handover", "streams", "shortage", "output", "commit", "errors"},
    "commit": {"handover", "journal", "errors"},
    "journal": set(),
    "handover": set(),
    "streams": set(),
    "shortage": set(),
    "memory": {"errors", "handover", "shortage"},
}


@pytest.mark.parametrize("name", WATCHING)
def test_what_watches_knows_nothing_of_what_is_computed(name: str) -> None:
    assert imported_parts(PACKAGE / f"{name}.py") <= WATCHING[name]


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_stress_asks_the_engines_as_a_user_does(path: Path) -> None:
    """The answers that ptmcad is held against share no mathematics with it, and nothing that computes knows of them."""
    if part(path) == "stress":
        assert not imported_parts(path) & {
            "algebra", "cad", "counting", "variety", "solving", "statics", "models", "interval", "balls", "exactmap",
        }  # fmt: skip
    elif part(path) not in {"cli", "render"}:
        assert "stress" not in imported_parts(path)


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_only_the_entry_forks(path: Path) -> None:
    """A library function must not turn its caller's process into two."""
    if part(path) not in {"__main__", "supervisor"}:
        assert "supervisor" not in imported_parts(path)


def test_the_fork_comes_before_everything_large(tmp_path: Path) -> None:
    """Handlers are set and the process is forked while little is loaded: a copy of little costs little."""
    loaded = loaded_after("import ptmcad.__main__, ptmcad.supervisor", tmp_path)
    assert not loaded & {"click", "yaml", "flint", "numpy", "dataclasses", "pathlib", "subprocess"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_data_flows_one_way(path: Path) -> None:
    """What computes knows nothing of how results are shown, asked for or timed."""
    if part(path) not in {"cli", "bench", "render", "report", "paper", "stress", "__main__"}:
        allowed = {"regionmap": {"render"}, "slicevariety": {"export"}, "export": {"export"}}.get(part(path), set())
        assert not imported_parts(path) & {"cli", "bench", "render", "export"} - allowed
    if part(path) in {"errors", "textfile"}:
        assert imported_parts(path) <= {"errors", "numerals"}
    if part(path) == "syntax":
        assert imported_parts(path) <= {"errors"}
    if part(path) == "expressions":
        assert imported_parts(path) <= {"errors", "numerals", "syntax"}
    if part(path) == "mechanism":
        assert imported_parts(path) <= {"mechanism", "syntax", "errors"}
    if part(path) == "export":
        assert imported_parts(path) <= {
            "export", "slicevariety", "polynomial_text", "plane", "regionmap", "numerals", "errors", "expressions",
            "syntax", "mechanism",
        }  # fmt: skip
    if part(path) == "yamltree":
        assert imported_parts(path) <= {"errors", "textfile"}


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_the_report_tells_what_the_result_holds_and_computes_nothing(path: Path) -> None:
    """It may read, write down and draw; the engine is out of its reach, and only a command asks for it."""
    if part(path) == "report":
        assert imported_parts(path) <= {
            "report", "regionmap", "slice", "plane", "polynomial_text", "table", "numerals", "errors", "version",
            "render", "config", "yamltree", "document", "textfile", "mechanism",
        }  # fmt: skip
    elif part(path) != "cli":
        assert "report" not in imported_parts(path)


def test_the_report_does_without_matplotlib(tmp_path: Path) -> None:
    """Outlines and colours are all that it takes from render/."""
    assert not loaded_after("import ptmcad.report", tmp_path) & {"matplotlib", "sympy"}


def test_reading_poses_loads_nothing_of_the_engine(tmp_path: Path) -> None:
    """Enclosures, poses, their document and table are free of any engine."""
    code = "import ptmcad, ptmcad.document.poses, ptmcad.posetable; ptmcad.Poses, ptmcad.Enclosure"
    assert not loaded_after(code, tmp_path) & {"flint", "yaml", "numpy", "matplotlib", "sympy"}


def test_solving_needs_no_picture_or_symbolic_library(tmp_path: Path) -> None:
    code = "import ptmcad; ptmcad.solve(rho='7/10', F3=-10).to_json()"
    loaded = loaded_after(code, tmp_path)
    assert "flint" in loaded
    assert not loaded & {"matplotlib", "sympy", "numpy"}


def loaded_after(code: str, tmp_path: Path) -> set[str]:
    """Top-level modules loaded by a fresh interpreter that has run the code."""
    report = "import json, sys; print('\\n' + json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{report}"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_the_command_line_starts_lean(tmp_path: Path) -> None:
    """``ptmcad --help`` must not wait for a computing or drawing library."""
    assert not loaded_after("import ptmcad.cli", tmp_path) & {"matplotlib", "sympy", "numpy", "flint"}


def test_json_needs_no_picture_or_symbolic_library(tmp_path: Path) -> None:
    """A whole classification to JSON loads neither matplotlib nor sympy nor numpy nor numba."""
    record = str(ROOT / "configs" / "fig4.yaml")
    code = (
        "import sys\n"
        "from ptmcad.cli import main\n"
        f"sys.argv = ['ptmcad', 'classify', {record!r}, '--format', 'json', '--out', '.']\n"
        "try:\n"
        "    main()\n"
        "except SystemExit as end:\n"
        "    assert not end.code, end.code\n"
    )
    loaded = loaded_after(code, tmp_path)
    assert "flint" in loaded
    assert not loaded & {"matplotlib", "sympy", "numpy", "numba"}
    assert (tmp_path / "fig4.json").exists()
