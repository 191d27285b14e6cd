#include "cloudunit.h"

#include <string.h>

static const struct {
    const char *name, *plural;
    double mm;
} unit[] = {{"mm", "millimetres", 1},
            {"cm", "centimetres", 10},
            {"m", "metres", 1000},
            {"in", "inches", 25.4},
            {"um", "micrometres", 0.001}};

#define UNITS (sizeof unit / sizeof *unit)

bool cloudunit_mm(const char *name, size_t len, double *mm)
{
    for (size_t i = 0; i < UNITS; i++) {
        if (strlen(unit[i].name) != len || memcmp(unit[i].name, name, len) != 0)
            continue;
        *mm = unit[i].mm;
        return true;
    }
    return false;
}

bool cloudunit_or_auto(const char *name, double *mm)
{
    if (strcmp(name, "auto") != 0)
        return cloudunit_mm(name, strlen(name), mm);
    *mm = 0;
    return true;
}

const char *cloudunit_name(double mm)
{
    for (size_t i = 0; i < UNITS; i++)
        if (unit[i].mm == mm)
            return unit[i].name;
    return "";
}

const char *cloudunit_plural(double mm)
{
    for (size_t i = 0; i < UNITS; i++)
        if (unit[i].mm == mm)
            return unit[i].plural;
    return "";
}
