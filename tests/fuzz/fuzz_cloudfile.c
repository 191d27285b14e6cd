/* Scanner files: the first byte selects the format. */
#include "fuzz.h"

#include "cloud.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return size == 0 ? 0
                     : cloud_fuzz(data + 1, size - 1,
                                  (enum cloudformat)(data[0] % CLOUDFORMAT_COUNT));
}
