#include "grid.h"

enum surface_region grid_region_of(uint32_t cell)
{
    const double x = fabs(grid_x(cell)), y = grid_y(cell);

    if (y > 46.0)
        return SURFACE_FOREHEAD;
    if (y < -50.0)
        return SURFACE_CHIN;
    if (x < 18.0 && y > -12.0 && y < 34.0)
        return SURFACE_NOSE;
    if (x < 50.0 && y > 14.0)
        return SURFACE_EYES;
    if (x < 34.0 && y < -12.0)
        return SURFACE_MOUTH;
    return SURFACE_CHEEKS;
}

const char *surface_region_name(enum surface_region region)
{
    static const char *const name[SURFACE_REGIONS] = {
        [SURFACE_NOSE] = "nose",         [SURFACE_EYES] = "eyes",
        [SURFACE_FOREHEAD] = "forehead", [SURFACE_CHEEKS] = "cheeks",
        [SURFACE_MOUTH] = "mouth",       [SURFACE_CHIN] = "chin"};

    return (unsigned)region < SURFACE_REGIONS ? name[region] : NULL;
}
