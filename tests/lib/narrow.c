#include "narrow.h"

#define NORMAL_NARROW
#define lsq_add      narrow_add
#define lsq_times    narrow_times
#define lsq_dot      narrow_dot
#define lsq_add_rows narrow_add_rows
#define lsq_factor   narrow_factor
#define lsq_forward  narrow_forward
#define lsq_backward narrow_backward
#include "lsq.c"
