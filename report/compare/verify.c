/* A state file names its inputs by bare name and SHA-256. Here each is looked for again and hashed again: beside the
 * file, then among what the scene names. The scene itself is compared by the part that the stage reads
 * (pipeline/scene/scene_part.h), so that a change that does not concern a stage does not cry wolf. */
#include "report/compare/verify.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/scene/scene_part.h"
#include "pipeline/state/state.h"
#include "pipeline/speak/text.h"
#include "pipeline/speak/version.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/sha256.h"
#include "report/states/loaded.h"
#include "pipeline/files/json.h"

/* Photos and tracks are inputs of many files: each is read once. */
struct known {
    char digest[65];
    char path[];
};

/* One run over several files. `known` is freed by verify_files(). */
struct verify {
    const struct scene *scene;
    FILE *stream;
    void *known; /* a tree of struct known */
    struct verify_count count;
};

/* Order of the tree of hashes. */
static int by_path(const void *a, const void *b)
{
    return strcmp(((const struct known *)a)->path, ((const struct known *)b)->path);
}

/* SHA-256 of a file, read at the first call only; borrowed from the tree. NULL with an error. */
static const char *digest_of(struct verify *verify, const char *path)
{
    struct known *known = malloc(sizeof *known + strlen(path) + 1);
    if (known)
        strcpy(known->path, path);
    struct known **found = known ? tsearch(known, &verify->known, by_path) : NULL;
    if (!found) {
        free(known);
        (void)error_memory("the list of hashes");
        return NULL;
    }
    if (*found != known) {
        free(known);
        return (*found)->digest;
    }
    if (file_sha256(path, known->digest)) {
        tdelete(known, &verify->known, by_path);
        free(known);
        return NULL;
    }
    return known->digest;
}

/* ---- where an input lies ---- */

/* folder (its first `length` bytes, with the slash) and name; to be freed; NULL without memory. */
static char *join(const char *folder, size_t length, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%.*s%s", (int)length, folder, name) < 0)
        return NULL;
    return path;
}

/* Path of the file of that name, to be freed; NULL: nowhere, or out of memory. */
static char *find_input(const struct verify *verify, const char *state_path, const char *name)
{
    const struct scene *scene = verify->scene;
    size_t folder = (size_t)(basename(state_path) - state_path);
    char *path = join(state_path, folder, name);
    if (!path || !access(path, F_OK))
        return path;
    free(path);
    long index = scene_photo_index(scene, name);
    if (index >= 0)
        return scene_photo_path(scene, index);
    if (scene->lens && !strcmp(basename(scene->lens), name))
        return strdup(scene->lens);
    if (scene->loads && !strcmp(basename(scene->loads), name))
        return strdup(scene->loads);
    return NULL;
}

/* ---- one file ---- */

/* One line on the stream, names escaped: a file's name may hold a line end. Counted as wrong. */
static void complain(struct verify *verify, const char *path, const char *name, const char *what)
{
    text_print(verify->stream, path);
    fputs(": ", verify->stream);
    text_print(verify->stream, name);
    fprintf(verify->stream, " %s\n", what);
    verify->count.wrong++;
}

/* The part of the scene that a stage read, as text, hashed and compared. */
static int verify_part(struct verify *verify, const char *path, const char *name, const char *part,
                       const char *recorded)
{
    char digest[65], *text = scene_part(verify->scene, part);
    int result = text ? text_sha256(text, digest) : -1;
    free(text);
    if (result == 0 && strcmp(digest, recorded))
        complain(verify, path, name, "says something else for this stage than when the file was made");
    return result;
}

/* Files record bare names: a stranger's file leads nowhere else. */
static int is_file_name(const char *name)
{
    return *name && !strchr(name, '/') && strcmp(name, ".") && strcmp(name, "..");
}

/* Always -1, with the error line. */
static int not_readable(const char *path)
{
    return error_input("%s: its list of inputs is not readable: make the file again", path);
}

static int verify_input(struct verify *verify, const char *path, const char *name, const char *recorded)
{
    char *raw = strdup(name); /* the file's own name, docs/files.md */
    if (!raw)
        return error_memory("the name of an input");
    text_unescape(raw);
    if (!is_file_name(raw)) {
        free(raw);
        return not_readable(path);
    }
    char *input = find_input(verify, path, raw);
    free(raw);
    const char *digest = input && !access(input, R_OK) ? digest_of(verify, input) : "";
    if (digest && !*digest)
        complain(verify, path, name, "is not there any more");
    else if (digest && strcmp(digest, recorded))
        complain(verify, path, name, "is not what the file was made from");
    free(input);
    return digest ? 0 : error_context("%s", path);
}

/* One entry of the list: {"name", "sha256"} and, for the scene, "part". */
static int verify_item(struct verify *verify, const char *path, const struct json *json, const cJSON *input)
{
    const char *name = NULL, *part = NULL, *recorded = NULL;
    verify->count.inputs++;
    if (!cJSON_IsObject(input) || json_string(json, input, "name", &name) != 1 ||
        json_string(json, input, "sha256", &recorded) != 1)
        return not_readable(path);
    return json_string(json, input, "part", &part) == 1 ? verify_part(verify, path, name, part, recorded)
                                                        : verify_input(verify, path, name, recorded);
}

/* All inputs of one file. A file without any was not made by this program, or by one that kept no record: an error
 * of input, which the caller turns into a finding. */
static int verify_inputs(struct verify *verify, const char *path, const struct state_info *info)
{
    struct json *json = info->inputs ? json_parse(info->inputs, strlen(info->inputs), path) : NULL;
    const cJSON *list = json ? json_root(json) : NULL;
    int result = 0;
    if (info->inputs && !json)
        return -1;
    if (!cJSON_IsArray(list) || !list->child)
        result = error_input("%s: records no inputs: make the file again", path);
    for (const cJSON *input = result ? NULL : list->child; input && !result; input = input->next)
        result = verify_item(verify, path, json, input);
    json_free(json);
    return result;
}

/* What is wrong with one file is a line of the report; the others are verified all the same. */
static int report_wrong(struct verify *verify)
{
    if (error_status() != EXIT_INPUT)
        return -1;
    text_print(verify->stream, error_message());
    fputc('\n', verify->stream);
    verify->count.wrong++;
    error_clear();
    return 0;
}

/* ---- pictures, tables, pages ---- */

static int has_no_checksums(const char *path)
{
    static const char *const endings[] = {".png", ".csv", ".html"};
    const char *ending = strrchr(basename(path), '.');
    for (size_t k = 0; ending && k < sizeof endings / sizeof *endings; k++)
        if (!strcmp(ending, endings[k]))
            return 1;
    return 0;
}

/* "SHA-256  NAME": the file itself, or a state that it was made from. */
static int verify_sum(struct verify *verify, const char *path, char *line)
{
    char *name = line + 66;
    if (strspn(line, "0123456789abcdef") != 64 || strncmp(line + 64, "  ", 2) || !is_file_name(name))
        return not_readable(path);
    if (strcmp(name, basename(path))) {
        verify->count.inputs++;
        line[64] = '\0';
        return verify_input(verify, path, name, line);
    }
    const char *digest = digest_of(verify, path);
    if (digest && strncmp(digest, line, 64))
        complain(verify, path, "the file", "is not what its stage wrote: make it again");
    return digest ? 0 : -1;
}

static int verify_sums(struct verify *verify, const char *path)
{
    char *sums = NULL, *line = NULL;
    size_t room = 0;
    const char *name = basename(path);
    int result = 0, own = 0;
    if (asprintf(&sums, "%.*s.sums/%s", (int)(name - path), path, name) < 0)
        return error_memory("a path");
    FILE *file = access(sums, F_OK) ? NULL : input_file_open(sums, INPUT_FILE_TEXT);
    for (ssize_t got; file && !result && (got = getline(&line, &room, file)) > 0;) {
        line[got - (line[got - 1] == '\n')] = '\0';
        own |= got > 66 && !strcmp(line + 66, name);
        result = verify_sum(verify, path, line);
    }
    if (file)
        fclose(file);
    if (!result && !own)
        result = error_input("%s: its SHA-256 was not recorded: make it again", path);
    free(line);
    free(sums);
    return result;
}

/* ---- all files ---- */

static int verify_file(struct verify *verify, const char *path)
{
    struct loaded loaded;
    verify->count.files++;
    if (has_no_checksums(path))
        return verify_sums(verify, path) ? report_wrong(verify) : 0;
    if (loaded_read(path, &loaded))
        return report_wrong(verify);
    const struct state_info *info = loaded_info(&loaded);
    verify->count.of_others += strcmp(info->program_version, film_version) != 0;
    int result = verify_inputs(verify, path, info);
    loaded_free(&loaded);
    return result ? report_wrong(verify) : 0;
}

int verify_files(const struct scene *scene, char *const paths[], size_t count, FILE *stream, struct verify_count *found)
{
    struct verify verify = {.scene = scene, .stream = stream};
    int result = 0;
    for (size_t k = 0; k < count && result == 0; k++)
        result = verify_file(&verify, paths[k]);
    tdestroy(verify.known, free);
    *found = verify.count;
    return result;
}
