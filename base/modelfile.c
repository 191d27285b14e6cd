#include "modelfile.h"

#include <inttypes.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "errinfo.h"
#include "libsurface.h"
#include "newfile.h"
#include "readfile.h"

enum status modelfile_read(const char *path, struct surface_model **out,
                           struct errinfo *e)
{
    unsigned char *text = NULL;
    size_t len = 0;
    uint32_t line = 0;
    enum status st = readfile_all(path, MODELFILE_MAX, &text, &len, e);

    *out = NULL;
    if (st != ST_OK) {
        free(text);
        return st;
    }
    st = status_from(surface_model_parse((const char *)text, len, out, &line));
    free(text);
    if (st == ST_ENOMEM)
        return errinfo_set(e, st, "%.160s: out of memory", path);
    if (st == ST_EVERSION)
        return errinfo_set(
            e, st, "%.160s: a model of a version that this program does not read", path);
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, st, "%.160s, line %" PRIu32 ": not a model, or damaged",
                             path, line);
}

/* The daemon, another user, reads models: the umask decides, not newfile's 0600. */
static void make_readable(int fd)
{
    const mode_t mask = umask(077);

    (void)umask(mask);
    (void)fchmod(fd, 0666 & ~mask);
}

enum status modelfile_write(const char *path, bool replace, const struct surface_model *m,
                            struct errinfo *e)
{
    const size_t len = surface_model_write(m, NULL, 0);
    struct newfile file = NEWFILE_NONE;
    char *text = malloc(len + 1);
    enum status st;

    if (text == NULL)
        return errinfo_set(e, ST_ENOMEM, "%.160s: out of memory", path);
    (void)surface_model_write(m, text, len + 1);
    if ((st = newfile_open(path, &file, e)) == ST_OK &&
        (st = newfile_put(&file, text, len, e)) == ST_OK) {
        make_readable(file.fd);
        st = replace ? newfile_commit(&file, e) : newfile_keep(&file, e);
    }
    newfile_close(&file);
    free(text);
    return st;
}
