/* A few fixed comparisons must give the digits of tests/golden/digits.txt.  After an intended
 * change of the measure write the file again (build/digits > tests/golden/digits.txt) and
 * raise the measure's number in SURFACE_ENGINE. */
#include "digits.h"
#include "unit.h"

#define GOLDEN "tests/golden/digits.txt"

/* Line by line, so that a failure prints the line that differs. */
TEST(test_digits)
{
    FILE *in = fopen(GOLDEN, "r");
    size_t size;
    char *text = digits_text(&size), *line = text, want[4096];

    assert_non_null(in);
    while (fgets(want, sizeof want, in) != NULL) {
        char *end = strchr(line, '\n');

        want[strcspn(want, "\n")] = '\0';
        assert_non_null(end);
        *end = '\0';
        assert_string_equal(want, line);
        line = end + 1;
    }
    assert_ptr_equal(line, text + size);
    (void)fclose(in);
    free(text);
}
