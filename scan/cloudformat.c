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

/* Returns true if the word, in small or capital letters, is in the first kilobyte. */
static bool mentions(const char *p, size_t len, const char *word)
{
    const size_t n = strlen(word);

    for (size_t i = 0; i + n <= len && i < 1024; i++)
        if (strncasecmp(p + i, word, n) == 0)
            return true;
    return false;
}

/* Returns the kind of a file that begins with "<". */
static const char *xml_kind(const char *p, size_t len)
{
    static const struct {
        const char *word, *name;
    } known[] = {{"<html", "a web page (HTML)"},
                 {"<!doctype html", "a web page (HTML)"},
                 {"<COLLADA", "a COLLADA file (DAE)"},
                 {"<X3D", "an X3D file"},
                 {"<VTKFile", "a VTK file"},
                 {"<amf", "an AMF file"},
                 {"<svg", "an SVG picture"}};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (mentions(p, len, known[i].word))
            return known[i].name;
    return "an XML file";
}

#define ANY '*' /* in a magic: one byte, whatever it is */

/* The commonest kinds of files that are no scans.  Words are as long as it takes for the heading of a
 * text file not to begin with them. */
static const struct {
    const char *name, *magic;
    unsigned char len, at;
} foreign[] = {
#define KIND(name, magic)                                                                \
    {                                                                                    \
        name, magic, sizeof(magic) - 1, 0                                                \
    }
    /* scenes and drawings */
    KIND("an OFF file", "OFF\n"),
    KIND("an OFF file", "OFF\r"),
    KIND("an OFF file", "OFF "),
    KIND("an OFF file", "COFF\n"),
    KIND("an OFF file", "COFF\r"),
    KIND("an OFF file", "NOFF\n"),
    KIND("an OFF file", "NOFF\r"),
    KIND("an FBX file", "Kaydara FBX"),
    KIND("an FBX file", "; FBX"),
    KIND("a STEP file", "ISO-10303-21"),
    KIND("a DXF file", "AutoCAD Binary DXF"),
    KIND("a DWG file", "AC10**\0"),
    KIND("a Rhino file", "3D Geometry File Format"),
    KIND("a 3DS file", "MM****\x02\0"),
    KIND("a DirectX file (.x)", "xof 0"),
    KIND("the materials of an OBJ file (MTL)", "newmtl "),
    KIND("a U3D file", "U3D\0"),
    KIND("a Draco file", "DRACO"),
    KIND("an OpenCTM file", "OCTM"),
    KIND("an X3D file", "#X3D"),
    KIND("an Open Inventor file", "#Inventor"),
    KIND("a BVH file", "HIERARCHY"),
    KIND("a VTK file", "# vtk"),
    KIND("a Blender file", "BLENDER"),
    KIND("a USD file", "PXR-USDC"),
    KIND("a USD file", "#usda"),
    KIND("an Alembic file", "Ogawa"),
    /* scans and measurements */
    KIND("an E57 file", "ASTM-E57"),
    KIND("a LAS file", "LASF"),
    KIND("a ROS bag", "#ROSBAG"),
    KIND("an MCAP file", "\x89MCAP"),
    KIND("a Parquet file", "PAR1"),
    KIND("an Arrow file", "ARROW1"),
    KIND("a network capture (PCAP)", "\xD4\xC3\xB2\xA1"),
    KIND("a network capture (PCAP)", "\x0A\x0D\x0D\x0A"),
    KIND("an NRRD file", "NRRD000"),
    KIND("an HDF5 file", "\x89HDF"),
    KIND("a NetCDF file", "CDF\x01"),
    KIND("a NetCDF file", "CDF\x02"),
    KIND("a FITS file", "SIMPLE  ="),
    KIND("a MATLAB file", "MATLAB *.* MAT"),
    KIND("a pickle of Python", "\x80\x02"),
    KIND("a pickle of Python", "\x80\x03"),
    KIND("a pickle of Python", "\x80\x04"),
    KIND("a pickle of Python", "\x80\x05"),
    KIND("a data file of R", "RDX3\n"),
    KIND("a data file of R", "RDX2\n"),
    KIND("a data file of R", "X\n\0\0\0"),
    KIND("an SQLite database", "SQLite format 3"),
    KIND("a YAML file", "%YAML"),
    {"a DICOM file", "DICM", 4, 128},
    /* pictures */
    KIND("a JPEG picture", "\xFF\xD8\xFF"),
    KIND("a JPEG XL picture", "\xFF\x0A"),
    KIND("a JPEG 2000 picture", "\0\0\0\x0CjP  "),
    KIND("a GIF picture", "GIF8"),
    KIND("a TIFF picture", "II*\0"),
    KIND("a TIFF picture", "MM\0*"),
    KIND("a BMP picture", "BM****\0\0\0\0"),
    KIND("a WebP picture", "RIFF****WEBP"),
    KIND("an EXR picture", "\x76\x2F\x31\x01"),
    KIND("an HDR picture", "#?RADIANCE"),
    KIND("a Photoshop picture", "8BPS"),
    KIND("a GIMP picture", "gimp xcf"),
    KIND("a DDS picture", "DDS \x7C"),
    KIND("an icon", "\0\0\x01\0\x01"),
    KIND("a PPM picture", "P6\n"),
    KIND("a PPM picture", "P3\n"),
    KIND("a PBM picture", "P4\n"),
    KIND("a PFM picture", "Pf\n"),
    KIND("a PFM picture", "PF\n"),
    KIND("a PAM picture", "P7\n"),
    KIND("a HEIC picture", "****ftyphei"),
    KIND("a HEIC picture", "****ftypmif1"),
    KIND("a HEIC picture", "****ftypmsf1"),
    KIND("an AVIF picture", "****ftypavi"),
    KIND("a raw picture (CR3)", "****ftypcrx"),
    /* video and sound */
    KIND("an MP4 recording of sound", "****ftypM4A"),
    KIND("a QuickTime video (MOV)", "****ftypqt"),
    KIND("an MP4 video", "****ftyp"),
    KIND("a QuickTime video (MOV)", "****moov"),
    KIND("a QuickTime video (MOV)", "****mdat"),
    KIND("a QuickTime video (MOV)", "****wide"),
    KIND("a Matroska or WebM video", "\x1A\x45\xDF\xA3"),
    KIND("an AVI video", "RIFF****AVI "),
    KIND("an MPEG video", "\0\0\x01\xBA"),
    KIND("an MPEG video", "\0\0\x01\xB3"),
    KIND("a Windows Media file", "\x30\x26\xB2\x75\x8E\x66"),
    KIND("a WAV recording of sound", "RIFF****WAVE"),
    KIND("an AIFF recording of sound", "FORM****AIF"),
    KIND("an Ogg recording", "OggS"),
    KIND("a FLAC recording of sound", "fLaC"),
    KIND("an MP3 recording of sound", "ID3\x02"),
    KIND("an MP3 recording of sound", "ID3\x03"),
    KIND("an MP3 recording of sound", "ID3\x04"),
    KIND("an MP3 recording of sound", "\xFF\xFB"),
    /* archives */
    KIND("a ZIP archive (3MF, XLSX, USDZ or NPZ)", "PK\x03\x04"),
    KIND("an empty ZIP archive", "PK\x05\x06"),
    KIND("a gzip file inside a gzip file", "\x1F\x8B"),
    KIND("a compress file", "\x1F\x9D"),
    KIND("a zstd file", "\x28\xB5\x2F\xFD"),
    KIND("a bzip2 file", "BZh"),
    KIND("an xz file", "\xFD\x37zXZ"),
    KIND("an lz4 file", "\x04\x22\x4D\x18"),
    KIND("a 7z archive", "7z\xBC\xAF\x27\x1C"),
    KIND("a RAR archive", "Rar!"),
    KIND("a CAB archive", "MSCF\0"),
    KIND("an ar archive", "!<arch>"),
    {"a tar archive", "ustar", 5, 255},
    /* documents */
    KIND("a pointer of Git LFS in the place of a file (git lfs pull fetches it)",
         "version https://git-lfs"),
    KIND("a PDF file", "%PDF"),
    KIND("a PostScript file", "%!PS"),
    KIND("an RTF document", "{\\rtf"),
    KIND("an old document of Microsoft Office", "\xD0\xCF\x11\xE0"),
    KIND("a key or a certificate (PEM)", "-----BEGIN "),
    KIND("text in UTF-16, not UTF-8", "\xFF\xFE"),
    KIND("text in UTF-16, not UTF-8", "\xFE\xFF"),
    /* programs, and what systems leave behind */
    KIND("a program (ELF)", "\x7F"
                            "ELF"),
    KIND("a program of Windows", "MZ\x90\0"),
    KIND("a program (Mach-O)", "\xCF\xFA\xED\xFE"),
    KIND("a program (Mach-O or Java)", "\xCA\xFE\xBA\xBE"),
    KIND("a program (WebAssembly)", "\0asm"),
    KIND("a script", "#!/"),
    KIND("what macOS stores beside a file (._NAME)", "\0\x05\x16\x07"),
    KIND("the view of a folder of macOS (.DS_Store)", "\0\0\0\x01"
                                                      "Bud1"),
    KIND("a shortcut of Windows", "L\0\0\0\x01\x14\x02"),
#undef KIND
};

static bool begins(const char *p, const char *magic, size_t len)
{
    for (size_t i = 0; i < len; i++)
        if (p[i] != magic[i] && magic[i] != ANY)
            return false;
    return true;
}

const char *cloudformat_foreign(const char *p, size_t len)
{
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        const size_t at = foreign[i].at == 255 ? 257 : foreign[i].at;

        if (len >= at + foreign[i].len &&
            begins(p + at, foreign[i].magic, foreign[i].len))
            return foreign[i].name;
    }
    if (len > 0 && *p == '<')
        return xml_kind(p, len);
    if (len > 3 && (begins(p, "0", 1) || begins(p, "999", 3)) &&
        mentions(p, len, "\nSECTION"))
        return "a DXF file";
    if (len >= 80 && p[72] == 'S' && begins(p + 73, "      1", 7) &&
        memchr(p, '\n', 72) == NULL)
        return "an IGES file";
    return NULL;
}

bool cloudformat_converted(const char *bytes, size_t len)
{
    const unsigned char *const end = (const unsigned char *)bytes + len, *p, *first;
    size_t lf = 0, alone = 0, wide = 0, marks = 0;

    first = memchr(bytes, 0, len);
    if (first ==
        NULL) /* binary files have zero bytes, which a conversion leaves as they are */
        return false;
    if (len > 8 && begins(bytes, "\x89PNG", 4) && !begins(bytes + 4, "\r\n\x1A\n", 4))
        return true;
    for (p = first + 1; p < end && alone == 0; p++) {
        lf += *p == '\n';
        alone += *p == '\n' && p[-1] != '\r';
    }
    if (lf >= 8 && alone == 0)
        return true;
    for (p = first; p < end; wide++) {
        size_t more;

        for (; p < end && *p < 0x80; p++)
            marks += *p == '?';
        if (p == end)
            break;
        if (*p < 0xC2 || *p > 0xF4)
            return false;
        more = *p >= 0xF0 ? 3 : *p >= 0xE0 ? 2 : 1;
        for (p++; more > 0 && p < end; more--)
            if ((*p++ & 0xC0) != 0x80)
                return false;
    }
    return wide >= 8 || (wide == 0 && marks >= 64 && marks > (size_t)(end - first) / 16);
}
