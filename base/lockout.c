#include "lockout.h"

int64_t lockout_ms(unsigned limit, unsigned wait_s, unsigned most_s, uint32_t failures)
{
    int64_t wait = wait_s;

    if (failures < limit)
        return 0;
    for (uint32_t i = limit; i < failures && wait < most_s; i++)
        wait *= 2;
    return 1000 * (wait < most_s ? wait : most_s);
}
