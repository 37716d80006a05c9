# Two commands on a fresh machine: `make run` and `make test`. PYTHON chooses the interpreter (3.11 or newer).
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= results

.PHONY: run test test-slow lint picture clean

run: $(VENV)/.installed
	$(BIN)/mala-drake run --out $(OUT) --html $(OUT)/recording.html

test: $(VENV)/.tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -n 2 --dist worksteal

# Exhaustive checks: every leg of the ward, twenty episodes, larger planning tasks.
test-slow: $(VENV)/.tested
	$(BIN)/python -m pytest -m slow -n 2 --dist worksteal --timeout 3600

picture: $(VENV)/.installed
	$(BIN)/python scripts/render_ward.py

$(VENV)/.installed: pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e . -c constraints.txt
	touch $@

$(VENV)/.tested: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[test]" -c constraints.txt
	touch $@

clean:
	rm -rf $(VENV) $(OUT) .pytest_cache .mypy_cache .ruff_cache .hypothesis
