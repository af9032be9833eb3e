# treeline: two commands are all a user needs, `make bench` and `make check`.
#
#   make                 builds ./treeline            config=release|debug|sanitize|thread  CC=gcc|clang
#   make bench           installs what is missing, builds, runs the quick benchmark, writes the report
#   make check           every test: units, command line, architecture, gcc and clang, sanitizers, EGL alone
#   make test            the unit tests of one configuration; make test T="test_gl test_base" for some
#   make new-method NAME=x             a method that works, with its test, to begin from
#   make fuzz            libFuzzer on every loader, an hour in all; make fuzz FUZZ_SECONDS=60 T="scene mesh" for less
#   make install PREFIX= DESTDIR=      make docs      make format      make lint      make clean
#   gl=auto|egl|osmesa   which GL back ends to build in; auto takes those that pkg-config finds

SHELL := /bin/bash
config ?= release
gl ?= auto
PREFIX ?= /usr/local
ifeq ($(origin CC),default)
CC := gcc
endif
CXX := $(if $(findstring clang,$(CC)),clang++,g++)

# Objects are the same whichever GL back ends are built in; what is linked of them has a folder of its own.
OBJ := build/$(config)-$(notdir $(firstword $(CC)))
BUILD := $(OBJ)$(if $(filter-out auto,$(gl)),-$(gl))
GEN := $(OBJ)/gen

# What the wall needs, found by pkg-config where it knows it.
PKG := libcjson libxxhash assimp
has = $(shell pkg-config --exists $(1) 2>/dev/null && echo yes)
GL_OSMESA := $(if $(filter auto osmesa,$(gl)),$(call has,osmesa))
GL_EGL := $(if $(filter auto egl,$(gl)),$(call has,egl))
# The back ends open their libraries at run time: only their headers are needed to build.
PKG_HEADERS := $(PKG) cglm $(if $(GL_OSMESA),osmesa) $(if $(GL_EGL),egl)
EMBREE := $(if $(wildcard /usr/include/embree4/rtcore.h),4,3)

WARN := -Wall -Wextra -Wpedantic -Wshadow -Werror
MODE_release := -O3 -g
MODE_debug := -O0 -g
# Without the checks of what the address sanitizer finds as well: they take half the time to compile and to run.
MODE_sanitize := -O1 -g -fsanitize=address,undefined -fno-sanitize=null,object-size,pointer-overflow \
    -fno-sanitize-recover=undefined -fno-omit-frame-pointer
MODE_thread := -O1 -g -fsanitize=thread -fno-omit-frame-pointer
MODE_fuzz := $(MODE_sanitize) -fsanitize=fuzzer-no-link
MODE := $(MODE_$(config))
ifeq ($(MODE),)
$(error config=$(config) is not one of release, debug, sanitize, thread, fuzz)
endif
# -ffp-contract=off: the same forest and the same picture from every compiler.
CFLAGS_ALL := -std=c11 -D_GNU_SOURCE $(WARN) $(MODE) -fPIC -fopenmp -ffp-contract=off -fno-math-errno \
    -fvisibility=default -MMD -MP -Iharness -I$(GEN) -DCGLM_ALL_UNALIGNED \
    -DTREELINE_FLAGS='"$(MODE)"' -DEMBREE_VERSION=$(EMBREE) \
    $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(PKG_HEADERS) 2>/dev/null)) $(CFLAGS)
CXXFLAGS_ALL := -std=c++17 $(WARN) $(MODE) -fPIC -Iharness \
    $(patsubst -I%,-isystem %,$(shell pkg-config --cflags OpenImageIO 2>/dev/null)) $(CXXFLAGS)
LIBS := $(shell pkg-config --libs $(PKG) 2>/dev/null) -lmeshoptimizer -lembree$(EMBREE) -ldl -lm -lpthread
LDFLAGS_ALL := $(MODE) -fopenmp -rdynamic $(LDFLAGS)

# Sources. A GL back end, or the lack of one, is a file.
WALL_SKIP := $(if $(GL_OSMESA),,harness/wall/gl_osmesa.c) $(if $(GL_EGL),,harness/wall/gl_egl.c)
# Kernels for a processor's own vectors: files of their own, with the flags that they need.
ARCHITECTURE := $(firstword $(subst -, ,$(shell $(CC) -dumpmachine)))
MARCH_SKIP := $(if $(filter x86_64,$(ARCHITECTURE)),harness/bake/march_isa_any.c harness/bake/cone_isa_any.c,$(addprefix harness/bake/,$(addprefix march_,isa_x86.c avx2.c avx512.c) cone_isa_x86.c cone_lanes_avx2.c))
# A build for some tests alone holds the rooms that these can reach.
ROOMS_thread := base wall stats plant scene truth
ROOMS_fuzz := $(ROOMS_thread) method plan results report
ROOMS := $(or $(ROOMS_$(config)),*)
SOURCES := $(filter-out $(WALL_SKIP) $(MARCH_SKIP) harness/cli/treeline.c,$(sort $(wildcard $(ROOMS:%=harness/%/*.c)))) \
    $(if $(filter *,$(ROOMS)),$(sort $(wildcard methods/*.c)))
GENERATED_C := $(GEN)/methods_builtin.c $(GEN)/gl_load.c $(BUILD)/gl_backends.c
GENERATED_H := $(GEN)/gl_functions.inc $(GEN)/build_facts.h \
    $(patsubst methods/%.glsl,$(GEN)/%.glsl.h,$(wildcard methods/*.glsl)) \
    $(patsubst harness/bake/%.glsl,$(GEN)/%.glsl.h,$(wildcard harness/bake/*.glsl)) \
    $(patsubst harness/calibrate/%.glsl,$(GEN)/%.glsl.h,$(wildcard harness/calibrate/*.glsl))
OBJECTS := $(SOURCES:%.c=$(OBJ)/%.o) $(GENERATED_C:%.c=%.o)
ARCHIVE := $(BUILD)/libtreeline.a
BINARY := $(BUILD)/treeline
IMAGE_SO := $(BUILD)/treeline_image.so
TESTS := $(patsubst tests/%.c,$(BUILD)/tests/%,$(sort $(wildcard tests/test_*.c)))

.PHONY: all plugins new-method bench check test install format lint clean packages
.DELETE_ON_ERROR:
.SECONDARY: $(GENERATED_C) $(GENERATED_H)

all: $(BINARY) $(IMAGE_SO)
	@ln -sfn $(BINARY) treeline

$(BINARY): $(OBJ)/harness/cli/treeline.o $(ARCHIVE)
	$(CC) $(LDFLAGS_ALL) -o $@ $< -Wl,--whole-archive $(ARCHIVE) -Wl,--no-whole-archive $(LIBS)

# The C programs that load the shim have no C++ half of the undefined-behaviour sanitizer.
SHIM_sanitize = -fno-sanitize=vptr$(if $(findstring clang,$(CC)),$(comma)function)
SHIM_fuzz = $(SHIM_sanitize)
$(IMAGE_SO): harness/wall/oiio.cpp harness/wall/oiio.h
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS_ALL) $(SHIM_$(config)) -shared -o $@ $< $(shell pkg-config --libs OpenImageIO 2>/dev/null)

$(ARCHIVE): $(OBJECTS)
	@rm -f $@
	@ar rcs $@ $^

$(foreach name,march_avx2 cone_lanes_avx2,$(OBJ)/harness/bake/$(name).o $(OBJ)/harness/bake/$(name).tidy): CFLAGS_ALL += -mavx2 -mfma
$(OBJ)/harness/bake/march_avx512.o $(OBJ)/harness/bake/march_avx512.tidy: CFLAGS_ALL += -mavx512f -mavx512dq -mavx512bw -mavx512vl
# Only the rooms that read files could meet what is not aligned.
$(OBJ)/harness/bake/%.o $(OBJ)/methods/%.o: NO_ALIGNMENT := $(if $(filter sanitize,$(config)),-fno-sanitize=alignment)
$(OBJ)/%.o: %.c | $(GENERATED_H)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) $(NO_ALIGNMENT) -c -o $@ $<

$(GEN)/%.o: $(GEN)/%.c | $(GENERATED_H)
	$(CC) $(CFLAGS_ALL) -c -o $@ $<

# Generated: the sorted list of methods, the GL loader, shaders as C text.
# Always asked, since a file that is gone is newer than nothing; written anew only when it changed.
# Of this process: several may ask at once.
NEW := new-$(shell echo $$PPID)
keep_if_same = cmp -s $@.$(NEW) $@ && rm $@.$(NEW) || mv $@.$(NEW) $@
$(GEN)/methods_builtin.c: FORCE
	@mkdir -p $(@D)
	@{ echo '/* Generated from the file names in methods/. */'; echo '#include "method/method.h"'; \
	names="$(sort $(patsubst methods/%.c,%,$(wildcard methods/*.c)))"; \
	for n in $$names; do echo "extern const struct method $${n//-/_}_method;"; done; \
	echo 'const struct method *const methods_builtin[] = {'; \
	for n in $$names; do echo "    &$${n//-/_}_method,"; done; \
	echo '    NULL,'; echo '};'; } > $@.$(NEW)
	@$(keep_if_same)

GLCOREARB := $(firstword $(wildcard /usr/include/GL/glcorearb.h))
gl_names = awk '/^\#ifdef GL_VERSION_4_6|^\#ifndef GL_VERSION_4_6/ {exit} /^GLAPI .*APIENTRY gl/ \
    {match($$0, /gl[A-Za-z0-9_]+ \(/); print substr($$0, RSTART + 2, RLENGTH - 4)}' $(GLCOREARB)
$(GEN)/gl_functions.inc: $(GLCOREARB) Makefile
	@mkdir -p $(@D)
	@$(gl_names) | while read n; do echo "    PFNGL$${n^^}PROC $$n;"; done > $@
$(GEN)/gl_load.c: $(GLCOREARB) Makefile
	@mkdir -p $(@D)
	@{ echo '/* Generated from glcorearb.h: name and place of every OpenGL 4.5 core function. */'; \
	echo '#include "wall/gl_load.h"'; echo 'const struct gl_entry gl_entries[] = {'; \
	$(gl_names) | while read n; do echo "    {\"gl$$n\", offsetof(struct gl, $$n)},"; done; \
	echo '    {NULL, 0},'; echo '};'; } > $@
# What the results say about the build.
hash := \#
version_of = $(shell printf '$(hash)include <%s>\nTHE $(2)\n' '$(1)' | $(CC) -E -P -x c - 2>/dev/null | sed -n 's/^THE "*\([^"]*\)"*/\1/p')
$(GEN)/build_facts.h: FORCE
	@mkdir -p $(@D)
	@{ echo '/* Generated: the revision and the libraries of this build. */'; \
	revision=$$(git describe --always --dirty --abbrev=12 --exclude='*' 2>/dev/null); \
	echo "#define TREELINE_REVISION \"$${revision:-unknown}\""; \
	date=$$(git log -1 --format=%cs 2>/dev/null); echo "#define TREELINE_DATE \"$${date:-undated}\""; \
	list="embree $(call version_of,embree$(EMBREE)/rtcore.h,RTC_VERSION_STRING)"; \
	list="$$list, meshoptimizer $(call version_of,meshoptimizer.h,MESHOPTIMIZER_VERSION)"; \
	for p in OpenImageIO $(PKG); do list="$$list, $$p $$(pkg-config --modversion $$p 2>/dev/null)"; done; \
	echo "#define TREELINE_LIBRARIES \"$$list\""; } > $@.$(NEW)
	@$(keep_if_same)
.PHONY: FORCE
FORCE:
GL_BACKENDS := $(if $(GL_OSMESA),gl_osmesa) $(if $(GL_EGL),gl_egl_surfaceless gl_egl_device)
$(BUILD)/gl_backends.o: $(BUILD)/gl_backends.c | $(GENERATED_H)
	$(CC) $(CFLAGS_ALL) -c -o $@ $<
$(BUILD)/gl_backends.c: Makefile
	@mkdir -p $(@D)
	@{ echo '/* Generated: the GL back ends of this build. */'; echo '#include "wall/gl_load.h"'; \
	for b in $(GL_BACKENDS); do echo "extern const struct gl_backend $$b;"; done; \
	echo 'const struct gl_backend *const gl_backend_list[] = {'; \
	for b in $(GL_BACKENDS); do echo "    &$$b,"; done; echo '    NULL,'; echo '};'; \
	echo 'const char *const gl_backends[] = {'; \
	for b in $(GL_BACKENDS); do n=$${b#gl_}; echo "    \"$${n//_/-}\","; done; \
	echo '    NULL,'; echo '};'; } > $@
GLSL_TO_C := harness/method/glsl_to_c.sh
$(GEN)/%.glsl.h: methods/%.glsl $(GLSL_TO_C)
	@mkdir -p $(@D)
	@$(GLSL_TO_C) $< > $@
$(GEN)/%.glsl.h: harness/bake/%.glsl $(GLSL_TO_C)
	@mkdir -p $(@D)
	@$(GLSL_TO_C) $< > $@
$(GEN)/%.glsl.h: harness/calibrate/%.glsl $(GLSL_TO_C)
	@mkdir -p $(@D)
	@$(GLSL_TO_C) $< > $@

# Tests: one program a file, against the archive; all of it where plugins are loaded. They compute little themselves:
# they are compiled in a fraction of the time without optimization.
TEST_MODE := $(if $(filter release,$(config)),-O1,-O0)
$(BUILD)/tests/test_backdrop: TEST_MODE := -O1
comma := ,
$(BUILD)/tests/test_cell $(BUILD)/tests/test_conform: WHOLE := yes
$(BUILD)/tests/%: tests/%.c $(ARCHIVE) | $(GENERATED_H)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) -Itests $(shell pkg-config --cflags cmocka gsl 2>/dev/null) $(LDFLAGS_ALL) $(TEST_MODE) -o $@ $< \
	    $(if $(WHOLE),-Wl$(comma)--whole-archive) $(ARCHIVE) -Wl,--no-whole-archive $(LIBS) -lcmocka -lgsl -lgslcblas

# Methods that go wrong, as shared objects, for the tests.
PLUGINS := $(patsubst tests/plugins/%.c,$(BUILD)/plugins/%.so,$(wildcard tests/plugins/*.c))
$(BUILD)/plugins/%.so: tests/plugins/%.c tests/plugins/wrap.h | $(GENERATED_H)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) -MF $(@:.so=.d) -MT $@ -shared -o $@ $<
$(BUILD)/tests/test_cell $(BUILD)/tests/test_conform $(BUILD)/tests/test_plan: | $(PLUGINS)
plugins: $(PLUGINS)

T ?=
CHOSEN := $(if $(T),$(T:%=$(BUILD)/tests/%),$(TESTS))
test: $(CHOSEN) $(if $(filter *,$(ROOMS)),all,$(IMAGE_SO))
	@tests/run.sh $(CHOSEN)

new-method:
	@methods/skeleton/new.sh

# libFuzzer on the loaders, with clang's coverage and sanitizers in a build of its own; what they call of the other
# rooms is the sanitizers' build.
FUZZ_SECONDS ?= 3600
SANITIZED := build/sanitize-clang/libtreeline.a
$(BUILD)/fuzz: tests/fuzz/fuzz.c tests/fuzz/targets.h $(ARCHIVE) $(IMAGE_SO) $(wildcard $(SANITIZED))
	$(CC) $(CFLAGS_ALL) -Itests $(LDFLAGS_ALL) -fsanitize=fuzzer -o $@ $< -Wl,--whole-archive $(ARCHIVE) \
	    -Wl,--no-whole-archive $(SANITIZED) $(LIBS)
fuzz-build:
	@$(MAKE) --no-print-directory CC=clang config=sanitize $(SANITIZED)
	@$(MAKE) --no-print-directory CC=clang config=fuzz build/fuzz-clang/fuzz
fuzz: fuzz-build
	@tests/fuzz.sh $(FUZZ_SECONDS) $(T)
.PHONY: fuzz fuzz-build

packages:
	@.ci/install

bench:
	@.ci/install
	@$(MAKE) --no-print-directory all
	@./treeline run quick --out results/quick-$$(date -u +%Y%m%d-%H%M%S) --report

check:
	@.ci/install check
	@tests/check.sh

install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/treeline $(DESTDIR)$(PREFIX)/share/treeline
	install -m755 $(BINARY) $(DESTDIR)$(PREFIX)/bin/treeline
	install -m755 $(IMAGE_SO) $(DESTDIR)$(PREFIX)/lib/treeline/
	cp -r scenes $(DESTDIR)$(PREFIX)/share/treeline/
	install -Dm644 -t $(DESTDIR)$(PREFIX)/share/treeline/reports/template reports/template/*
	install -Dm644 -t $(DESTDIR)$(PREFIX)/share/treeline/reports/papers reports/papers/*
	for room in base bake method plant scene wall; do \
	  install -Dm644 -t $(DESTDIR)$(PREFIX)/include/treeline/$$room harness/$$room/*.h; done
	install -m644 $(GEN)/gl_functions.inc $(DESTDIR)$(PREFIX)/include/treeline/
	install -m644 harness/method/plugin.mk $(DESTDIR)$(PREFIX)/share/treeline/
	install -m755 $(GLSL_TO_C) $(DESTDIR)$(PREFIX)/share/treeline/
	install -d $(DESTDIR)$(PREFIX)/lib/pkgconfig
	sed "s/@ABI@/$$(sed -n 's/^.define METHOD_ABI \([0-9]*\).*/\1/p' harness/method/method.h)/" \
	  harness/method/treeline.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/treeline.pc
	$(BINARY) help man > $(BUILD)/treeline.1
	install -Dm644 -t $(DESTDIR)$(PREFIX)/share/man/man1 $(BUILD)/treeline.1
	install -Dm644 -t $(DESTDIR)$(PREFIX)/share/doc/treeline README.md CHANGELOG.md CITATION.cff GLOSSARY.md LICENSE

# Documents made by the program itself; the check compares them. Read the manual with: man -l treeline.1
docs: all
	@./treeline help methods > methods/README.md
	@./treeline help man > $(BUILD)/treeline.1

FORMAT := $(shell git ls-files '*.c' '*.h' '*.cpp' 2>/dev/null)
format:
	clang-format -i $(FORMAT)

# A stamp a file: all cores work, and a second lint reads only what changed (the object knows the headers).
TIDY := $(patsubst %.c,$(OBJ)/%.tidy,$(SOURCES) harness/cli/treeline.c)
$(OBJ)/%.tidy: %.c $(OBJ)/%.o .clang-tidy
	@echo "clang-tidy $<"
	@clang-tidy --quiet --warnings-as-errors='*' $< -- $(filter-out -MMD -MP,$(CFLAGS_ALL)) 2>$@.log || { cat $@.log; exit 1; }
	@touch $@

# cppcheck 2.10 takes arrays that a loop fills for unset, and stumbles over vectors; gcc and clang's analyser look for
# what is unset.
lint:
	@.ci/install lint
	@clang-format --dry-run -Werror $(FORMAT)
	@$(MAKE) --no-print-directory -j$(shell nproc) tidy
	cppcheck --quiet -j$(shell nproc) --error-exitcode=1 --enable=warning,portability --inline-suppr \
	    --suppress=missingIncludeSystem --suppress=uninitvar --suppress=internalAstError -Iharness -I$(GEN) harness methods
.PHONY: tidy
tidy: $(TIDY)

clean:
	rm -rf build treeline

-include $(OBJECTS:.o=.d) $(TESTS:=.d) $(PLUGINS:.so=.d) $(OBJ)/harness/cli/treeline.d
