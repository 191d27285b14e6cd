#include "ctl_session.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudformat.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "utf8.h"

static enum status add_path(struct ctl *c, struct ctl_session *s, const char *folder,
                            const char *name)
{
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path;

    if (s->n++ >= SURFACE_FRAMES_MAX)
        return ST_OK;
    if ((path = malloc(size)) == NULL)
        return errinfo_memory(&c->e);
    (void)snprintf(path, size, "%s%s%s", folder, folder[0] != '\0' ? "/" : "", name);
    s->path[s->n - 1] = path;
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

static enum status add_folder(struct ctl *c, struct ctl_session *s, const char *folder)
{
    struct dirent **list;
    const int n = scandir(folder, &list, is_scan, by_name);
    enum status st = ST_OK;

    if (n < 0)
        return errinfo_set(&c->e, ST_EIO, "%.200s: the folder cannot be read", folder);
    if (n == 0)
        st = errinfo_set(
            &c->e, ST_ENOTFOUND,
            "%.200s: no file in the folder has the extension of a scan format", folder);
    for (int i = 0; i < n; i++) {
        if (st == ST_OK && !utf8_is_text(list[i]->d_name, sizeof list[i]->d_name))
            st = errinfo_set(&c->e, ST_EINVAL,
                             "%.200s: the name of scan %d in the folder has a control "
                             "character, or is not UTF-8",
                             folder, i + 1);
        if (st == ST_OK)
            st = add_path(c, s, folder, list[i]->d_name);
        free(list[i]);
    }
    free(list);
    return st;
}

enum status ctl_session_list(struct ctl *c, int first, struct ctl_session *s)
{
    enum status st = ST_OK;
    struct stat sb;

    for (int i = first; st == ST_OK && i < c->nargs; i++)
        st = stat(c->args[i], &sb) == 0 && S_ISDIR(sb.st_mode)
                 ? add_folder(c, s, c->args[i])
                 : add_path(c, s, "", c->args[i]);
    if (st == ST_OK && s->n > SURFACE_FRAMES_MAX)
        return ctl_usage(c, "%zu scans: a capture session has at most %d", s->n,
                         SURFACE_FRAMES_MAX);
    return st;
}

enum status ctl_session_read(struct ctl *c, struct ctl_session *s)
{
    s->session.files = s->n > 1;
    for (size_t i = 0; i < s->n; i++) {
        struct session_frame *f = &s->session.frame[s->session.n++];
        const enum status st = ctl_face_parse(c, s->path[i], &f->points);

        f->name = s->path[i];
        if (st == ST_ENOMEM || (st != ST_OK && s->n == 1))
            return st;
        if (st != ST_OK)
            f->why = c->e;
    }
    return ST_OK;
}

/* Appends the parts on this side: ": left cheek", "; left half of eyes, cheeks". */
static void add_side(char *out, size_t room, int side, const struct session_part *part,
                     size_t n)
{
    static const char *const one[SURFACE_REGIONS] = {
        [SURFACE_CHEEKS] = "cheek", [SURFACE_EYES] = "eye"};
    static const char *const half[] = {"right ", "", "left "};
    const char *between = out[0] == '\0' ? ": " : "; ", *word = half[side + 1];
    size_t many = 0;

    for (size_t i = 0; i < n; i++)
        many += part[i].side == side;
    for (size_t i = 0; i < n; i++) {
        const bool single = many == 1 && side != 0 && one[part[i].region] != NULL;
        const size_t len = strlen(out);

        if (part[i].side != side)
            continue;
        (void)snprintf(out + len, room - len, "%s%s%s%s", between, word,
                       word[0] == '\0' || single ? "" : "half of ",
                       single ? one[part[i].region]
                              : surface_region_name(part[i].region));
        between = ", ";
        word = "";
    }
}

static void say_gain(const struct ctl *c, const char *name, const struct surface_gain *g,
                     double before_mm)
{
    struct session_part part[SURFACE_REGIONS];
    static const int side[] = {0, 1, -1};
    const size_t n = session_parts(g, part);
    char share[16] = "none", parts[SURFACE_REGIONS * 40] = "";

    if (g->share >= 0.005)
        (void)snprintf(share, sizeof share, "%.0f %%", 100 * g->share);
    if (g->place == 1) {
        ctl_say(c, "%s  has %s of the face, noise %.2f mm\n", name, share, g->noise_mm);
        return;
    }
    for (int i = 0; i < 3; i++)
        add_side(parts, sizeof parts, side[i], part, n);
    ctl_say(c, "%s  adds %s of the face%s; noise %.2f mm -> %.2f mm\n", name, share,
            parts, before_mm, g->noise_mm);
}

void ctl_session_tell(const struct ctl *c, const struct session *s)
{
    double before_mm = 0;

    for (uint32_t place = 1; place <= s->n; place++)
        for (size_t i = 0; i < s->n; i++)
            if (s->frame[i].adds.place == place) {
                say_gain(c, s->frame[i].name, &s->frame[i].adds, before_mm);
                before_mm = s->frame[i].adds.noise_mm;
            }
    for (size_t i = 0; i < s->n; i++)
        if (s->frame[i].why.code != ST_OK)
            (void)fprintf(stderr, "surfacectl: left out: %s\n", s->frame[i].why.msg);
}

void ctl_session_free(struct ctl_session *s)
{
    session_free(&s->session);
    for (size_t i = 0; i < SURFACE_FRAMES_MAX; i++)
        free(s->path[i]);
}
