# Everything runs in the virtual environment .venv, which these targets create and fill themselves:
# all they need is python3 (3.11 or newer) and make.

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet install
JOBS ?= 2
# the paper's loaded slices, on which every method is measured
PAPER := fig3 fig4 fig5-caption fig5-text
SYSTEMS := fig2 fig4 stiffness systems/cubic systems/orthogonal-3r systems/kuramoto systems/kuramoto-4 \
	mechanisms/x-joint mechanisms/two-bar-chain mechanisms/two-dof-tensegrity mechanisms/four-bar mechanisms/five-bar

# where this is set, each of the hundreds of processes that the tests start would compile all sources again
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo test test-slow test-oldest fuzz check bench ablation systems scaling stress docs free-maps clean distclean

help:
	@echo "make demo       the map of the paper's fig. 4, as out/fig4.png and out/fig4.svg"
	@echo "make test       the fast tests"
	@echo "make test-slow  the thorough tests"
	@echo "make test-oldest  the fast tests with the oldest versions of all packages that pyproject.toml states"
	@echo "make fuzz       damaged and hostile records, results and points by the ten thousand, guided by coverage"
	@echo "make check      ruff, its formatter, what may import what, and mypy in strict mode, on the tests less so"
	@echo "make bench      error, run time and memory on every slice in configs/, into docs/benchmarks/: ten minutes"
	@echo "make ablation   what each saving is worth, into docs/benchmarks/: nine minutes"
	@echo "make systems    twelve systems compared with msolve, Singular, QEPCAD and gcad, into out/systems/: a quarter of an hour"
	@echo "make scaling    how time and memory grow, into docs/benchmarks/: three minutes"
	@echo "make stress     stiff and extreme cases against double precision, into docs/benchmarks/: some minutes"
	@echo "make docs       the manual, as out/docs/html/index.html, and the pictures of fig. 4, into docs/img/"
	@echo "make free-maps  the manual's maps of springs with free lengths, into docs/img/: some minutes each"
	@echo "make clean      removes what the targets made, except the environment"
	@echo "make distclean  removes the environment too"

# The extras are those that the README's commands need. The certified engine is compiled by what first asks for it.
# The stamps make a new set-up follow every change of pyproject.toml, and nothing else.
# A stamp is touched last, so an interrupted set-up is begun again.
$(VENV)/.installed: pyproject.toml scripts/setup-venv
	scripts/setup-venv $(VENV)
	$(PIP) --editable '.[certified,design,explore]'
	@touch $@

# A real cluster of Dask's is for one slow test: not worth its fifteen packages in every environment.
$(VENV)/.installed-slow: $(VENV)/.installed-test
	$(PIP) --editable '.[test,distributed]'
	@touch $@

$(VENV)/.installed-test: $(VENV)/.installed
	$(PIP) --editable '.[test]'
	@touch $@

# atheris has wheels for some systems and versions of Python only; without it the campaign says so and goes on.
$(VENV)/.installed-fuzz: $(VENV)/.installed-test
	$(PIP) --only-binary atheris --editable '.[test,fuzz]' || echo "atheris cannot be installed here, see above"
	@touch $@

$(VENV)/.installed-check: $(VENV)/.installed-test
	$(PIP) --editable '.[test,check]'
	@touch $@

# The oldest versions that pyproject.toml states, on the oldest Python that it does where that is installed: a version's
# wheels are for the Pythons of its time.
OLDEST := .venv-oldest
OLDEST_PYTHON := $(or $(shell command -v python3.11),python3)

$(OLDEST)/.installed: pyproject.toml scripts/setup-venv scripts/oldest-versions
	PYTHON=$(OLDEST_PYTHON) scripts/setup-venv $(OLDEST)
	$(OLDEST)/bin/python scripts/oldest-versions > $(OLDEST)/constraints.txt
	$(OLDEST)/bin/python -m pip --disable-pip-version-check --quiet install --constraint $(OLDEST)/constraints.txt \
		--editable '.[test]'
	@touch $@

$(VENV)/.installed-docs: $(VENV)/.installed
	$(PIP) --editable '.[docs]'
	@touch $@

demo: $(VENV)/.installed
	$(BIN)/ptmcad classify fig4 --format json,png,svg --out out

# Tests of one module read the same maps: each process takes them in a row, and from the other's rest when it has none.
# One process more than there are jobs: some tests wait for a browser or for a process to end.
test: $(VENV)/.installed-test
	$(BIN)/python -m pytest --numprocesses $$(($(JOBS) + 1)) --dist worksteal

# The slow tests, and those of the fast ones that draw examples, with all of their examples.
test-slow: $(VENV)/.installed-slow
	$(BIN)/python -m pytest --numprocesses $(JOBS) -m 'slow or hypothesis' --hypothesis-profile thorough

test-oldest: $(OLDEST)/.installed
	$(OLDEST)/bin/python -m pytest --numprocesses $(JOBS)

fuzz: $(VENV)/.installed-fuzz
	PYTHONPATH=tests $(BIN)/python -m fuzz --folder out/fuzz $(FUZZ)

check: $(VENV)/.installed-check
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/lint-imports --no-cache
	$(BIN)/python -m mypy
	cd tests && ../$(BIN)/python -m mypy --config-file mypy.ini .

$(VENV)/.installed-bench: $(VENV)/.installed
	$(PIP) --editable '.[bench]'
	$(PIP) gcad || echo "gcad cannot be installed here, see above: it is left out"
	@touch $@

bench: $(VENV)/.installed-bench
	$(BIN)/python -m ptmcad.studies.bench times --out docs/benchmarks
	$(BIN)/ptmcad bench $(PAPER:%=configs/%.yaml) --time-limit 36 --out out/bench
	$(BIN)/ptmcad bench $(filter-out $(PAPER:%=configs/%.yaml),$(wildcard configs/*.yaml)) --quick --rounds 1 --time-limit 5 \
		--method exact --method certified --method companion --page --out out/bench
	cp out/bench/*.bench.json out/bench/fig4.bench.svg out/bench/fig5-caption.bench.svg docs/benchmarks

ablation: $(VENV)/.installed-bench
	$(BIN)/python -m ptmcad.studies.bench ablation --out docs/benchmarks

systems: $(VENV)/.installed-bench
	$(BIN)/ptmcad bench $(SYSTEMS:%=configs/%.yaml) --quick --page --out out/systems \
		--method exact --method msolve --method singular --method qepcad --method gcad

scaling: $(VENV)/.installed-bench
	$(BIN)/python -m ptmcad.studies.bench scaling --out docs/benchmarks

stress: $(VENV)/.installed
	$(BIN)/ptmcad stress all --random 25 --format table,json,png --out docs/benchmarks

docs: $(VENV)/.installed-docs
	$(BIN)/ptmcad classify configs/fig4.yaml --format png --out docs/img
	$(BIN)/ptmcad classify configs/families/equal-loads.yaml --surface --no-areas --format png --out out/docs
	cp out/docs/equal-loads-3d.png docs/img
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet -b html -d out/docs/doctrees docs out/docs/html
	@echo "the manual is out/docs/html/index.html"

free-maps: $(VENV)/.installed-test
	$(BIN)/python scripts/free-maps

clean:
	rm -rf out build dist docs/generated .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -type d -not -path './$(VENV)*/*' -prune -exec rm -rf {} +

distclean: clean
	rm -rf $(VENV) $(OLDEST)
