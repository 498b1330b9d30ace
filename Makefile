# Few targets on purpose; each is one command that can be typed by hand.
PYTHON := .venv/bin/python

.venv: pyproject.toml
	python3 -m venv .venv && .venv/bin/pip install -q -e '.[dev]'
	touch .venv

test: .venv  ## quick tests, under four minutes on two cores
	$(PYTHON) -m pytest

slow: .venv  ## the tests that take longer
	$(PYTHON) -m pytest -m slow

lint: .venv  ## style, formatting, types
	.venv/bin/ruff check . && .venv/bin/ruff format --check . && .venv/bin/mypy

bench: .venv  ## measure how long builds take, and equivalent gears beside exact teeth, the limit; write benchmarks/*.md
	$(PYTHON) benchmarks/timing.py
	$(PYTHON) benchmarks/equivalent_gear.py
	$(PYTHON) benchmarks/limit.py
	$(PYTHON) benchmarks/makeable.py

beside: .venv  ## measure beside the other program of the field and write benchmarks/beside-ncgears.md
	.venv/bin/pip install -q -e '.[bench]'
	$(PYTHON) benchmarks/beside_ncgears.py

docs: .venv  ## make the pictures of the README and the reproduction ledger anew
	.venv/bin/ncgear build designs/baler-86.yaml
	cp export/baler-86/tooth_pair.png docs/images/baler-86-tooth-pair.png
	.venv/bin/ncgear frontier designs/baler-frontier.yaml
	cp export/baler-frontier-frontier/frontier.png docs/images/baler-frontier.png
	.venv/bin/ncgear reproduce --out docs

.PHONY: test slow lint bench beside docs
