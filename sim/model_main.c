/* model < core/face/default.model > default_model.c: the shipped model as the constant
 * model_default.  The build runs it, so it is linked with the parser alone, not with the
 * library that the constant becomes a part of.  Floats are printed in hexadecimal: exactly. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "model.h"

#define LARGEST ((size_t)8 << 20)

static void print_float(float v)
{
    if (isnan(v))
        (void)printf("NAN,");
    else
        (void)printf("%af,", (double)v);
}

static void print_cells(const char *member, const float v[GRID_N])
{
    (void)printf("    .%s = {", member);
    for (int i = 0; i < GRID_N; i++) {
        if (i % 8 == 0)
            (void)printf("\n        ");
        print_float(v[i]);
    }
    (void)printf("\n    },\n");
}

static void print_basis(const char *name, const struct model_basis *b)
{
    char rest[32];

    (void)snprintf(rest, sizeof rest, "%s.rest", name);
    print_cells(rest, b->rest);
    (void)printf("    .%s.n = %u,\n    .%s.mode = {\n", name, (unsigned)b->n, name);
    for (int i = 0; i < GRID_N; i++) {
        (void)printf("        {");
        for (uint32_t k = 0; k < (b->n > 0 ? b->n : 1); k++)
            print_float(b->mode[i][k]);
        (void)printf("},\n");
    }
    (void)printf("    },\n");
}

static void print_text(const char *text)
{
    (void)putchar('"');
    for (; *text != '\0'; text++)
        (void)printf(*text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    (void)putchar('"');
}

static void print_model(const struct surface_model *m)
{
    (void)printf("/* Made by sim/model_main.c; do not edit. */\n#include <math.h>\n"
                 "#include \"model.h\"\nconst struct surface_model model_default = {\n"
                 "    .name = ");
    print_text(m->name);
    (void)printf(",\n    .kinship = %a,\n    .noise_floor_mm = %a,\n", m->kinship,
                 m->noise_floor_mm);
    (void)printf("    .noise_factor = %a,\n    .calibration = {\n", m->noise_factor);
    (void)printf("        .threshold = %a,\n        .n = %u,\n        .knot = {",
                 m->calibration.threshold, (unsigned)m->calibration.n);
    for (uint32_t i = 0; i < m->calibration.n; i++)
        (void)printf("{%a, %a},", m->calibration.knot[i].score,
                     m->calibration.knot[i].rate);
    (void)printf("},\n        .tail = {%a, %a, %u},\n    },\n", m->calibration.tail.rate,
                 m->calibration.tail.decade, (unsigned)m->calibration.tail.people);
    print_cells("mean", m->mean);
    print_basis("change", &m->change);
    print_basis("identity", &m->identity);
    print_basis("shape", &m->shape);
    (void)printf("};\n");
}

int main(void)
{
    static struct surface_model m;
    static char text[LARGEST];
    const size_t len = fread(text, 1, sizeof text, stdin);
    uint32_t line = 0;

    if (ferror(stdin) || model_parse(text, len, &m, &line) != ST_OK) {
        (void)fprintf(stderr, "line %u: not a model\n", (unsigned)line);
        return EXIT_FAILURE;
    }
    print_model(&m);
    return fflush(stdout) == 0 && !ferror(stdout) ? EXIT_SUCCESS : EXIT_FAILURE;
}
