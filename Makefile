# The front door. `make demo` and `make test` set up all they need; a second run repeats nothing.
.DEFAULT_GOAL := help
.PHONY: help packages build program demo test accuracy accuracy-long bench fuzz format lint clean

PROGRAM := build/release/bin/goldthread
FUZZ_SECONDS ?= 60
CXX_FILES = $(shell git ls-files --cached --others --exclude-standard '*.cpp' '*.h')

help:
	@echo 'make demo     build, bake a scene and leave a lit GLB and a picture in out/'
	@echo 'make test     build and run all tests'
	@echo 'make accuracy exact cases through every method, as a table in out/accuracy/'
	@echo 'make accuracy-long  the path tracer alone, a hundred million paths a scene'
	@echo 'make bench    build and run the benchmarks'
	@echo 'make fuzz     run each fuzzer for FUZZ_SECONDS (60)'
	@echo 'make format   lay out the sources with clang-format'
	@echo 'make lint     clang-format and clang-tidy, as a check'
	@echo 'make clean    remove build/ and out/'

packages:
	@tools/install_packages.sh

# Ninja configures again by itself when a CMake file changes.
build/release/build.ninja: | packages
	cmake --preset release

build: build/release/build.ninja
	@cmake --build --preset release

program: build/release/build.ninja
	@cmake --build --preset release --target goldthread

out/cornell-box.glb: program
	@mkdir -p out
	@test -f $@ -a ! $(PROGRAM) -nt $@ || $(PROGRAM) make cornell-box -o $@

demo: out/cornell-box.glb
	@test -f out/cornell-box-lit.glb -a -f out/cornell-box-lit.png \
	      -a ! $(PROGRAM) -nt out/cornell-box-lit.png -a ! $< -nt out/cornell-box-lit.png \
	  || $(PROGRAM) bake $< -o out/cornell-box-lit.glb -o out/cornell-box-lit.png
	@echo 'lit scene: out/cornell-box-lit.glb'
	@echo 'picture:   out/cornell-box-lit.png'

# The Khronos glTF validator, for the tests that write scenes.
tools/node_modules/.package-lock.json: tools/package.json tools/package-lock.json | packages
	cd tools && npm ci --no-audit --no-fund
	@touch $@

test: build tools/node_modules/.package-lock.json
	tools/check_layers.py
	ctest --test-dir build/release --output-on-failure -j2

accuracy: program
	python3 tools/accuracy

# The path tracer alone, a hundred million paths a scene: from minutes on many cores to an hour on two.
accuracy-long: program
	python3 tools/accuracy --long

bench: build
	@for program in build/release/bin/*_bench; do echo "== $$(basename $$program)"; $$program || exit 1; done

fuzz: | packages
	cmake --preset fuzz
	cmake --build --preset fuzz
	@mkdir -p out/fuzz
	@for program in build/fuzz/bin/fuzz_*; do \
	  name=$$(basename $$program); echo "== $$name"; mkdir -p out/fuzz/$$name; \
	  $$program -max_total_time=$(FUZZ_SECONDS) -timeout=25 -rss_limit_mb=2048 \
	    -artifact_prefix=out/fuzz/$$name- out/fuzz/$$name || exit 1; \
	done

format: | packages
	@clang-format -i $(CXX_FILES)

# A build folder of its own: clang-tidy cannot read another compiler's precompiled headers.
lint: | packages
	@clang-format --dry-run --Werror $(CXX_FILES)
	@cmake -S . -B build/lint -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
	  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DGOLDTHREAD_BENCHMARKS=OFF >/dev/null
	@run-clang-tidy -quiet -p build/lint '/(src|apps)/.*\.cpp$$'

clean:
	rm -rf build out
