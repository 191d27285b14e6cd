# surfaced -- see README.md.  `make help` lists the targets.

CC       ?= gcc
BUILD    ?= build
PREFIX   ?= /usr/local
DESTDIR  ?=
OPT      ?= -O3
WERROR   ?= -Werror
WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes \
            -Wmissing-prototypes -Wcast-qual -Wformat=2 -Wvla -Wundef $(WERROR)
# -ffp-contract=off and no fast-math: the same bytes in, the same digits out.
CFLAGS   := -std=c11 -g $(OPT) -ffp-contract=off -fno-math-errno $(WARN) $(EXTRA)
CPPFLAGS := -D_POSIX_C_SOURCE=200809L -D_FORTIFY_SOURCE=$(if $(findstring -O0,$(OPT)),0,2)
LDFLAGS  := $(EXTRA)

.PHONY: all
all: $(BUILD)/libsurface.a

CORE_SRC := $(wildcard core/*.c)
CORE_OBJ := $(CORE_SRC:%.c=$(BUILD)/%.o)

$(BUILD)/core/%.o: core/%.c
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -Icore -MMD -MP -c -o $@ $<

$(BUILD)/libsurface.a: $(CORE_OBJ)
	$(AR) rcs $@ $^

.PHONY: clean
clean:
	rm -rf $(BUILD)

-include $(CORE_OBJ:.o=.d)
