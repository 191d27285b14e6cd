# surfaced -- see README.md.  `make help` lists the targets.
#
# What is built follows from what is there: every core/*.c goes into libsurface.a, every
# db/*.c but surfacectl's into the store's library, every tests/test_*.c is a program.
# A test that needs a linker flag says so on a line of its own:  /* link: -Wl,--wrap=f */
# Files embedded in a program: schema.sql -> build/gen/schema_sql.h (array schema_sql),
# server/openapi.json -> build/gen/openapi_json.h (array openapi_json), server/docs.* alike.

ifeq ($(origin CC),default)
CC           := gcc
endif
BUILD        ?= build
PREFIX       ?= /usr/local
LIBDIR       ?= $(PREFIX)/lib
UNITDIR      ?= $(PREFIX)/lib/systemd/system
DESTDIR      ?=
OPT          ?= -O3
WERROR       ?= -Werror
FUZZ_SECONDS ?= 60
VERSION      := $(shell sed -n 's|.*"surfaced/\([0-9.]*\) .*|\1|p' core/face.h)

WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes \
            -Wmissing-prototypes -Wcast-qual -Wformat=2 -Wvla -Wundef $(WERROR)
# -ffp-contract=off and no fast-math: the same bytes in, the same digits out.
CFLAGS   := -std=c11 -g $(OPT) -ffp-contract=off -fno-math-errno \
            -fstack-protector-strong -fPIE $(WARN) $(EXTRA)
FORTIFY  := $(if $(findstring -O0,$(OPT))$(findstring sanitize,$(EXTRA)),0,2)
CPPFLAGS := -D_POSIX_C_SOURCE=200809L -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=$(FORTIFY)
LDFLAGS  := -pie -Wl,--as-needed -Wl,-z,relro -Wl,-z,now $(EXTRA)
DB_LIBS  := -lsqlite3 -lsodium -lxxhash -lpthread -lm
LIBS     := -lmicrohttpd -lgnutls -lcjson -linih -lsystemd -lz -lzstd $(DB_LIBS)

# V=1 shows the commands in full; -s nothing.
Q   := $(if $(V),,@)
say  = @$(if $(V)$(findstring s,$(firstword -$(MAKEFLAGS))),:,printf '  %-5s %s\n' $(1) $@)

# ---- what is there

CORE_SRC  := $(wildcard core/*.c)
CTL_SRC   := $(wildcard db/surfacectl*.c)
DB_SRC    := $(filter-out $(CTL_SRC),$(wildcard db/*.c))
HTTP_SRC  := $(filter-out server/main.c,$(wildcard server/*.c))
TEST_SRC  := $(wildcard tests/test_*.c)
FUZZ_SRC  := $(wildcard tests/fuzz_*.c)
BENCH_SRC := $(wildcard tests/bench*.c)
BLACK_BOX := $(wildcard tests/[0-9][0-9]-*.sh)
AUX_SRC   := $(wildcard tests/*_main.c)
SHIM_SRC  := $(wildcard tests/*_shim.c)
STUDY_SRC := $(wildcard studies/*.c)
# Fixtures need cmocka: only unit tests link them.
FIX_SRC   := $(filter-out $(TEST_SRC),$(shell grep -ls '<cmocka.h>' tests/*.c))
HELP_SRC  := $(filter-out $(TEST_SRC) $(FUZZ_SRC) $(BENCH_SRC) $(AUX_SRC) $(SHIM_SRC) \
               $(FIX_SRC),$(wildcard tests/*.c))

obj        = $(patsubst %.c,$(BUILD)/%.o,$(1))
TEST_BIN  := $(TEST_SRC:%.c=$(BUILD)/%)
FUZZ_BIN  := $(FUZZ_SRC:%.c=$(BUILD)/%)
BENCH_BIN := $(BENCH_SRC:tests/%.c=$(BUILD)/%)
AUX_BIN   := $(AUX_SRC:tests/%_main.c=$(BUILD)/%)
SHIM_BIN  := $(SHIM_SRC:tests/%.c=$(BUILD)/%.so)
PROGRAMS  := $(if $(wildcard server/main.c),$(BUILD)/surfaced) \
             $(if $(wildcard db/surfacectl.c),$(BUILD)/surfacectl)
EMBED     := json html css js
GEN       := $(patsubst %.sql,$(BUILD)/gen/%_sql.h,$(wildcard *.sql)) \
             $(foreach x,$(EMBED),$(patsubst server/%.$x,$(BUILD)/gen/%_$x.h,$(wildcard server/*.$x)))
ALL_OBJ   := $(call obj,$(wildcard $(addsuffix /*.c,core db server tools tests studies)))

CORE_A := $(BUILD)/libsurface.a
DB_A   := $(BUILD)/libdb.a
HTTP_A := $(BUILD)/libserver.a
HELP_A := $(BUILD)/libtests.a
FIX_A  := $(BUILD)/libfixtures.a

# ---- build

## all: the library, both programs and the face generator
.PHONY: all
all: $(CORE_A) $(PROGRAMS) $(BUILD)/facegen

# A folder sees the folders below it and no others: server -> db -> core.
$(BUILD)/core/%.o:   INCLUDE := -Icore
$(BUILD)/db/%.o:     INCLUDE := -Idb -Icore -I$(BUILD)/gen
$(BUILD)/server/%.o: INCLUDE := -Iserver -Idb -Icore -I$(BUILD)/gen
$(BUILD)/tools/%.o:  INCLUDE := -Itools -Icore
$(BUILD)/tests/%.o:  INCLUDE := -Itests -Itools -Iserver -Idb -Icore -I$(BUILD)/gen
$(BUILD)/studies/%.o: INCLUDE := -Istudies -Itests -Itools -Icore

$(BUILD)/%.o: %.c Makefile | $(GEN)
	@mkdir -p $(@D)
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(INCLUDE) -MMD -MP -c -o $@ $<

$(BUILD)/gen/%_sql.h: %.sql scripts/embed.sh
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)scripts/embed.sh $*_sql < $< > $@.tmp && mv $@.tmp $@

define embed
$$(BUILD)/gen/%_$(1).h: server/%.$(1) scripts/embed.sh
	@mkdir -p $$(@D)
	$$(call say,GEN)
	$$(Q)scripts/embed.sh $$*_$(1) < $$< > $$@.tmp && mv $$@.tmp $$@
endef
$(foreach x,$(EMBED),$(eval $(call embed,$x)))

# The shipped model, a table in text, as a constant of the library.
$(BUILD)/gen/default_model.c: core/default.model scripts/model_c.sh
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)scripts/model_c.sh < $< > $@.tmp && mv $@.tmp $@

$(BUILD)/gen/default_model.o: $(BUILD)/gen/default_model.c core/model.h Makefile
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -Icore -c -o $@ $<

$(CORE_A): $(call obj,$(CORE_SRC)) $(BUILD)/gen/default_model.o
$(DB_A):   $(call obj,$(DB_SRC))
$(HTTP_A): $(call obj,$(HTTP_SRC))
$(HELP_A): $(call obj,$(HELP_SRC) tools/facegen.c)
$(FIX_A):  $(call obj,$(FIX_SRC))
$(BUILD)/lib%.a:
	@mkdir -p $(@D)
	@rm -f $@
	$(call say,AR)
	$(Q)$(AR) rcs $@ $^

$(BUILD)/surfaced: $(call obj,$(wildcard server/main.c)) $(HTTP_A) $(DB_A) $(CORE_A)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/surfacectl: $(call obj,$(CTL_SRC)) $(DB_A) $(CORE_A)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lcjson $(DB_LIBS)

$(BUILD)/facegen: $(call obj,$(wildcard tools/facegen*.c))
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lm

# The studies (scripts/studies): the library's geometry and the tests' generators.
$(BUILD)/study: $(call obj,$(STUDY_SRC)) $(HELP_A) $(CORE_A)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lm

# ---- tests

TEST_LIBS := $(HELP_A) $(HTTP_A) $(DB_A) $(CORE_A)
linkflags  = $$(sed -n 's|^/\* link: \(.*\) \*/$$|\1|p' $(1))

$(TEST_BIN): $(BUILD)/tests/%: $(BUILD)/tests/%.o $(FIX_A) $(TEST_LIBS)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(call linkflags,tests/$*.c) -lcmocka $(LIBS)

$(filter-out $(BUILD)/digits,$(AUX_BIN)): $(BUILD)/%: $(BUILD)/tests/%_main.o $(HELP_A) $(DB_A) \
    $(CORE_A)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(DB_LIBS)

# Built four times more by scripts/check_digits.sh: without the store.
$(BUILD)/digits: $(BUILD)/tests/digits_main.o $(HELP_A) $(CORE_A)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lm

# To be loaded into a program that is as it is, so never with a sanitizer.
$(SHIM_BIN): $(BUILD)/%.so: tests/%.c tests/crash_op.h Makefile
	@mkdir -p $(@D)
	$(call say,LD)
	$(Q)$(CC) $(filter-out $(EXTRA) -fPIE,$(CFLAGS)) -fPIC -shared -Itests -o $@ $<

$(BENCH_BIN): $(BUILD)/%: $(BUILD)/tests/%.o $(TEST_LIBS)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

.PHONY: tests
tests: all $(TEST_BIN) $(FUZZ_BIN) $(AUX_BIN) $(SHIM_BIN) $(BUILD)/study

## test: build and run the unit tests and the black-box tests
.PHONY: test unit
# The black-box tests wait much and take longest: first, so that others run beside the last.
test: tests
	BUILD=$(BUILD) scripts/run_tests.sh \
	    $(if $(findstring sanitize,$(EXTRA)),$(filter-out $(LONG),$(BLACK_BOX)),$(BLACK_BOX)) \
	    $(TEST_BIN) $(FUZZ_BIN)
# Minutes under a sanitizer, of code that other tests take there too; and one that loads what
# a sanitizer would have to be loaded before.
LONG := tests/24-% tests/25-% tests/28-% tests/30-% tests/31-studies% tests/36-% tests/39-%

## unit: the unit tests alone
unit: tests
	BUILD=$(BUILD) scripts/run_tests.sh $(TEST_BIN) $(FUZZ_BIN)

THREAD_BIN := $(patsubst %.c,$(BUILD)/%,$(shell grep -ls pthread.h $(TEST_SRC)))
.PHONY: threads
threads: all $(THREAD_BIN) $(AUX_BIN)
	BUILD=$(BUILD) scripts/run_tests.sh $(THREAD_BIN) \
	    $(filter tests/10-% tests/14-% tests/15-% tests/23-%,$(BLACK_BOX))

## demo: faces enrolled and verified over HTTP (scripts/demo)
.PHONY: demo
demo:
	scripts/demo

## bench: the benchmarks, with compiler, flags, CPU, commit and seeds
.PHONY: bench
bench: all $(BENCH_BIN)
	BUILD=$(BUILD) CC="$(CC)" CFLAGS="$(CFLAGS)" scripts/bench $(BENCH_BIN)

## studies: the papers' tables and figures, recomputed: build/studies/report.html
.PHONY: studies
studies:
	BUILD=$(BUILD) scripts/studies

# Sanitizers: a build and a run of the tests of their own.
SANE := -fno-omit-frame-pointer -fno-sanitize-recover=all
.PHONY: asan ubsan tsan sanitize
## asan: the tests under the address and leak sanitizers
asan:
	$(MAKE) test BUILD=build/asan OPT=-O1 EXTRA="-fsanitize=address $(SANE)"
## ubsan: the tests under the undefined-behaviour sanitizer
ubsan:
	$(MAKE) test BUILD=build/ubsan OPT=-O1 EXTRA="-fsanitize=undefined $(SANE)"
## tsan: the tests with threads under the thread sanitizer
tsan:
	$(MAKE) threads BUILD=build/tsan OPT=-O1 EXTRA="-fsanitize=thread $(SANE)"
## sanitize: address, leak and undefined-behaviour sanitizers in one run
sanitize:
	$(MAKE) test BUILD=build/sanitize OPT=-O1 EXTRA="-fsanitize=address,undefined $(SANE)"

## fuzz: every fuzzer for FUZZ_SECONDS seconds each (60), with clang's libFuzzer
.PHONY: fuzz fuzzers
fuzz:
	$(MAKE) fuzzers BUILD=build/fuzz CC=clang OPT=-O1 WERROR= \
	    EXTRA="-fsanitize=fuzzer-no-link,address,undefined $(SANE)"
	scripts/fuzz.sh build/fuzz $(FUZZ_SECONDS)

$(BUILD)/tests/fuzz_%.o: CPPFLAGS += $(if $(findstring fuzzer,$(EXTRA)),-DFUZZ_LIBFUZZER)
fuzzers: $(FUZZ_BIN)
$(FUZZ_BIN): $(BUILD)/tests/%: $(BUILD)/tests/%.o $(TEST_LIBS)
	$(call say,LD)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $(if $(findstring fuzzer,$(EXTRA)),-fsanitize=fuzzer) \
	    -o $@ $^ $(LIBS)

## lint: the rules of the house: headers, symbols, dependencies, format, shell scripts
.PHONY: lint
lint: all
	BUILD=$(BUILD) scripts/lint.sh

## format: lay out every source file by .clang-format
.PHONY: format
format:
	clang-format -i core/*.[ch] \
	    $(wildcard db/*.[ch] server/*.[ch] tools/*.[ch] tests/*.[ch] studies/*.[ch])

# ---- install

## install: programs, library, headers, man pages, systemd units (PREFIX, DESTDIR)
.PHONY: install
install: all
	install -d "$(DESTDIR)$(PREFIX)/bin" "$(DESTDIR)$(PREFIX)/sbin" \
	    "$(DESTDIR)$(PREFIX)/include/surface" "$(DESTDIR)$(LIBDIR)/pkgconfig" \
	    "$(DESTDIR)$(PREFIX)/lib/sysusers.d" "$(DESTDIR)$(UNITDIR)" "$(DESTDIR)/etc"
	install -m 755 $(BUILD)/surfaced "$(DESTDIR)$(PREFIX)/sbin/"
	install -m 755 $(BUILD)/surfacectl "$(DESTDIR)$(PREFIX)/bin/"
	install -m 644 core/*.h "$(DESTDIR)$(PREFIX)/include/surface/"
	install -m 644 $(CORE_A) "$(DESTDIR)$(LIBDIR)/"
	sed 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|; s|@VERSION@|$(VERSION)|' \
	    packaging/surface.pc.in > "$(DESTDIR)$(LIBDIR)/pkgconfig/surface.pc"
	sed 's|=/usr/sbin/|=$(PREFIX)/sbin/|' packaging/surfaced.service \
	    > "$(DESTDIR)$(UNITDIR)/surfaced.service"
	sed 's|/usr/bin/|$(PREFIX)/bin/|' packaging/surfaced-backup.service \
	    > "$(DESTDIR)$(UNITDIR)/surfaced-backup.service"
	install -m 644 packaging/surfaced.socket packaging/surfaced-backup.timer \
	    "$(DESTDIR)$(UNITDIR)/"
	install -m 644 packaging/surfaced.sysusers \
	    "$(DESTDIR)$(PREFIX)/lib/sysusers.d/surfaced.conf"
	[ -e "$(DESTDIR)/etc/surfaced.conf" ] || \
	    install -m 644 packaging/surfaced.conf "$(DESTDIR)/etc/"
	for page in man/*.[1-8]; do \
	    install -D -m 644 -t "$(DESTDIR)$(PREFIX)/share/man/man$${page##*.}" $$page || exit; \
	done

## deb: Debian packages, in build/deb (make check-deb tries them on a bare Debian)
.PHONY: deb
deb:
	BUILD=$(BUILD) scripts/deb.sh

# A target of its own, not a part of scripts/test: it takes root, a mirror and some minutes.
.PHONY: check-deb
check-deb: deb $(BUILD)/facegen
	BUILD=$(BUILD) scripts/check_deb.sh

## clean: remove everything that was built
.PHONY: clean
clean:
	rm -rf $(BUILD)

## help: this list
.PHONY: help
help:
	@sed -n 's/^## \([a-z]*\): \(.*\)/  \1\t\2/p' Makefile | expand -t 12
	@echo "Variables: BUILD=$(BUILD) PREFIX=$(PREFIX) DESTDIR= CC=$(CC) OPT=$(OPT) EXTRA="

.DELETE_ON_ERROR:
.SECONDARY:
-include $(ALL_OBJ:.o=.d)
