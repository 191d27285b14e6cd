#include "cloudformat.h"

#include <string.h>
#include <strings.h>

#define NAMES 8

static const struct {
    const char *name;
    const char *ending[NAMES]; /* NULL after the last */
    const char *media[NAMES];
} format[CLOUDFORMAT_COUNT] = {
    [CLOUDFORMAT_ANY] = {"",
                         {NULL},
                         {"application/octet-stream", "text/plain", "application/gzip",
                          "application/x-gzip",
                          /* what curl --data-binary sends of itself */
                          "application/x-www-form-urlencoded"}},
    [CLOUDFORMAT_PLY] = {"PLY",
                         {".ply"},
                         {"model/ply", "model/x-ply", "application/ply",
                          "application/x-ply"}},
    [CLOUDFORMAT_OBJ] = {"OBJ", {".obj"}, {"model/obj"}},
    [CLOUDFORMAT_STL] = {"STL",
                         {".stl"},
                         {"model/stl", "model/x.stl-ascii", "model/x.stl-binary",
                          "application/sla", "application/vnd.ms-pki.stl"}},
    [CLOUDFORMAT_PCD] = {"PCD", {".pcd"}, {"application/x-pcd", "application/vnd.pcd"}},
    [CLOUDFORMAT_GLB] = {"GLB", {".glb"}, {"model/gltf-binary"}},
    [CLOUDFORMAT_XYZ] = {"XYZ", {".xyz", ".pts", ".csv", ".txt", ".asc"}, {"text/csv"}},
    [CLOUDFORMAT_PNG] = {"PNG", {".png"}, {"image/png"}},
    [CLOUDFORMAT_JSON] = {"JSON", {".json"}, {"application/json"}},
    [CLOUDFORMAT_VRML] = {"VRML",
                          {".wrl", ".wrz", ".vrml"}, /* .wrz: compressed by gzip */
                          {"model/vrml", "x-world/x-vrml"}},
    [CLOUDFORMAT_BNT] = {"BNT", {".bnt"}, {NULL}},
    [CLOUDFORMAT_ABS] = {"ABS", {".abs"}, {NULL}},
    [CLOUDFORMAT_NPY] = {"NPY", {".npy"}, {NULL}},
    [CLOUDFORMAT_PGM] = {"PGM",
                         {".pgm"},
                         {"image/x-portable-graymap", "image/x-portable-anymap"}},
    [CLOUDFORMAT_RAW] = {"RAW", {".raw"}, {NULL}},
};

const char *cloudformat_name(enum cloudformat f)
{
    return format[f].name;
}

/* Does name[0..len) end with the ending, and begin before it? */
static bool ends(const char *name, size_t len, const char *ending)
{
    const size_t n = strlen(ending);

    return len > n && strncasecmp(name + len - n, ending, n) == 0;
}

const char *cloudformat_ending(const char *name)
{
    size_t len = strlen(name);

    if (ends(name, len, ".gz"))
        len -= strlen(".gz");
    for (size_t f = 0; f < CLOUDFORMAT_COUNT; f++)
        for (const char *const *e = format[f].ending; *e != NULL; e++)
            if (ends(name, len, *e))
                return name + len - strlen(*e);
    return NULL;
}

bool cloudformat_media(const char *type, size_t len, enum cloudformat *out)
{
    for (size_t f = 0; f < CLOUDFORMAT_COUNT; f++)
        for (const char *const *m = format[f].media; *m != NULL; m++)
            if (strlen(*m) == len && strncasecmp(*m, type, len) == 0) {
                *out = (enum cloudformat)f;
                return true;
            }
    return false;
}

const char *cloudformat_media_list(void)
{
    return "model/ply, model/obj, model/stl, application/x-pcd, model/gltf-binary, "
           "model/vrml, text/csv, image/png, image/x-portable-graymap, application/json, "
           "text/plain or application/octet-stream";
}

const char *cloudformat_foreign(const unsigned char *bytes, size_t len)
{
    static const struct {
        const char *name;
        const char *magic;
        size_t len, at;
    } known[] = {
        {"an OFF file", "OFF\n", 4, 0}, /* and not a heading like "OFFSET x y z" */
        {"an OFF file", "OFF\r", 4, 0},
        {"an OFF file", "OFF ", 4, 0},
        {"an OFF file", "COFF\n", 5, 0},
        {"an OFF file", "COFF\r", 5, 0},
        {"an OFF file", "NOFF\n", 5, 0},
        {"an OFF file", "NOFF\r", 5, 0},
        {"a ZIP archive (3MF, XLSX, USDZ or NPZ)", "PK\x03\x04", 4, 0},
        {"an FBX file", "Kaydara FBX", 11, 0},
        {"an FBX file", "; FBX", 5, 0},
        {"an XML file (DAE, X3D, AMF)", "<", 1, 0},
        {"an E57 file", "ASTM-E57", 8, 0},
        {"a LAS file", "LASF", 4, 0},
        {"a VTK file", "# vtk", 5, 0},
        {"a Blender file", "BLENDER", 7, 0},
        {"a USD file", "PXR-USDC", 8, 0},
        {"a USD file", "#usda", 5, 0},
        {"an HDF5 file", "\x89HDF", 4, 0},
        {"a MATLAB file", "MATLAB", 6, 0},
        {"a JPEG picture", "\xFF\xD8\xFF", 3, 0},
        {"a TIFF picture", "II*\0", 4, 0},
        {"a TIFF picture", "MM\0*", 4, 0},
        {"an EXR picture", "\x76\x2F\x31\x01", 4, 0},
        {"a HEIC picture", "ftyp", 4, 4},
        {"a PDF file", "%PDF", 4, 0},
        {"a DICOM file", "DICM", 4, 128},
        {"text in UTF-16, not UTF-8", "\xFF\xFE", 2, 0},
        {"text in UTF-16, not UTF-8", "\xFE\xFF", 2, 0},
        {"a zstd file", "\x28\xB5\x2F\xFD", 4, 0},
        {"a bzip2 file", "BZh", 3, 0},
        {"an xz file", "\xFD\x37zXZ", 5, 0},
        {"a 7z archive", "7z\xBC\xAF\x27\x1C", 6, 0},
        {"a RAR archive", "Rar!", 4, 0},
    };

    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (len >= known[i].at + known[i].len &&
            memcmp(bytes + known[i].at, known[i].magic, known[i].len) == 0)
            return known[i].name;
    return NULL;
}
