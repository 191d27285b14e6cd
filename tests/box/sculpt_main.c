/* sculpt FOLDER: sculpt_write() for the black-box tests. */
#include <stdio.h>

#include "sculpt.h"

int main(int argc, char **argv)
{
    if (argc == 2 && sculpt_write(argv[1], 10, 0.1))
        return 0;
    perror("sculpt FOLDER");
    return 1;
}
