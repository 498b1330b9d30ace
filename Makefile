# Few targets on purpose; each is one command that can be typed by hand.
PYTHON := .venv/bin/python

.venv: pyproject.toml
	python3 -m venv .venv && .venv/bin/pip install -q -e '.[dev]'
	touch .venv

quick: .venv  ## a judge for every room
	$(PYTHON) -m pytest -m "not thorough and not slow"

test: .venv  ## quick and thorough tests
	$(PYTHON) -m pytest

slow: .venv  ## the tests that take longer
	$(PYTHON) -m pytest -m slow

mutants: .venv  ## break lines of each room's mathematics, one at a time, and write benchmarks/mutants.md; 40 minutes
	PYTHONPATH=tests $(PYTHON) -m mutants

fuzz: .venv  ## ten times as many random designs and formulas as the slow tests have
	NCGEAR_FUZZ=10 $(PYTHON) -m pytest -m slow tests/test_random_designs.py tests/test_formula.py tests/test_proven.py

attack: .venv  ## faults of the disk and death at every call, kills, generated designs and formulas, ten times as many
	NCGEAR_FUZZ=$${NCGEAR_FUZZ:-10} $(PYTHON) -m pytest -m attack

lint: .venv  ## style, formatting, types
	.venv/bin/ruff check . && .venv/bin/ruff format --check . && .venv/bin/mypy

bench: .venv  ## measure speed against error, how long builds take, and more; write docs/speed-against-error.md, benchmarks/*.md
	PYTHONPATH=benchmarks $(PYTHON) -m speed_against_error.run --out docs
	$(PYTHON) benchmarks/timing.py
	$(PYTHON) benchmarks/first_gears.py
	$(PYTHON) benchmarks/equivalent_gear.py
	$(PYTHON) benchmarks/limit.py
	$(PYTHON) benchmarks/makeable.py
	$(PYTHON) benchmarks/knocks.py
	$(PYTHON) benchmarks/loads_as_they_are.py
	$(PYTHON) benchmarks/law_to_limit.py
	$(PYTHON) benchmarks/baler_real.py
	$(PYTHON) benchmarks/screening.py
	$(PYTHON) benchmarks/sweeping.py
	$(PYTHON) benchmarks/starts.py
	$(PYTHON) benchmarks/heaviest_steps.py

beside: .venv  ## measure beside the other program of the field and write benchmarks/beside-ncgears.md
	.venv/bin/pip install -q -e '.[bench]'
	$(PYTHON) benchmarks/beside_ncgears.py

docs: .venv  ## make the pictures, the heads of command pages, the pages of keys, the hard cases and the reproduction ledger anew
	PYTHONPATH=docs $(PYTHON) -m made pictures
	PYTHONPATH=tests $(PYTHON) -m hard.table
	.venv/bin/ncgear reproduce && cp export/reproduction/reproduction.md docs/

site: .venv  ## the documentation as a site with search, export/site/README.html, from the same pages; needs no network
	$(PYTHON) -m sphinx -q -W --keep-going -n -b html -c docs/site . export/site

.PHONY: quick test slow mutants fuzz attack lint bench beside docs site
