# Two commands: `make demo` and `make test`. Each makes its own .venv and installs what it needs.

PYTHON ?= python3
BIN := .venv/bin

.PHONY: demo test lint bench clean

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Lipwright needs Python 3.11 or newer; name it with: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip

.venv/.installed: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	$(BIN)/python -m compileall -q src
	@touch $@

.venv/.tested: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	$(BIN)/python -m compileall -q src
	@touch $@ .venv/.installed

# What tests read exported files with in the browser; without npm those tests skip.
tests/web/node_modules/.installed: tests/web/package-lock.json
	@if command -v npm >/dev/null; then npm ci --silent --prefix tests/web && touch $@; \
	  else echo "npm is missing: tests that read files with three.js skip"; fi

# What the Blender add-on is tested with: it wants this Python and an older numpy, so it gets an
# environment of its own. Without it those tests skip.
.venv-bpy/.installed: | .venv/bin/python
	@if $(BIN)/python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' \
	  && $(BIN)/python -m venv .venv-bpy \
	  && .venv-bpy/bin/python -m pip install --quiet --disable-pip-version-check 'bpy==5.0.1'; \
	then touch $@; else rm -rf .venv-bpy; echo "bpy is missing: tests of the Blender add-on skip"; fi

# A recording and its words become a video, an animated head and a table of curves.
demo: .venv/.installed
	$(BIN)/lipwright head install --if-missing
	@mkdir -p demo
	$(BIN)/lipwright animate examples/hello.flac --text examples/hello.txt \
	  -o demo/hello.mp4 -o demo/hello.glb -o demo/hello.csv
	@ls -l demo

test: .venv/.tested tests/web/node_modules/.installed .venv-bpy/.installed
	$(BIN)/lipwright head install --if-missing
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest

lint: .venv/.tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: .venv/.tested
	$(BIN)/python bench/alignment.py
	$(BIN)/python bench/lips.py
	$(BIN)/python bench/speed.py

clean:
	rm -rf .venv .venv-bpy tests/web/node_modules demo .pytest_cache .ruff_cache .mypy_cache .hypothesis
