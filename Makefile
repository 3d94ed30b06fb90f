# make demo    sets up what is missing, then cuts AISI 4340
# make test    sets up what is missing, then runs the tests
.DEFAULT_GOAL := help
.PHONY: help setup demo test test-debian13 test-wheels test-container validate bench docs lint clean
.NOTPARALLEL:

# Another active environment, or packages in the user's home, must not mix with Debian's.
unexport VIRTUAL_ENV PYTHONHOME PYTHONPATH
export PYTHONNOUSERSITE := 1

PYTHON := .venv/bin/python
READY := .venv/.ready
DEMO := demos/aisi4340_demo/case.toml
DEMO_OUT := out/demo
# Published cases and studies that `make validate` runs at a time.
JOBS := 2

help:
	@echo "make setup     install what is missing (Debian packages as root) and make .venv"
	@echo "make demo      cut AISI 4340 with a rigid tool; results in $(DEMO_OUT)"
	@echo "make test      fast tests"
	@echo "make test-debian13, test-wheels, test-container"
	@echo "               fast tests (a cut) in roots of Debian 13 that debootstrap makes in out/elsewhere; as root"
	@echo "make validate  slow tests, published cases and studies (hours; goes on where interrupted)"
	@echo "make bench     timings"
	@echo "make docs      the documentation as a site in out/site"
	@echo "make lint      ruff and mypy"
	@echo "make clean     remove results and caches"

setup: $(READY)

$(READY): pyproject.toml scripts/setup.sh
	@rm -f $@
	scripts/setup.sh
	@touch $@

demo: $(READY)
	$(PYTHON) -m pfemcut run $(DEMO) -o $(DEMO_OUT) --overwrite
	@echo "fields   $(DEMO_OUT)/fields.pvd (ParaView)"
	@echo "figures  $(DEMO_OUT)/figures/"
	@echo "report   $(DEMO_OUT)/report.html"

# One BLAS thread: tests compare bit for bit, and small matrices gain nothing from more; on a busy machine threads that
# wait for each other are many times slower.
demo test validate bench docs: export OMP_NUM_THREADS := 1

test: $(READY)
	$(PYTHON) -m pytest -q -m "not slow" tests

# With Debian 13's packages, with dolfinx as a wheel, and the steps of the Containerfile. Gigabytes; kept for next time.
test-debian13 test-wheels test-container: test-%:
	/usr/bin/python3 scripts/elsewhere.py $*

validate: $(READY)
	$(PYTHON) -m pytest -q -m slow tests || [ $$? -eq 5 ] # 5: there are none
	$(PYTHON) scripts/validate.py -j $(JOBS)

bench: $(READY)
	@set -e; for script in step_time scaling seconds_per_mm particle_rates lattice_speed; do echo "== $$script"; $(PYTHON) benchmarks/$$script.py; done

# Any warning, such as a link that leads nowhere, stops it.
docs: $(READY)
	$(PYTHON) -m pip install --quiet --disable-pip-version-check --constraint .venv/constraints.txt --editable '.[docs]'
	$(PYTHON) -m sphinx -q -W --keep-going -c docs . out/site
	@echo "site     out/site/index.html"

lint: $(READY)
	$(PYTHON) -m ruff check .
	$(PYTHON) -m ruff format --check .
	$(PYTHON) -m mypy

clean:
	rm -rf out build demos/*/out *.egg-info .pytest_cache .hypothesis .ruff_cache .mypy_cache
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
