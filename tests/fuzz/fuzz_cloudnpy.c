/* Scans: NumPy arrays. */
#include "fuzz.h"

#include "cloud.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return cloud_fuzz(data, size, CLOUDFORMAT_NPY);
}
