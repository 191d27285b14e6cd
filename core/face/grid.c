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
