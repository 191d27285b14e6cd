#include "lab.h"

enum status lab_study(struct lab *c)
{
    return lab_usage(c, "not yet");
}
