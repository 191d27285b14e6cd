#include "cloudunit.h"

#include <string.h>

static const struct {
    const char *name;
    double mm;
} unit[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}};

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

const char *cloudunit_name(double mm)
{
    for (size_t i = 0; i < UNITS; i++)
        if (unit[i].mm == mm)
            return unit[i].name;
    return "";
}
