/* export and import: subjects between databases. */
#include <stdio.h>

#include "keyfile.h"
#include "ctl.h"

int ctl_archive_export(struct ctl *c)
{
    char size[32];
    struct store_exported x;
    struct keyfile *k = NULL;
    struct store *s = NULL;
    enum status st;

    if (c->dir == NULL || c->all == (c->nargs > 0)) {
        (void)errinfo_set(&c->e, ST_EINVAL,
                          c->dir == NULL ? "where to?  -o FILE"
                                         : "which subjects?  Their ids, or --all");
        return EXIT_USAGE;
    }
    if ((st = ctl_open(c, STORE_WRITE, &s)) == ST_OK &&
        (st = ctl_key_archive(c, true, &k)) == ST_OK)
        st = store_export(s, CTL_ACTOR, c->args, (size_t)c->nargs, c->dir, k, &x, &c->e);
    keyfile_free(k);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_text(c->out, "archive", c->dir);
    ctl_out_number(c->out, "subjects", (double)x.subjects);
    ctl_out_number(c->out, "templates", (double)x.templates);
    ctl_out_number(c->out, "bytes", (double)x.bytes);
    if (!c->json)
        (void)printf("%s: %llu subjects, %llu templates, %s\n", c->dir,
                     (unsigned long long)x.subjects, (unsigned long long)x.templates,
                     ctl_bytes(x.bytes, size));
    return EXIT_FINE;
}

int ctl_archive_import(struct ctl *c)
{
    struct store_imported m;
    struct keyfile *k = NULL;
    struct store *s = NULL;
    enum status st;

    if ((st = ctl_model_store(c, STORE_WRITE, &s)) == ST_OK &&
        (st = ctl_key_archive(c, false, &k)) == ST_OK)
        st = store_import(s, CTL_ACTOR, c->args[0], k, c->dry_run, &m, &c->e);
    keyfile_free(k);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_number(c->out, "subjects", (double)m.subjects);
    ctl_out_number(c->out, "templates", (double)m.templates);
    ctl_out_number(c->out, "subjects_new", (double)m.new_subjects);
    ctl_out_number(c->out, "templates_new", (double)m.new_templates);
    ctl_out_number(c->out, "subjects_erased", (double)m.erased);
    ctl_out_number(c->out, "templates_stale", (double)m.stale);
    ctl_out_flag(c->out, "imported", !c->dry_run);
    if (c->json)
        return EXIT_FINE;
    (void)printf("%llu subjects, %llu templates; new %s: %llu and %llu\n",
                 (unsigned long long)m.subjects, (unsigned long long)m.templates,
                 c->dry_run ? "would be" : "are", (unsigned long long)m.new_subjects,
                 (unsigned long long)m.new_templates);
    if (m.erased > 0)
        (void)printf("%llu subjects were erased here: left out\n",
                     (unsigned long long)m.erased);
    if (m.stale > 0)
        (void)printf("%llu templates were made by another engine: surfacectl template "
                     "reprocess\n",
                     (unsigned long long)m.stale);
    return EXIT_FINE;
}
