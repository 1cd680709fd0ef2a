# The commands of the project; `make` alone lists them. Packages that are missing are installed first (packages.txt).

.DEFAULT_GOAL := help
JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
# Share of the random cases that the tests run: 1 is the everyday number.
SANITIZE_SCALE ?= 0.02
LONG_SCALE ?= 50

INSTALL := scripts/install-packages
# Sources are compiled a dozen at a time, which halves the time from nothing; OFF to compile little after a change.
UNITY ?= ON
CONFIGURE = cmake -DSELVAGE_WARNINGS_AS_ERRORS=$(if $(CI),ON,OFF) --log-level=WARNING \
            -DCMAKE_UNITY_BUILD=$(UNITY) -DCMAKE_UNITY_BUILD_BATCH_SIZE=12 -DSELVAGE_TEST_PARTS=$(if $(CI),12)
BUILD = cmake --build -j $(JOBS) --preset
CTEST = ctest -j $(JOBS) --output-on-failure --no-tests=error --progress
empty :=
LABELS = ^($(subst $(empty) $(empty),|,$(strip $(FLOORS))))$$
SOURCES = $(shell git ls-files '*.h' '*.cpp')

## demo        build, then find the ways out of a tangled octopus and a self-crossing noodle; see demo-output/
demo: cli
	scripts/demo build/release demo-output

## cli         build the library and the command-line tool
cli:
	$(INSTALL) build
	$(CONFIGURE) --preset release -DSELVAGE_BUILD_TESTS=OFF
	$(BUILD) release

## test        build, then run all tests, those of Python too, and try a wheel in a fresh environment
test: build-tests
	$(CTEST) --preset release
	$(MAKE) test-python
	$(MAKE) wheel

# The environment of the Python package; its packages come from PyPI.
VENV := build/venv
PYTHON ?= python3

$(VENV)/installed: python/requirements.txt
	$(INSTALL) build python
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/pip install -q --disable-pip-version-check -r $<
	touch $@

## python      build the Python package in build/release/python, in an environment of its own in build/venv
python: $(VENV)/installed
	$(CONFIGURE) --preset release -DSELVAGE_BUILD_PYTHON=ON -DPython_EXECUTABLE=$(CURDIR)/$(VENV)/bin/python
	$(BUILD) release --target selvage_python_stub selvage_cli

## test-python the tests of the Python package alone
test-python: python
	PYTHONPATH=$(CURDIR)/build/release/python $(VENV)/bin/python -m pytest -q tests/python

## wheel       a wheel in build/wheels that installs anywhere, tried in an environment that has nothing else
wheel: python
	python/make-wheel $(VENV) build/wheels

## try-wheel   the wheel in build/wheels in a bare Debian 12; as root, needs debootstrap and the internet, so not in CI
try-wheel:
	python/try-wheel $$(ls -t build/wheels/*.whl | head -n 1)

## test-long   the same tests with 50 times as many random cases: hours
test-long: build-tests
	SELVAGE_TEST_SCALE=$(LONG_SCALE) $(CTEST) --preset release --timeout 36000 --verbose

build-tests:
	$(INSTALL) build test
	$(CONFIGURE) --preset release -DSELVAGE_BUILD_TESTS=ON
	$(BUILD) release

# In Firefox too, where firefox-esr and xvfb are installed.
## test-viewer the tests of the page that `selvage view` writes, in Chromium; needs Node (npm), installed if missing
test-viewer: cli
	command -v npm >/dev/null || $(INSTALL) node
	$(INSTALL) viewer
	cd viewer && npm ci --no-audit --no-fund --loglevel=error
	cd viewer && npx tsc --noEmit && npm test && \
	  SELVAGE=$(CURDIR)/build/release/selvage $$(command -v xvfb-run >/dev/null && echo xvfb-run -a) npm run test:page

## sanitize    the tests under the address, undefined-behaviour and thread sanitizers, with fewer random cases
sanitize: sanitize-memory sanitize-threads

# FLOORS="bvh mesh": the tests of these floors alone.
sanitize-memory: FLOORS ?= core geometry mesh bvh io shapes boundary_path self_collision surface_distance contact \
                           elasticity simulation untangling scene picture page export cli
sanitize-memory:
	$(INSTALL) build test sanitize
	$(CONFIGURE) --preset asan
	$(BUILD) asan --target $(addprefix test_,$(FLOORS))
	SELVAGE_TEST_SCALE=$(SANITIZE_SCALE) $(CTEST) --preset asan -L '$(LABELS)'

# Only what runs in parallel.
sanitize-threads: FLOORS ?= core mesh bvh io shapes boundary_path self_collision surface_distance contact simulation \
                            untangling scene
sanitize-threads:
	$(INSTALL) build test
	$(CONFIGURE) --preset tsan
	$(BUILD) tsan --target $(addprefix test_,$(FLOORS))
	SELVAGE_TEST_SCALE=$(SANITIZE_SCALE) $(CTEST) --preset tsan -L '$(LABELS)'

## fuzz        feed every mesh reader with broken files for FUZZ_SECONDS each (10)
fuzz:
	$(INSTALL) build test sanitize
	fuzz/run.sh $(or $(FUZZ_SECONDS),10)

## bench       measure the library against its peers, on Embree and CGAL
bench:
	$(INSTALL) build test bench
	$(CONFIGURE) --preset benchmark
	$(BUILD) benchmark
	benchmarks/run.sh build/benchmark

# That all benchmarks still compile, without the time to make code of them: `make bench` alone builds them.
check-benchmarks: SYNTAX := build/benchmark-syntax
check-benchmarks:
	$(INSTALL) build bench
	$(CONFIGURE) --preset benchmark -B $(SYNTAX) -DSELVAGE_BUILD_TESTS=OFF -DSELVAGE_BUILD_CLI=OFF
	ninja -C $(SYNTAX) -t commands selvage_bench selvage_microbench | \
	  sed -n 's/ -MD .* \(-c [^ ]*\/benchmarks\/\)/ -fsyntax-only \1/p' >$(SYNTAX)/commands
	grep -q fsyntax-only $(SYNTAX)/commands
	xargs -d '\n' -n 1 -P $(JOBS) sh -c <$(SYNTAX)/commands

## docs        the site of the documentation, in build/site; a warning is an error
# The program, the package and the headers say what the reference holds.
docs: python
	$(INSTALL) docs
	doxygen docs/Doxyfile
	$(VENV)/bin/python -m sphinx -b html -W --keep-going -q docs build/site

## docs-links  ask for every external link of the docs whether it still leads somewhere; needs the internet, so not in CI
docs-links: python
	$(INSTALL) docs
	doxygen docs/Doxyfile
	$(VENV)/bin/python -m sphinx -b linkcheck --keep-going -q docs build/links; code=$$?; \
	  grep -v -e '\[unchecked\]' -e '\[ok\]' build/links/output.txt; exit $$code

## format      lay out all sources by .clang-format
format:
	$(INSTALL) lint
	@clang-format -i $(SOURCES)

check-format:
	$(INSTALL) lint
	@clang-format --dry-run -Werror $(SOURCES)

## lint        clang-tidy over all sources
# Source by source, as they stand: clang-tidy cannot read what GCC precompiled. Nothing is built.
lint: UNITY = OFF
lint:
	$(INSTALL) build test bench lint
	$(CONFIGURE) --preset benchmark -B build/lint -DSELVAGE_BUILD_TESTS=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
	run-clang-tidy -quiet -j $(JOBS) -p build/lint '/(src|tests|benchmarks)/'

## install     install the library and the tool under PREFIX (/usr/local)
install: cli
	cmake --install build/release --prefix $(PREFIX)

## clean       remove everything that was built
clean:
	rm -rf build demo-output docs/api

help:
	@sed -n 's/^## /make /p' $(MAKEFILE_LIST)

.PHONY: demo cli test python test-python wheel try-wheel test-long test-viewer build-tests sanitize sanitize-memory sanitize-threads fuzz bench check-benchmarks docs docs-links \
        format check-format lint install clean help
