"""The layering that docs/architecture.md describes: the contracts of pyproject.toml, and what they
cannot express.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import json
import pickle
import pkgutil
import subprocess
import sys
from collections.abc import Callable
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

import pytest

import ptmcad

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ptmcad"

FLINT_POLYNOMIALS = ("poly", "mpoly", "mpoly_ctx", "mpoly_vec", "series")


def test_the_contracts_hold(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from importlinter.cli import lint_imports

    monkeypatch.setattr(sys, "path", sys.path.copy())  # which it changes
    status = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert status == 0, capsys.readouterr().out


def test_no_circle_among_modules() -> None:
    """Not even one that an import inside of a function hides; a package's own `__init__` is a
    module like others.
    """
    import grimp

    graph = grimp.build_graph("ptmcad", cache_dir=None, exclude_type_checking_imports=True)
    TopologicalSorter(
        {m: graph.find_modules_directly_imported_by(m) for m in graph.modules}
    ).prepare()


def test_flints_polynomials_stay_in_algebra() -> None:
    """In the checks, which must not use it, in eliminations by hand, in one module for common
    divisors, and in one that writes derivatives out: all else speaks of curves, cells and counts.
    """
    studies = PACKAGE / "studies"
    rooms = [
        PACKAGE / "algebra",
        PACKAGE / "verification",
        studies / "stress",
        studies / "paper" / "critical.py",
    ]
    rooms += [PACKAGE / "certified" / "plain" / "divisors.py", studies / "moments.py"]
    for path in PACKAGE.rglob("*.py"):
        text, used = path.read_text(encoding="utf-8"), set[str]()
        for node in ast.walk(ast.parse(text if "flint" in text else "")):
            if (
                isinstance(node, ast.ImportFrom)
                and (node.module or "").partition(".")[0] == "flint"
            ):
                used |= {alias.name for alias in node.names}
            elif (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id == "flint"
            ):
                used.add(node.attr)
        if not any(path.is_relative_to(room) for room in rooms):
            assert not [name for name in used if name.endswith(FLINT_POLYNOMIALS)], path


def answers() -> dict[str, type]:
    """The classes of answers by name."""
    names = [module.name for module in pkgutil.iter_modules([str(PACKAGE / "answer")])]
    modules = [importlib.import_module(f"ptmcad.answer.{name}") for name in names]
    return {n: k for m in modules for n, k in vars(m).items() if isinstance(k, type)}


@pytest.mark.parametrize("name", sorted(ptmcad.methods.METHODS))
def test_answers_have_the_methods_that_they_declare(name: str) -> None:
    """`ptmcad.methods` binds what type checkers read in the classes: the same names with the same
    signatures, but for options that only the function itself has.
    """
    methods = ptmcad.methods.METHODS[name]
    answer = answers()[name]
    tree = ast.parse(Path(inspect.getfile(answer)).read_text(encoding="utf-8"))
    (body,) = (n.body for n in tree.body if isinstance(n, ast.ClassDef) and n.name == name)
    stubs = [s for n in body if isinstance(n, ast.If) for s in n.body]
    declared = {n.name: n.args for n in stubs if isinstance(n, ast.FunctionDef)}
    assert declared.keys() <= methods.keys()
    assert {name for name in methods if not name.startswith("_repr_")} <= declared.keys()
    for method in methods:
        bound: Callable[..., Any] = getattr(answer, method)
        assert callable(bound)
    for method, arguments in declared.items():
        own = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs][1:]
        real = list(inspect.signature(getattr(answer, method)).parameters.values())
        real = real[method != "from_json" :]
        assert [p.name for p in real if p.kind is not p.VAR_KEYWORD][: len(own)] == [
            a.arg for a in own
        ], f"{name}.{method}"
        assert all(p.default is not p.empty for p in real[len(own) :] if p.kind is p.KEYWORD_ONLY)


def test_an_unpickled_answer_has_its_methods(tmp_path: Path) -> None:
    """Also in a process that has imported nothing of ptmcad before."""
    (tmp_path / "map").write_bytes(
        pickle.dumps(ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")))
    )
    loaded_after(
        "import pickle; print(pickle.load(open('map', 'rb')).locate(L2='3/2', rho=1).stable)",
        tmp_path,
    )


def loaded_after(code: str, tmp_path: Path) -> set[str]:
    """Every module loaded by a fresh interpreter that has run the code, and the packages that hold
    it.
    """
    report = "import json, sys; print('\\n' + json.dumps(sorted(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{report}"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_verification_loads_nothing_of_the_engine(tmp_path: Path) -> None:
    """Not even through another module."""
    loaded = loaded_after("import ptmcad; ptmcad.verify", tmp_path)
    assert not loaded & {
        f"ptmcad.{room}" for room in ("algebra", "exact", "certified", "ask", "show")
    }


def test_the_fork_comes_before_everything_large(tmp_path: Path) -> None:
    """Handlers are set and the process is forked while little is loaded: a copy of little costs
    little.
    """
    loaded = loaded_after("import ptmcad.__main__, ptmcad.process.supervisor", tmp_path)
    assert not loaded & {"click", "yaml", "flint", "numpy", "dataclasses", "pathlib", "subprocess"}


def test_the_report_does_without_matplotlib(tmp_path: Path) -> None:
    """Outlines and colours are all that it takes from the pictures."""
    assert not loaded_after("import ptmcad.show.report", tmp_path) & {"matplotlib", "sympy"}


def test_reading_poses_loads_nothing_of_the_engine(tmp_path: Path) -> None:
    """Enclosures, poses, their document and table are free of any engine."""
    code = "import ptmcad, ptmcad.show.document.posedocument, ptmcad.show.posetable; ptmcad.Poses, ptmcad.Enclosure"
    assert not loaded_after(code, tmp_path) & {"flint", "yaml", "numpy", "matplotlib", "sympy"}


def test_solving_needs_no_picture_or_symbolic_library(tmp_path: Path) -> None:
    code = "import ptmcad; ptmcad.solve(rho='7/10', F3=-10).to_json()"
    loaded = loaded_after(code, tmp_path)
    assert "flint" in loaded
    assert not loaded & {"matplotlib", "sympy", "numpy"}


def test_the_command_line_starts_lean(tmp_path: Path) -> None:
    """``ptmcad --help`` must not wait for a computing or drawing library."""
    assert not loaded_after("import ptmcad.cli", tmp_path) & {
        "matplotlib",
        "sympy",
        "numpy",
        "flint",
    }


def test_json_needs_no_picture_or_symbolic_library(tmp_path: Path) -> None:
    """A whole classification to JSON loads neither matplotlib nor sympy nor numpy nor numba."""
    record = str(ROOT / "configs" / "fig4.yaml")
    code = (
        "import sys\n"
        "from ptmcad.cli import run\n"
        f"sys.argv = ['ptmcad', 'classify', {record!r}, '--format', 'json', '--out', '.']\n"
        "assert run() == 0\n"
    )
    loaded = loaded_after(code, tmp_path)
    assert "flint" in loaded
    assert not loaded & {"matplotlib", "sympy", "numpy", "numba"}
    assert (tmp_path / "fig4.json").exists()
