#include "narrow.h"

#define NORMAL_NARROW
#define normal_add      narrow_add
#define normal_times    narrow_times
#define normal_dot      narrow_dot
#define normal_factor   narrow_factor
#define normal_forward  narrow_forward
#define normal_backward narrow_backward
#include "normal.c"
