# surfaced -- see README.md.  `make help` lists the targets.
#
# A room is a folder of modules.  The Makefile finds the files by their names: the *.c files
# of a room become an archive, build/libROOM.a; server/main.c, ctl/main.c and lab/main.c hold the
# programs' main(); sim/NAME_main.c and tests/*/NAME_main.c become programs of their own, build/NAME;
# tests/ROOM/test_*.c are unit tests, each linked only with its room and the rooms that it sees.
# A test that needs a linker flag has a line:  /* link: -Wl,--wrap=f */
# Files embedded in a program: schema.sql -> build/gen/schema_sql.h (array schema_sql), and what
# schema_postgres.sed makes of it, server/openapi.json -> build/gen/openapi_json.h (array openapi_json), server/docs.* likewise.

ifeq ($(origin CC),default)
CC           := gcc
endif
HOSTCC       ?= $(CC)
NM           ?= nm
OBJCOPY      ?= objcopy
BUILD        ?= build
PREFIX       ?= /usr/local
LIBDIR       ?= $(PREFIX)/lib
UNITDIR      ?= $(PREFIX)/lib/systemd/system
DESTDIR      ?=
OPT          ?= -O3
WERROR       ?= -Werror
FUZZ_SECONDS ?= 60
# 0: without the PostgreSQL driver, and without libpq.
POSTGRES     ?= 1
VERSION      := $(shell sed -n 's|.*SURFACE_VERSION  *"\(.*\)"|\1|p' core/basic/surface_basic.h)
# The version of the shared library's interface; counted up by an incompatible change.
SOVERSION    := 0

# ---- the rooms, and the others that each may include and link, in link order

FACE         := core/face core/measure core/mesh core/basic
CORE         := core/find $(FACE)
# What all else sees of the core: libsurface.h, and the utilities beside it.
PUBLIC       := core core/basic
DB           := db db/rows db/log db/crypt
ROOMS        := core/basic core/mesh core/measure core/face core/find core base scan \
                db/sql db/crypt db/log db/rows db db/admin service server/http server/api server \
                ctl sim lab/study lab
SEES_core/basic   :=
SEES_core/mesh    := core/basic
SEES_core/measure := core/mesh core/basic
SEES_core/face    := core/measure core/mesh core/basic
SEES_core/find    := $(FACE)
SEES_core     := $(CORE)
SEES_base     := $(PUBLIC)
SEES_scan     := base $(PUBLIC)
SEES_db/sql   := base $(PUBLIC)
SEES_db/crypt := base $(PUBLIC)
SEES_db/log   := db/sql db/crypt base $(PUBLIC)
SEES_db/rows  := db/log db/sql db/crypt base $(PUBLIC)
SEES_db       := db/rows db/log db/sql db/crypt scan base $(PUBLIC)
SEES_db/admin := db db/rows db/log db/sql db/crypt scan base $(PUBLIC)
SEES_service  := $(DB) scan base $(PUBLIC)
SEES_server/http := service $(DB) scan base $(PUBLIC)
SEES_server/api := server/http service $(DB) scan base $(PUBLIC)
SEES_server   := server/api server/http service $(DB) scan base $(PUBLIC)
SEES_ctl      := service db/admin $(DB) scan base $(PUBLIC)
SEES_sim      := scan base core $(CORE)
SEES_lab/study := sim scan base core $(CORE)
SEES_lab      := lab/study sim scan base core $(CORE)
# What a room is linked with besides, for those that see the room and not this.
LINKS_db/log := db/sql
LINKS_core   := core/find core/face core/measure core/mesh

# The libraries that a room needs in addition to the C library.
NEEDS_core/basic := -lm
NEEDS_base   := -linih -lcjson -lz -lzstd -lpthread
NEEDS_scan   := -lspng
NEEDS_db/sql := -lsqlite3 $(if $(filter 1,$(POSTGRES)),-lpq) -lpthread
NEEDS_db/crypt := -lsodium
NEEDS_server/http := -lmicrohttpd -lgnutls -lsystemd

sees  = $(filter $(ROOMS),$(1) $(SEES_$(1)))
links = $(foreach r,$(call sees,$(1)),$r $(filter-out $(call sees,$(1)),$(LINKS_$r)))
flags = $(addprefix -I,$(call sees,$(1))) -I$(BUILD)/gen
arch  = $(BUILD)/lib$(notdir $(1)).a
archs = $(foreach r,$(call links,$(1)),$(call arch,$r))
needs = $(foreach r,$(call links,$(1)),$(NEEDS_$r))

WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes \
            -Wmissing-prototypes -Wcast-qual -Wformat=2 -Wvla -Wundef $(WERROR)
# -ffp-contract=off and no fast-math, so that the same input gives the same digits everywhere; with -std=c11 gcc
# for s390x computes floats as doubles, unless it is told not to.  clang has no such option.
EXCESS   := $(shell $(CC) -fexcess-precision=fast -Werror -E - </dev/null >/dev/null 2>&1 && echo -fexcess-precision=fast)
CFLAGS   := -std=c11 -g $(OPT) -ffp-contract=off $(EXCESS) -fno-math-errno \
            -fstack-protector-strong -fPIE $(WARN) $(EXTRA)
FORTIFY  := $(if $(findstring -O0,$(OPT))$(findstring sanitize,$(EXTRA)),0,2)
CPPFLAGS := -D_POSIX_C_SOURCE=200809L -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=$(FORTIFY)
LDFLAGS  := -pie -Wl,--as-needed -Wl,-z,relro -Wl,-z,now $(EXTRA) $(LINKER)
link      = $(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^

# V=1 prints the full commands; -s prints nothing.
Q   := $(if $(V),,@)
say  = @$(if $(V)$(findstring s,$(firstword -$(MAKEFLAGS))),:,printf '  %-5s %s\n' $(1) $@)

# ---- sources and programs

obj        = $(patsubst %.c,$(BUILD)/%.o,$(1))
programs   = $(patsubst %_main.c,$(BUILD)/%,$(notdir $(1)))
TEST_SRC  := $(filter-out $(if $(filter 1,$(POSTGRES)),,tests/db/test_server% tests/admin/test_move.c),$(wildcard tests/*/test_*.c))
TEST_BIN  := $(TEST_SRC:%.c=$(BUILD)/%)
# Fuzzers of tests/fuzz/cloud.c: fuzz_cloudNAME-FORMAT.
CLOUDS    := file-COUNT abs-ABS bnt-BNT depth-PNG glb-GLB npy-NPY pcd-PCD stl-STL vrml-VRML xyz-XYZ
CLOUD_BIN := $(foreach c,$(CLOUDS),$(BUILD)/tests/fuzz/fuzz_cloud$(firstword $(subst -, ,$c)))
FUZZ_BIN  := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c)) $(CLOUD_BIN)
BENCH_BIN := $(patsubst tests/bench/%.c,$(BUILD)/%,$(wildcard tests/bench/bench*.c))
# The longest first.
FLEET     := tests/box/fleet.sh
BLACK_BOX := $(FLEET) $(filter-out $(FLEET) tests/box/lib.sh,$(wildcard tests/box/*.sh))
TOOL_BIN  := $(call programs,$(filter-out sim/model_main.c,$(wildcard sim/*_main.c)))
AID_SRC   := $(wildcard tests/*/*_main.c)
AID_BIN   := $(call programs,$(AID_SRC))
# Preloaded into finished programs; the recorder not into sanitized ones.
SHIM_BIN  := $(BUILD)/crash_shim.so $(BUILD)/slow_shim.so $(BUILD)/alloc_shim.so $(if $(findstring sanitize,$(EXTRA)),,$(BUILD)/record_shim.so)
EMBED     := json html css js svg
GEN       := $(patsubst %.sql,$(BUILD)/gen/%_sql.h,schema.sql schema_postgres.sql) \
             $(foreach x,$(EMBED),$(patsubst server/%.$x,$(BUILD)/gen/%_$x.h,$(wildcard server/*.$x)) \
               $(patsubst server/console/%.$x,$(BUILD)/gen/console_%_$x.h,$(wildcard server/console/*.$x)))
GEN       += $(BUILD)/gen/page_html.h
PROGRAMS  := $(BUILD)/surfaced $(BUILD)/surfacectl $(BUILD)/surfacelab $(TOOL_BIN)

# ---- build

## all: the library, both programs and the face generator
.PHONY: all
all: $(BUILD)/libsurface.a $(BUILD)/libsurface.so.$(SOVERSION) $(PROGRAMS)

LEFT_OUT   := $(if $(filter 1,$(POSTGRES)),,$(wildcard db/sql/sql_postgres*.c))
# The core is in the shared library too; nothing of it but what libsurface.h declares can
# be seen there, so that calls inside it cost no more than in a program.
PIC        = $(if $(filter core core/%,$(1)),-fPIC -fvisibility=hidden)
define room
$(BUILD)/$(1)/%.o: FLAGS := $(call flags,$(1)) $(call PIC,$(1))
$(call arch,$(1)): $(call obj,$(filter-out %_main.c server/main.c ctl/main.c lab/main.c $(LEFT_OUT),$(wildcard $(1)/*.c)))
endef
$(foreach r,$(ROOMS),$(eval $(call room,$r)))

# A folder of tests sees what its room sees, the room itself, sim and tests/lib, and all of the core.
TEST_ROOMS := $(filter-out lib,$(notdir $(patsubst %/,%,$(wildcard tests/*/))))
SEES_crypt := $(call sees,db/crypt)
SEES_log   := $(call sees,db)
SEES_rows  := $(call sees,db)
SEES_admin := $(call sees,db/admin)
SEES_box   := service $(call sees,db/admin)
SEES_fuzz  := server/api server/http service lab $(call sees,db/admin)
SEES_work  := scan base core $(CORE)
SEES_bench := $(call sees,db/admin)
# The tested code is built with $(OPT); building the tests themselves with -O3 would take twice as long.
define testroom
$(BUILD)/tests/$(1)/%.o: FLAGS := $(if $(filter-out bench,$(1)),$(OPT:-O3=-O1)) -Itests/$(1) -Itests/lib \
    -Isim $(call flags,$(1)) $(CORE:%=-I%)
endef
$(foreach r,$(TEST_ROOMS),$(eval $(call testroom,$r)))
$(BUILD)/tests/lib/%.o: FLAGS := -Itests/lib -Isim $(call flags,db/admin) $(CORE:%=-I%)
ifeq ($(POSTGRES),1)
$(BUILD)/db/sql/%.o $(BUILD)/tests/lib/%.o $(BUILD)/tests/db/%.o: FLAGS += -DWITH_POSTGRES -isystem $(shell pg_config --includedir)
endif

$(BUILD)/%.o: %.c Makefile | $(GEN)
	@mkdir -p $(@D)
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(FLAGS) -MMD -MP -c -o $@ $<

$(CLOUD_BIN:=.o): $(BUILD)/tests/fuzz/fuzz_cloud%.o: tests/fuzz/cloud.c Makefile
	@mkdir -p $(@D)
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(FLAGS) -MMD -MP -c -o $@ $< \
	    -DFUZZ_CLOUD=CLOUDFORMAT_$(patsubst $*-%,%,$(filter $*-%,$(CLOUDS)))

$(BUILD)/gen/schema_sql.h: schema.sql scripts/embed.sh
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)scripts/embed.sh schema_sql < $< > $@.tmp && mv $@.tmp $@

$(BUILD)/gen/schema_postgres_sql.h: schema.sql schema_postgres.sed scripts/embed.sh
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)sed -E -f schema_postgres.sed $< > $(@D)/schema_postgres.sql && \
	    scripts/embed.sh schema_postgres_sql < $(@D)/schema_postgres.sql > $@.tmp && mv $@.tmp $@

define embed
$$(BUILD)/gen/%_$(1).h: server/%.$(1) scripts/embed.sh
	@mkdir -p $$(@D)
	$$(call say,GEN)
	$$(Q)scripts/embed.sh $$*_$(1) < $$< > $$@.tmp && mv $$@.tmp $$@
endef
$(foreach x,$(EMBED),$(eval $(call embed,$x)))

define embed_console
$$(BUILD)/gen/console_%_$(1).h: server/console/%.$(1) scripts/embed.sh
	@mkdir -p $$(@D)
	$$(call say,GEN)
	$$(Q)scripts/embed.sh console_$$*_$(1) < $$< > $$@.tmp && mv $$@.tmp $$@
endef
$(foreach x,$(EMBED),$(eval $(call embed_console,$x)))

# The page that surfacectl explain and scan write has the console's own view.
PAGE_JS := $(patsubst %,server/console/%.js,dom view glb section stage verdict report) scan/page.js
$(BUILD)/gen/page_html.h: scripts/page.sh scripts/embed.sh server/console/style.css scan/page.css $(PAGE_JS)
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)scripts/page.sh "server/console/style.css scan/page.css" $(PAGE_JS) > $(@:.h=.html) && \
	    scripts/embed.sh page_html < $(@:.h=.html) > $@.tmp && mv $@.tmp $@

# The console's sample scans, for a visitor without scans; scripts/model/samples.py made them.
$(BUILD)/server/api/pages.o: $(patsubst server/console/samples/%.ply,$(BUILD)/gen/sample_%_ply.h,$(wildcard server/console/samples/*.ply))
$(BUILD)/gen/sample_%_ply.h: server/console/samples/%.ply scripts/embed.sh
	@mkdir -p $(@D)
	$(call say,GEN)
	$(Q)scripts/embed.sh sample_$*_ply < $< > $@.tmp && mv $@.tmp $@

# The shipped model, a table in text, becomes a constant of the library.  build/gen/model prints
# it: a program of the model's parser alone, built for this machine also when cross-compiling.
MODEL_H := $(addprefix core/,face/model.h face/grid.h face/surface_face.h basic/status.h basic/surface_basic.h)
$(BUILD)/gen/model: sim/model_main.c core/face/model.c core/basic/calibration.c $(MODEL_H) Makefile
	@mkdir -p $(@D)
	$(call say,LD)
	$(Q)$(HOSTCC) -std=c11 -O1 -ffp-contract=off $(call flags,core/face) -o $@ $(filter %.c,$^) -lm

$(BUILD)/gen/default_model.c: core/face/default.model $(BUILD)/gen/model
	$(call say,GEN)
	$(Q)$(BUILD)/gen/model < $< > $@.tmp && mv $@.tmp $@

$(BUILD)/gen/default_model.o: $(BUILD)/gen/default_model.c $(MODEL_H) Makefile
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(call flags,core/face) $(call PIC,core) -c -o $@ $<

$(call arch,core/face): $(BUILD)/gen/default_model.o
# Helpers of unit tests include cmocka and are linked only with unit tests: a build for users has no cmocka.
FIXTURES := $(shell grep -lE '<cmocka.h>|"unit.h"' tests/lib/*.c)
$(call arch,fixtures): $(call obj,$(FIXTURES))
$(call arch,tests): $(call obj,$(filter-out $(FIXTURES),$(wildcard tests/lib/*.c)))
$(BUILD)/lib%.a:
	@mkdir -p $(@D)
	@rm -f $@
	$(call say,AR)
	$(Q)$(AR) rcs $@ $^

# The core with a call in each basic block, which tests/work counts.
COUNTED := $(patsubst %.c,$(BUILD)/counted/%.o,$(wildcard $(CORE:%=%/*.c)))
$(COUNTED): $(BUILD)/counted/%.o: %.c Makefile
	@mkdir -p $(@D)
	$(call say,CC)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -fsanitize-coverage=trace-pc $(call flags,core/find) -MMD -MP -c -o $@ $<
$(call arch,counted): $(COUNTED) $(BUILD)/gen/default_model.o

# The header as it is installed: libsurface.h with the header of each layer in the place of its #include.
PUBLIC_H := core/libsurface.h $(addprefix core/,basic/surface_basic.h face/surface_face.h face/surface_search.h find/surface_scan.h)
$(BUILD)/surface.h: $(PUBLIC_H) Makefile
	$(call say,GEN)
	$(Q)sed $(foreach h,$(filter-out $<,$(PUBLIC_H)),-e '/^#include ".*$(notdir $h)"/{r '$h -e 'd}') $< | \
	    sed '/CORE_SURFACE_/d; /^#include "/d' > $@

# The library as it is installed: core as one object that exports what its header declares, and
# nothing else.
$(BUILD)/libsurface.a: $(call archs,core) $(BUILD)/surface.h
	$(call say,AR)
	$(Q)$(CC) -r -nostdlib -o $(@:.a=.o) -Wl,--whole-archive $(call archs,core) -Wl,--no-whole-archive
	$(Q)grep -oE 'surface_[a-z_]+\(' $(BUILD)/surface.h | tr -d '(' | sort -u > $(@:.a=.names)
	$(Q)$(OBJCOPY) --keep-global-symbols=$(@:.a=.names) $(@:.a=.o)
	@rm -f $@
	$(Q)$(AR) rcs $@ $(@:.a=.o)

# Built from the archive, with the same names, under a version node of their own.
$(BUILD)/libsurface.so.$(SOVERSION): $(BUILD)/libsurface.a
	$(call say,LD)
	$(Q)awk 'BEGIN { print "SURFACE_$(SOVERSION) { global:" } { print $$0 ";" } \
	    END { print "local: *; };" }' $(<:.a=.names) > $@.map
	$(Q)$(CC) $(CFLAGS) -shared -Wl,-soname,$(@F) -Wl,--version-script,$@.map \
	    $(if $(findstring sanitize,$(EXTRA)),,-Wl,-z,defs) -Wl,-z,relro -Wl,-z,now $(EXTRA) \
	    -o $@ -Wl,--whole-archive $< -Wl,--no-whole-archive -lm

$(BUILD)/surfaced: $(BUILD)/server/main.o $(call archs,server)
	$(call say,LD)
	$(Q)$(link) $(call needs,server)

$(BUILD)/surfacectl: $(BUILD)/ctl/main.o $(call archs,ctl)
	$(call say,LD)
	$(Q)$(link) $(call needs,ctl)

$(BUILD)/surfacelab: $(BUILD)/lab/main.o $(call archs,lab)
	$(call say,LD)
	$(Q)$(link) $(call needs,lab)

$(TOOL_BIN): $(BUILD)/%: $(BUILD)/sim/%_main.o $(call archs,sim)
	$(call say,LD)
	$(Q)$(link) $(call needs,sim)

# ---- tests

testarchs = $(if $(filter work,$(1)),$(call arch,counted),$(call archs,$(1)))
linkflags = $$(sed -n 's|^/\* link: \(.*\) \*/$$|\1|p' $(1))

# The programs in tests/ROOM, linked with tests/lib, the face generator and the rooms they see.
define testlink
$(filter $(BUILD)/tests/$(1)/%,$(TEST_BIN)): $(BUILD)/%: $(BUILD)/%.o $(call arch,fixtures) $(call arch,tests) \
    $(call arch,sim) $(call testarchs,$(1))
	$$(call say,LD)
	$$(Q)$$(link) $$(call linkflags,$$*.c) -lcmocka $(call needs,$(1))
$(filter $(BUILD)/tests/$(1)/%,$(FUZZ_BIN)): $(BUILD)/%: $(BUILD)/%.o $(call arch,tests) \
    $(call arch,sim) $(call testarchs,$(1))
	$$(call say,LD)
	$$(Q)$$(link) $$(if $$(findstring fuzzer,$$(EXTRA)),-fsanitize=fuzzer) $(call needs,$(1))
$(call programs,$(filter-out %/digits_main.c,$(filter tests/$(1)/%,$(AID_SRC)))): $(BUILD)/%: $(BUILD)/tests/$(1)/%_main.o \
    $(call arch,tests) $(call arch,sim) $(call testarchs,$(1))
	$$(call say,LD)
	$$(Q)$$(link) $(call needs,$(1))
endef
$(foreach r,$(TEST_ROOMS),$(eval $(call testlink,$r)))

# Of the core and the simulation alone, so that it can be built for a machine that has no other library.
$(BUILD)/digits: $(BUILD)/tests/core/digits_main.o $(call arch,sim) $(call archs,core)
	$(call say,LD)
	$(Q)$(link) $(call needs,core)

# Preloaded into a finished program, so never built with a sanitizer.
$(SHIM_BIN): $(BUILD)/%.so: tests/box/%.c Makefile
	@mkdir -p $(@D)
	$(call say,LD)
	$(Q)$(CC) $(filter-out $(EXTRA) -fPIE,$(CFLAGS)) -fPIC -shared -Itests/lib -o $@ $<

$(BENCH_BIN): $(BUILD)/%: $(BUILD)/tests/bench/%.o \
    $(call arch,tests) $(call arch,sim) $(call archs,bench)
	$(call say,LD)
	$(Q)$(link) $(call needs,bench)

# Programs that the black-box tests run.
AIDS := $(AID_BIN) $(SHIM_BIN)

## tests: everything that the tests need
.PHONY: tests
tests: all $(TEST_BIN) $(FUZZ_BIN) $(AIDS)

# Left out under a sanitizer: tests that would take minutes, of code that other tests run there
# too, and those of the pages, whose requests others send; those that count basic blocks, which are
# others there; crash, whose preloaded library would be loaded before the sanitizer's; faults, because
# the leak sanitizer does not run under strace; and the fuzzers, whose inputs `make fuzz` runs with
# sanitizers.
LONG := client-python clients client-openapi lab-evaluate lab-train http-openapi http-upkeep accuracy http-hostile studies fault-client crash faults \
    console% attack store-attacks http-same formats ctl-hyphen ctl-output ctl-calibrate ctl-subject dedup fleet \
    http-examples http-scopes page phone shape
# The black-box tests first: they wait much and take longest, and others run beside the last.
ALL_TESTS := $(if $(findstring sanitize,$(EXTRA)),$(filter-out $(LONG:%=tests/box/%.sh),\
    $(BLACK_BOX)),$(BLACK_BOX)) $(if $(findstring sanitize,$(EXTRA)),\
    $(filter-out $(BUILD)/tests/work/%,$(TEST_BIN)),$(TEST_BIN) $(FUZZ_BIN))
CHECK     := $(strip $(if $(T),$(foreach t,$(ALL_TESTS),$(if $(findstring $(T),$(notdir $t)),$t)),\
    $(ALL_TESTS)))

# The aids that the chosen black-box tests name, as "$BUILD/forge"; all aids if all tests run.
NEEDED    = $(if $(T),$(filter $(patsubst BUILD/%,$(BUILD)/%,$(shell \
    grep -oh 'BUILD/[a-z_.]*' $(filter %.sh,$(CHECK)))),$(AIDS)),$(AIDS))

## check: build and run the tests whose names contain T (make check T=locate), or all
.PHONY: check unit
check: $(filter-out %.sh,$(CHECK)) $(if $(filter %.sh,$(CHECK)),all $(NEEDED))
	$(if $(CHECK),,$(error no test's name contains "$(T)": see tests/*/test_*.c and tests/box/*.sh))
	BUILD=$(BUILD) scripts/run_tests.sh $(CHECK)

## unit: the unit tests alone
unit: $(TEST_BIN) $(FUZZ_BIN)
	BUILD=$(BUILD) scripts/run_tests.sh $(TEST_BIN) $(FUZZ_BIN)

# Tests that run on either engine: of the store, and of the daemon's use of it.
SERVED := $(foreach r,db log rows service,$(filter $(BUILD)/tests/$r/%,$(TEST_BIN))) \
          $(filter %/test_move,$(TEST_BIN))
SERVED_BOX := routes consent groups identify events limits tries scopes replay narrow parallel live full-subject console
## check-postgres: tests of the store and the daemon on a PostgreSQL of their own
.PHONY: check-postgres
check-postgres: all $(SERVED) $(BUILD)/forge
	BUILD=$(BUILD) scripts/with_postgres scripts/run_tests.sh \
	    $(SERVED_BOX:%=tests/box/http-%.sh) $(patsubst %,tests/box/%.sh,ctl-life ctl-explain reencode faults) $(SERVED)

THREAD_BIN := $(patsubst %.c,$(BUILD)/%,$(shell grep -ls pthread.h $(TEST_SRC)))
.PHONY: threads
threads: $(PROGRAMS) $(BUILD)/forge $(BUILD)/slow_shim.so $(THREAD_BIN)
	BUILD=$(BUILD) scripts/run_tests.sh $(THREAD_BIN) \
	    $(patsubst %,tests/box/http-%.sh,routes parallel events) tests/box/ctl-calibrate.sh \
	    tests/box/ctl-explain.sh

## demo: enroll and verify faces over HTTP (scripts/demo)
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

# clang also reports an int passed for an enum; gcc checks the sign conversions.
CLANG := -Wno-sign-conversion
# Each sanitizer has its own build, in which the tests run: clang's, which take two thirds of the time of
# gcc's and see more.  lld links their programs in a third of the time of ld.
SANE := -g1 -fno-omit-frame-pointer -fno-sanitize-recover=all -DSANITIZED
SANITIZED = CC=clang OPT=-O1 EXTRA="$(foreach s,$(1),-fsanitize=$s) $(SANE) $(CLANG)" \
    LINKER=$(if $(shell command -v ld.lld),-fuse-ld=lld)
.PHONY: tsan sanitize
## tsan: the tests with threads under the thread sanitizer
tsan:
	$(MAKE) threads BUILD=build/tsan $(call SANITIZED,thread)
## sanitize: the tests under the address, leak and undefined-behaviour sanitizers
sanitize:
	$(MAKE) check BUILD=build/sanitize $(call SANITIZED,address undefined) JITTER_COPIES=3

## fuzz: every fuzzer for FUZZ_SECONDS seconds each (60), with clang's libFuzzer
.PHONY: fuzz fuzz-build fuzzers
fuzz-build:
	$(MAKE) fuzzers BUILD=build/fuzz $(call SANITIZED,fuzzer-no-link address undefined)
fuzz: fuzz-build
	scripts/fuzz.sh build/fuzz $(FUZZ_SECONDS)

$(BUILD)/tests/fuzz/%.o: CPPFLAGS += $(if $(findstring fuzzer,$(EXTRA)),-DFUZZ_LIBFUZZER)
fuzzers: $(FUZZ_BIN)

# Prints each room and the rooms that it sees, for the checks.
.PHONY: layers
layers:
	@$(foreach r,$(ROOMS),echo $r $(SEES_$r);)

## lint: the project's rules: headers, symbols, dependencies, format, shell scripts
.PHONY: lint
lint: all
	BUILD=$(BUILD) scripts/lint.sh

## format: lay out every source file by .clang-format
.PHONY: format
format:
	clang-format -i $(wildcard $(ROOMS:%=%/*.[ch]) tests/*/*.[ch])

# ---- install

## install: programs, library, man pages, completion, systemd units (PREFIX, DESTDIR)
.PHONY: install
install: all
	install -d "$(DESTDIR)$(PREFIX)/bin" "$(DESTDIR)$(PREFIX)/sbin" \
	    "$(DESTDIR)$(PREFIX)/include" "$(DESTDIR)$(LIBDIR)/pkgconfig" \
	    "$(DESTDIR)$(PREFIX)/lib/sysusers.d" "$(DESTDIR)$(UNITDIR)" "$(DESTDIR)/etc"
	install -m 755 $(BUILD)/surfaced "$(DESTDIR)$(PREFIX)/sbin/"
	install -m 755 $(BUILD)/surfacectl $(BUILD)/surfacelab "$(DESTDIR)$(PREFIX)/bin/"
	install -m 644 $(BUILD)/surface.h "$(DESTDIR)$(PREFIX)/include/surface.h"
	install -m 644 $(BUILD)/libsurface.a $(BUILD)/libsurface.so.$(SOVERSION) \
	    "$(DESTDIR)$(LIBDIR)/"
	ln -sf libsurface.so.$(SOVERSION) "$(DESTDIR)$(LIBDIR)/libsurface.so"
	sed 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|; s|@VERSION@|$(VERSION)|' \
	    packaging/surface.pc.in > "$(DESTDIR)$(LIBDIR)/pkgconfig/surface.pc"
	sed 's|=/usr/sbin/|=$(PREFIX)/sbin/|' packaging/surfaced.service \
	    > "$(DESTDIR)$(UNITDIR)/surfaced.service"
	sed 's|/usr/bin/|$(PREFIX)/bin/|' packaging/surfaced-backup.service \
	    > "$(DESTDIR)$(UNITDIR)/surfaced-backup.service"
	install -m 644 packaging/surfaced.socket packaging/surfaced-backup.timer \
	    "$(DESTDIR)$(UNITDIR)/"
	install -d "$(DESTDIR)$(PREFIX)/share/bash-completion/completions"
	install -m 644 packaging/surfacectl.bash \
	    "$(DESTDIR)$(PREFIX)/share/bash-completion/completions/surfacectl"
	install -m 644 packaging/surfaced.sysusers \
	    "$(DESTDIR)$(PREFIX)/lib/sysusers.d/surfaced.conf"
	[ -e "$(DESTDIR)/etc/surfaced.conf" ] || \
	    install -m 644 packaging/surfaced.conf "$(DESTDIR)/etc/"
	for page in man/*.[1-8]; do \
	    install -D -m 644 -t "$(DESTDIR)$(PREFIX)/share/man/man$${page##*.}" $$page || exit; \
	done

## deb: Debian packages, in build/deb
.PHONY: deb
deb:
	BUILD=$(BUILD) scripts/deb.sh

# Not a part of scripts/test: it needs root, a mirror and some minutes.
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
	@sed -n 's/^## \([a-z-]*\): \(.*\)/  \1\t\2/p' Makefile | expand -t 12
	@echo "Variables: BUILD=$(BUILD) PREFIX=$(PREFIX) DESTDIR= CC=$(CC) OPT=$(OPT) EXTRA="

.DELETE_ON_ERROR:
.SECONDARY:
-include $(wildcard $(ROOMS:%=$(BUILD)/%/*.d) $(CORE:%=$(BUILD)/counted/%/*.d) $(BUILD)/tests/*/*.d)
