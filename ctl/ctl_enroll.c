/* enroll: the files of a subject; ctl_enroll_folder.h: many subjects. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudformat.h"
#include "describe.h"
#include "enrolment.h"
#include "utf8.h"
#include "ctl_command.h"
#include "ctl_enroll_folder.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "ctl_sample.h"

static bool force;       /* --force */
static const char *kind; /* --kind */

/* The scans of a subject that are enrolled together. */
struct burst {
    char *path[ENROLMENT_SAMPLES];
    struct face face[ENROLMENT_SAMPLES];
    struct scan_found found[ENROLMENT_SAMPLES];
    struct enrolment_result each[ENROLMENT_SAMPLES];
    size_t n; /* more than there is room for: so many were named */
};

/* ---- which files */

static enum status add_path(struct ctl *c, struct burst *b, const char *folder,
                            const char *name)
{
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path;

    if (b->n++ >= ENROLMENT_SAMPLES)
        return ST_OK;
    if ((path = malloc(size)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    (void)snprintf(path, size, "%s%s%s", folder, folder[0] != '\0' ? "/" : "", name);
    b->path[b->n - 1] = path;
    return ST_OK;
}

static int is_scan(const struct dirent *d)
{
    return d->d_name[0] != '.' && cloudformat_ending(d->d_name) != NULL;
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static enum status add_folder(struct ctl *c, struct burst *b, const char *folder)
{
    struct dirent **list;
    const int n = scandir(folder, &list, is_scan, by_name);
    enum status st = ST_OK;

    if (n < 0)
        return errinfo_set(&c->e, ST_EIO, "%.200s: the folder cannot be read", folder);
    if (n == 0)
        st = errinfo_set(&c->e, ST_ENOTFOUND,
                         "%.200s: no scan in the folder, by the endings of the names",
                         folder);
    for (int i = 0; i < n; i++) {
        if (st == ST_OK && !utf8_is_text(list[i]->d_name, sizeof list[i]->d_name))
            st = errinfo_set(&c->e, ST_EINVAL,
                             "%.200s: the name of scan %d in the folder has a control "
                             "character, or is not UTF-8",
                             folder, i + 1);
        if (st == ST_OK)
            st = add_path(c, b, folder, list[i]->d_name);
        free(list[i]);
    }
    free(list);
    return st;
}

static enum status list_files(struct ctl *c, struct burst *b)
{
    enum status st = ST_OK;
    struct stat sb;

    for (int i = 1; st == ST_OK && i < c->nargs; i++)
        st = stat(c->args[i], &sb) == 0 && S_ISDIR(sb.st_mode)
                 ? add_folder(c, b, c->args[i])
                 : add_path(c, b, "", c->args[i]);
    if (st == ST_OK && b->n > ENROLMENT_SAMPLES)
        return ctl_usage(c, "%zu scans: at most %d are enrolled at once", b->n,
                         ENROLMENT_SAMPLES);
    return st;
}

/* ---- enrolling them */

static enum status enroll(struct ctl *c, struct burst *b)
{
    struct store_sample sample[ENROLMENT_SAMPLES] = {{.face = NULL}};
    const struct enrolment x = {.actor = c->actor,
                                .subject = c->args[0],
                                .label = c->label != NULL ? c->label : "",
                                .sample = sample,
                                .n = b->n,
                                .manager = true,
                                .force = force};
    struct templates_context with = ctl_face_context(c, c->work);
    struct enrolment_outcome out;
    enum status st;

    for (size_t i = 0; i < b->n; i++) { /* one bad scan does not stop the others */
        st = ctl_sample_read(c, b->path[i], true, c->work, &b->face[i], &b->found[i]);
        if (st == ST_ENOMEM)
            return st;
        if (st == ST_OK)
            sample[i] =
                (struct store_sample){.face = &b->face[i], .read = b->found[i].digest};
        else
            b->each[i].why = c->e;
    }
    st = enrolment_add(&with, &x, b->each, &out, &c->e);
    return out.none ? ST_OK : st;
}

/* Returns how many were refused, and the status of the last in *worst. */
static size_t report(struct ctl *c, const struct burst *b, enum status *worst)
{
    size_t failed = 0;

    json_text(c->out, "subject", c->args[0]);
    json_array(c->out, "templates");
    for (size_t i = 0; i < b->n; i++) {
        const struct enrolment_result *x = &b->each[i];
        const struct face *f = &b->face[i];

        json_object(c->out, NULL);
        describe_enrolled(c->out, b->path[i], x, &b->found[i], &f->frame);
        json_close(c->out);
        if (x->why.code == ST_OK) {
            ctl_say(c, "%s  %s  %u points, quality %.2f%s", x->tmpl.id, b->path[i],
                    x->tmpl.points, x->tmpl.quality.score,
                    x->created ? "" : " (was there already)");
            if (!c->json)
                ctl_face_reasons(stdout, f);
            continue;
        }
        (void)fprintf(stderr, "surfacectl: %s%s%s\n",
                      x->why.code == ST_EMISMATCH ? b->path[i] : "",
                      x->why.code == ST_EMISMATCH ? ": " : "", x->why.msg);
        *worst = x->why.code;
        failed++;
    }
    json_close(c->out);
    json_number(c->out, "failed", (double)failed);
    return failed;
}

static enum status enroll_files(struct ctl *c)
{
    struct burst *b;
    enum status st = ctl_face_subject(c, c->args[0], ""), worst = ST_OK;
    size_t failed;

    if (st != ST_OK)
        return st;
    if ((b = calloc(1, sizeof *b)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if ((st = list_files(c, b)) == ST_OK &&
        (st = ctl_model_open(c, STORE_WRITE)) == ST_OK && (st = enroll(c, b)) == ST_OK &&
        (failed = report(c, b, &worst)) > 0)
        st =
            errinfo_set(&c->e, worst, "%zu of %zu scans were not enrolled", failed, b->n);
    for (size_t i = 0; i < ENROLMENT_SAMPLES; i++) {
        face_free(&b->face[i]);
        free(b->path[i]);
    }
    free(b);
    return st;
}

static enum status run(struct ctl *c)
{
    struct stat sb;

    if (c->nargs == 1) {
        if (stat(c->args[0], &sb) != 0)
            return ctl_usage(c,
                             "it is: surfacectl enroll SUBJECT FILE..., or "
                             "enroll DIR|MANIFEST, and there is no %.80s",
                             c->args[0]);
        return ctl_enroll_folder(c, kind, force);
    }
    if (kind != NULL || c->threads != 0)
        return ctl_usage(c, "--kind and --threads are for a folder or a table");
    return enroll_files(c);
}

const struct ctl_command ctl_enroll = {
    .name = "enroll",
    .args = "SUBJECT FILE... | DIR | MANIFEST",
    .takes = {1, CTL_MANY},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_LABEL | CTL_THREADS,
    .options = {CTL_OPTION("force", NULL, ctl_option_flag, &force,
                           "enroll scans that do not fit the subject's other samples"),
                CTL_OPTION("kind", "WORD", ctl_option_text, &kind,
                           "of a folder or a table, only the scans of this kind")},
    .run = run,
    .summary = "enroll scans of a subject, or of many",
    .help =
        "Each FILE (a scan in any format that the manual lists; - is standard input; a folder:\n"
        "the scans in it) becomes a template, at most 20 at once, all together or none.  The first\n"
        "that is a face must match the subject's oldest template, if there is one, or one that was\n"
        "enrolled by this command or with scope manage, and the others the first; one that does\n"
        "not, or does not tell (inconclusive), is refused and listed, unless --force is given.\n"
        "Enrolling the same scan again changes nothing.\n"
        "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table, with\n"
        "the columns file and subject.  Their scans are enrolled on all cores.  If it is stopped\n"
        "and started again, it goes on where it was.\n"
        "What cannot be enrolled is listed at the end with the reason, and stops nothing else;\n"
        "surfacectl scan says more of a single scan.",
    .example = "surfacectl --db faces.db enroll alice alice-1.ply alice-2.ply"};
