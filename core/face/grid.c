#include "grid.h"

enum grid_region grid_region_of(uint32_t cell)
{
    const double x = fabs(grid_x(cell)), y = grid_y(cell);

    if (y > 46.0)
        return GRID_FOREHEAD;
    if (y < -50.0)
        return GRID_CHIN;
    if (x < 18.0 && y > -12.0 && y < 34.0)
        return GRID_NOSE;
    if (x < 50.0 && y > 14.0)
        return GRID_EYES;
    if (x < 34.0 && y < -12.0)
        return GRID_MOUTH;
    return GRID_CHEEKS;
}

const char *grid_region_name(enum grid_region r)
{
    static const char *const name[GRID_REGIONS] = {
        [GRID_NOSE] = "nose",     [GRID_EYES] = "eyes",   [GRID_FOREHEAD] = "forehead",
        [GRID_CHEEKS] = "cheeks", [GRID_MOUTH] = "mouth", [GRID_CHIN] = "chin",
    };

    return name[r];
}
