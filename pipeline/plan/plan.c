/* Which result is made from which. Inside a block of photos.block photos the search in each photo starts from the one
 * before that is there, so that blocks can run side by side; contacts and forces go through the whole series in the
 * order of the photos, because increments, and forces that start from the previous ones, need the state before. */
#include "pipeline/plan/plan.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/plan/shell_word.h"
#include "pipeline/scene/scene_part.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

/* make keeps some 10 kB per photo. Together, the names of all contacts are words of one command: at 19 bytes each,
 * 10,000 of them are far below the 2 MB that Linux lets it have. */
enum { MOST_PHOTOS = 100000, MOST_TOGETHER = 10000 };

const char *const PLAN_STAGE[PLAN_STAGES] = {"findgrains", "tracker", "contacts", "forces", "report"};

/* What makes a result, behind the name of the stage's program. Words in capitals stand for what put_word() says; where
 * that is a file, the result is made from it. */
static const struct row {
    const char *ending;
    enum plan_stage stage;
    const char *job, *command;
} rows[] = {[RESULT_GRAINS] = {"grains.hdf", PLAN_FINDGRAINS, "grains", "SCENE --picture PICTURE REFERENCE"},
            [RESULT_TRACKS] = {"tracks.hdf", PLAN_TRACKER, "tracks",
                               "SCENE --grains GRAINS --reference REFERENCE BEFORE_IN_BLOCK PHOTO"},
            [RESULT_CONTACTS] = {"contacts.hdf", PLAN_CONTACTS, "contacts", "SCENE BEFORE TRACKS"},
            [RESULT_TABLE] = {"series.csv", PLAN_FORCES, "forces", "SCENE --method series START ALL_CONTACTS"},
            [RESULT_FORCES] = {"forces.hdf", PLAN_FORCES, "forces", "SCENE METHOD START BEFORE CONTACTS"},
            [RESULT_PICTURE] = {"forces.png", PLAN_REPORT, "forces", "map FIRST_METHOD FORCES"},
            [RESULT_PAGE] = {"report.html", PLAN_REPORT, "page", "page SCENE ALL_STATES"}};

/* ---- the series ---- */

static char *absolute(const char *path)
{
    char here[PATH_MAX] = "", *whole = NULL;
    int relative = *path != '/';
    if ((relative && !getcwd(here, sizeof here)) || asprintf(&whole, "%s%s%s", here, relative ? "/" : "", path) < 0) {
        error_set(EXIT_FAILED, "%s: the folder that we are in cannot be told, or memory is out", path);
        return NULL;
    }
    return whole;
}

/* What the drivers compare with an earlier run's. */
static char *part_of(const struct plan *plan, enum plan_stage stage)
{
    char *part = scene_part(plan->scene, PLAN_STAGE[stage]), *whole = NULL;
    int with_words = stage == PLAN_FORCES || stage == PLAN_REPORT, length = -1;
    if (part)
        length = with_words ? asprintf(&whole, "%s\n%s %s\n", part, plan->words.method, plan->words.start)
                            : asprintf(&whole, "%s\n", part);
    free(part);
    if (length < 0)
        error_set(EXIT_FAILED, "out of memory: plan: use a machine with more memory");
    return length < 0 ? NULL : whole;
}

/* The command line comes before the scene; a scene whose method is no text is left to forces, which refuses it. */
static int is_together(const struct plan *plan)
{
    const cJSON *forces = scene_section(plan->scene, "forces");
    const char *method = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(forces, "method"));
    if (*plan->words.method)
        method = plan->words.method;
    return method && !strcmp(method, "series");
}

/* Number of each photo that counts, and whether its file can be read. */
static int list_photos(struct plan *plan)
{
    plan->number = malloc((size_t)plan->photos * sizeof *plan->number);
    plan->there = malloc((size_t)plan->photos);
    if (!plan->number || !plan->there)
        return error_memory("plan");
    long index = plan->scene->photos.first - 1;
    for (long k = 0; k < plan->photos; k++) {
        plan->number[k] = index = scene_photo_next(plan->scene, index);
        char *path = scene_photo_path(plan->scene, index);
        plan->there[k] = !path || !access(path, R_OK); /* a path that is refused: its product says why */
        free(path);
    }
    return 0;
}

int plan_make(struct plan *plan, const struct scene *scene, const struct plan_words *words)
{
    const struct scene_photos *photos = &scene->photos;
    *plan = (struct plan){.scene = scene,
                          .words = *words,
                          .folder = -1,
                          .photos = photos->last - photos->first + 1 - (long)photos->skip_count};
    if (!photos->pattern)
        return scene_lacks(scene, "photos.pattern", "write for example \"photos/{index:04d}.tif\"");
    plan->together = is_together(plan);
    long most = plan->together ? MOST_TOGETHER : MOST_PHOTOS;
    if (plan->photos > most)
        return error_input("%s: photos.first to photos.last are %ld photos: give at most %ld to one scene, the others "
                           "to scenes of their own",
                           scene->path, plan->photos, most);
    plan->count = 4 * (size_t)plan->photos + 2 + (plan->together != 0);
    plan->folder = open(words->out, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int failed = list_photos(plan) || !(plan->scene_path = absolute(scene->path));
    for (int stage = 0; stage < PLAN_STAGES && !failed; stage++)
        failed = !(plan->part[stage] = part_of(plan, stage));
    if (failed)
        plan_free(plan);
    return failed ? -1 : 0;
}

void plan_free(struct plan *plan)
{
    for (int stage = 0; stage < PLAN_STAGES; stage++)
        free(plan->part[stage]);
    free(plan->scene_path);
    free(plan->number);
    free(plan->there);
    if (plan->folder >= 0)
        close(plan->folder);
    *plan = (struct plan){.folder = -1};
}

/* ---- names ---- */

/* Four digits at least, so that names sort as photos do up to 9999. */
static struct plan_name name_of(const struct plan *plan, enum plan_kind kind, long photo)
{
    struct plan_name result = {kind, photo, ""};
    const struct scene_photos *photos = &plan->scene->photos;
    long index = kind == RESULT_GRAINS ? photos->reference : plan->number[photo];
    if (kind == RESULT_TABLE || kind == RESULT_PAGE)
        strcpy(result.name, rows[kind].ending);
    else
        snprintf(result.name, sizeof result.name, "%04ld.%s", index, rows[kind].ending);
    return result;
}

struct plan_name plan_name(const struct plan *plan, size_t k)
{
    size_t photos = (size_t)plan->photos;
    const size_t members[] = {1, photos, photos, plan->together != 0, photos, photos, 1};
    int kind = RESULT_GRAINS;
    for (; kind < RESULT_PAGE && k >= members[kind]; kind++)
        k -= members[kind];
    return name_of(plan, kind, (long)k);
}

int plan_is_made(const struct plan *plan, const struct plan_name *of, unsigned kinds)
{
    return (kinds >> of->kind & 1) && (of->kind == RESULT_GRAINS || plan->there[of->photo]);
}

static long block_of(const struct plan *plan, long photo)
{
    return (plan->number[photo] - plan->scene->photos.first) / plan->scene->photos.block;
}

/* The last photo before this one that is there; -1: none. */
static long before(const struct plan *plan, long photo)
{
    do
        photo--;
    while (photo >= 0 && !plan->there[photo]);
    return photo;
}

/* ---- one result ---- */

/* A product while it is being described; one failure is enough. */
struct writer {
    const struct plan *plan;
    struct product *product;
    FILE *command, *needs;
    long needs_some; /* how many */
    int failed;
};

/* A word of the command, behind an option where that is not "". */
static void put(struct writer *w, const char *option, const char *text)
{
    fprintf(w->command, " %s%s", option, *option ? " " : "");
    shell_word(w->command, text);
}

static void need(struct writer *w, const char *name)
{
    fprintf(w->needs, "%s%s", w->needs_some++ ? " " : "", name);
}

/* Another result as a word: the product is made from it. */
static void put_result(struct writer *w, const char *option, enum plan_kind kind, long photo)
{
    struct plan_name other = name_of(w->plan, kind, photo);
    need(w, other.name);
    put(w, option, other.name);
}

/* Takes the path, also where it is NULL after a failure; returns it for the command. */
static const char *reads(struct writer *w, char *path)
{
    char *whole = path ? absolute(path) : NULL;
    free(path);
    if (!whole)
        w->failed = -1;
    else
        w->product->reads[w->product->read_count++] = whole;
    return whole ? whole : "";
}

/* All results of these kinds (bits), of the photos that are there. */
static void need_all(struct writer *w, unsigned kinds)
{
    for (size_t k = 0; k < w->plan->count; k++) {
        struct plan_name other = plan_name(w->plan, k);
        if (plan_is_made(w->plan, &other, kinds))
            need(w, other.name);
    }
}

/* A word with '.' or '/' that is the name of a file is one to start from: the words that forces knows have neither. */
static void put_start(struct writer *w)
{
    const char *start = w->plan->words.start;
    if (*start)
        put(w, "--start", strpbrk(start, "./") && !access(start, F_OK) ? reads(w, strdup(start)) : start);
}

/* The methods of forces, or as many letters of them; where nobody names one the programs choose. */
static void put_method(struct writer *w, const char *method, size_t length)
{
    char *part = strndup(method, length);
    if (!part)
        w->failed = error_memory("plan");
    else if (*part)
        put(w, "--method", part);
    free(part);
}

static void put_word(struct writer *w, const char *word)
{
    const struct plan *plan = w->plan;
    const struct scene_photos *photos = &plan->scene->photos;
    const char *method = plan->together ? "series" : plan->words.method;
    struct plan_name of = w->product->of;
    char picture[40];
    if (!strcmp(word, "SCENE"))
        put(w, plan->words.allow_outside ? "--allow-outside --scene" : "--scene", plan->scene_path);
    else if (!strcmp(word, "PHOTO") || !strcmp(word, "REFERENCE"))
        put(w, "", reads(w, scene_photo_path(plan->scene, *word == 'R' ? photos->reference : plan->number[of.photo])));
    else if (!strcmp(word, "GRAINS"))
        put_result(w, "", RESULT_GRAINS, 0);
    else if (!strcmp(word, "TRACKS"))
        put_result(w, "", RESULT_TRACKS, of.photo);
    else if (!strcmp(word, "CONTACTS"))
        put_result(w, "", RESULT_CONTACTS, of.photo);
    else if (!strcmp(word, "FORCES"))
        put_result(w, "", RESULT_FORCES, of.photo);
    else if (!strcmp(word, "BEFORE") || !strcmp(word, "BEFORE_IN_BLOCK")) {
        long from = before(plan, of.photo);
        if (from >= 0 && (!word[6] || block_of(plan, from) == block_of(plan, of.photo)))
            put_result(w, "--previous", of.kind, from);
    } else if (!strcmp(word, "METHOD"))
        put_method(w, method, strlen(method));
    else if (!strcmp(word, "FIRST_METHOD"))
        put_method(w, method, strcspn(method, ","));
    else if (!strcmp(word, "START"))
        put_start(w);
    else if (!strcmp(word, "ALL_CONTACTS")) {
        fputs(" $(<" PLAN_CONTACTS_LIST ")", w->command); /* as text of a recipe they are longer than one may be */
        need_all(w, 1 << RESULT_CONTACTS);
    } else if (!strcmp(word, "ALL_STATES")) {
        put(w, "--list", PLAN_PAGE_LIST);
        need_all(w, PLAN_STATES);
    } else if (!strcmp(word, "PICTURE")) {
        snprintf(picture, sizeof picture, "%04ld.grains.png", photos->reference);
        put(w, "", picture);
    } else
        put(w, "", word);
}

/* The runner where there is one, the stage's program, and the words of the row with what they stand for. */
static void put_command(struct writer *w, const struct row *row)
{
    char *path = NULL, word[24];
    if (asprintf(&path, "%s/%s", w->plan->words.programs, PLAN_STAGE[row->stage]) < 0) {
        w->failed = error_memory("plan");
        return;
    }
    if (*w->plan->words.runner) {
        shell_word(w->command, w->plan->words.runner);
        fprintf(w->command, " %s ", w->product->of.name);
    }
    shell_word(w->command, path);
    free(path);
    for (const char *c = row->command; sscanf(c, "%23s", word) == 1; c += strspn(c, " ") + strlen(word))
        put_word(w, word);
}

/* Where forces are inferred together, a photo's file is made by the command of series.csv, the last one it writes. The
 * lens and the loads are read as the scene says and stand in no command. */
static void describe(struct writer *w)
{
    const char *paths[2];
    const struct row *row = &rows[w->product->of.kind];
    if (w->plan->together && w->product->of.kind == RESULT_FORCES) {
        need(w, rows[RESULT_TABLE].ending);
        return;
    }
    put_command(w, row);
    size_t count = scene_part_files(w->plan->scene, PLAN_STAGE[row->stage], paths);
    for (size_t k = 0; k < count; k++)
        reads(w, strdup(paths[k]));
}

/* One job per block and stage; the pictures go with the forces that they show. */
static void name_job(const struct plan *plan, struct product *product)
{
    enum plan_kind kind = product->of.kind;
    int whole = kind == RESULT_GRAINS || kind == RESULT_PAGE || (kind >= RESULT_TABLE && plan->together);
    if (whole)
        strcpy(product->job, rows[kind].job);
    else
        snprintf(product->job, sizeof product->job, "%s_%ld", rows[kind].job, block_of(plan, product->of.photo));
}

int plan_product(const struct plan *plan, size_t k, struct product *product)
{
    size_t sizes[2];
    *product = (struct product){.of = plan_name(plan, k)};
    product->stage = rows[product->of.kind].stage;
    name_job(plan, product);
    struct writer w = {.plan = plan, .product = product};
    w.command = open_memstream(&product->command, &sizes[0]);
    w.needs = open_memstream(&product->needs, &sizes[1]);
    if (w.command && w.needs)
        describe(&w);
    int cut = !w.command || fclose(w.command);
    cut |= !w.needs || fclose(w.needs);
    if (cut && !w.failed)
        w.failed = error_memory("plan");
    if (w.failed)
        product_free(product);
    return w.failed;
}

void product_free(struct product *product)
{
    for (size_t k = 0; k < product->read_count; k++)
        free(product->reads[k]);
    free(product->command);
    free(product->needs);
    *product = (struct product){0};
}
