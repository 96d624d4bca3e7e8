/* Which result is made from which. Inside a block of photos.block photos the search in each photo starts from the one
 * before, so that blocks can run side by side; contacts and forces go through the whole series in the order of the
 * photos, because increments, and forces that start from the previous ones, need the state before. */
#include "pipeline/plan/plan.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/plan/plan_text.h"
#include "pipeline/scene/scene_part.h"
#include "pipeline/speak/error.h"

enum { MOST_PHOTOS = 100000, MOST_TOGETHER = 10000 };

const char *const PLAN_STAGE[PLAN_STAGES] = {"findgrains", "tracker", "contacts", "forces", "report"};
static const enum plan_stage stage_of[] = {PLAN_FINDGRAINS, PLAN_TRACKER, PLAN_CONTACTS, PLAN_FORCES,
                                           PLAN_FORCES,     PLAN_REPORT,  PLAN_REPORT};

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
        length = with_words ? asprintf(&whole, "%s\n%s %s\n", part, plan->method, plan->start)
                            : asprintf(&whole, "%s\n", part);
    free(part);
    if (length < 0)
        error_set(EXIT_FAILED, "out of memory: plan: use a machine with more memory");
    return length < 0 ? NULL : whole;
}

static int is_together(const struct plan *plan)
{
    const cJSON *forces = scene_section(plan->scene, "forces");
    const char *method = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(forces, "method"));
    if (*plan->method)
        method = plan->method;
    return method && !strcmp(method, "series");
}

int plan_make(struct plan *plan, const struct scene *scene, const struct plan_words *words)
{
    const struct scene_photos *photos = &scene->photos;
    *plan = (struct plan){.scene = scene,
                          .out = words->out,
                          .method = words->method,
                          .start = words->start,
                          .programs = words->programs,
                          .runner = words->runner,
                          .allow_outside = words->allow_outside,
                          .photos = photos->last - photos->first + 1};
    if (!photos->pattern)
        return scene_lacks(scene, "photos.pattern", "write for example \"photos/{index:04d}.tif\"");
    plan->together = is_together(plan);
    long most = plan->together ? MOST_TOGETHER : MOST_PHOTOS;
    if (plan->photos > most)
        return error_input("%s: photos.first to photos.last are %ld photos: give at most %ld to one scene, the others "
                           "to scenes of their own",
                           scene->path, plan->photos, most);
    plan->count = 4 * (size_t)plan->photos + 2 + (plan->together != 0);
    int failed = !(plan->scene_path = absolute(scene->path));
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
    *plan = (struct plan){0};
}

/* ---- names ---- */

static struct plan_name name_of(const struct plan *plan, enum plan_kind kind, long photo)
{
    static const char *const endings[] = {"grains.hdf", "tracks.hdf", "contacts.hdf", "", "forces.hdf", "forces.png"};
    struct plan_name result = {kind, photo, ""};
    const struct scene_photos *photos = &plan->scene->photos;
    long index = kind == RESULT_GRAINS ? photos->reference : photos->first + photo;
    if (kind == RESULT_TABLE || kind == RESULT_PAGE)
        strcpy(result.name, kind == RESULT_TABLE ? "series.csv" : "report.html");
    else
        snprintf(result.name, sizeof result.name, "%04ld.%s", index, endings[kind]);
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

/* ---- one result ---- */

/* A product while it is being described; one failure is enough. */
struct writer {
    const struct plan *plan;
    struct product *product;
    FILE *command, *needs;
    int failed;
};

/* Words of the command that need no quoting, and a word that may. */
static void put(struct writer *w, const char *words)
{
    fprintf(w->command, " %s", words);
}

static void put_quoted(struct writer *w, const char *word)
{
    fputc(' ', w->command);
    plan_quote(w->command, word);
}

static void put_program(struct writer *w, const char *command)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", w->plan->programs, PLAN_STAGE[w->product->stage]) < 0) {
        w->failed = error_memory("plan");
        return;
    }
    if (*w->plan->runner) {
        plan_quote(w->command, w->plan->runner);
        fprintf(w->command, " %s ", w->product->of.name);
    }
    plan_quote(w->command, path);
    free(path);
    if (command)
        put(w, command);
    if (!command || !strcmp(command, "page")) {
        put(w, w->plan->allow_outside ? "--allow-outside --scene" : "--scene");
        put_quoted(w, w->plan->scene_path);
    }
}

/* The result is made from another one, which the command names after `option`; "": just the name; NULL: not there. */
static void need(struct writer *w, const char *option, enum plan_kind kind, long photo)
{
    struct plan_name other = name_of(w->plan, kind, photo);
    fprintf(w->needs, "%s%s", ftell(w->needs) > 0 ? " " : "", other.name);
    if (option)
        fprintf(w->command, " %s%s%s", option, *option ? " " : "", other.name);
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

static const char *reads_photo(struct writer *w, long index)
{
    return reads(w, scene_photo_path(w->plan->scene, index));
}

static void reads_files_of_scene(struct writer *w)
{
    const char *paths[2];
    size_t count = scene_part_files(w->plan->scene, PLAN_STAGE[w->product->stage], paths);
    for (size_t k = 0; k < count; k++)
        reads(w, strdup(paths[k]));
}

/* A word with '.' or '/' that is the name of a file is one to start from: the words that forces knows have neither. */
static void put_start(struct writer *w)
{
    const char *start = w->plan->start;
    if (!*start)
        return;
    put(w, "--start");
    put_quoted(w, strpbrk(start, "./") && !access(start, F_OK) ? reads(w, strdup(start)) : start);
}

static void describe_grains(struct writer *w)
{
    const struct scene_photos *photos = &w->plan->scene->photos;
    put_program(w, NULL);
    fprintf(w->command, " --picture %04ld.grains.png", photos->reference);
    put_quoted(w, reads_photo(w, photos->reference));
}

static void describe_tracks(struct writer *w, long photo)
{
    const struct scene_photos *photos = &w->plan->scene->photos;
    put_program(w, NULL);
    need(w, "--grains", RESULT_GRAINS, 0);
    put(w, "--reference");
    put_quoted(w, reads_photo(w, photos->reference));
    if (photo % photos->block)
        need(w, "--previous", RESULT_TRACKS, photo - 1);
    put_quoted(w, reads_photo(w, photos->first + photo));
}

static void describe_contacts(struct writer *w, long photo)
{
    put_program(w, NULL);
    if (photo)
        need(w, "--previous", RESULT_CONTACTS, photo - 1);
    need(w, "", RESULT_TRACKS, photo);
}

static void describe_table(struct writer *w)
{
    put_program(w, NULL);
    put(w, "--method series");
    put_start(w);
    put(w, "$(<" PLAN_CONTACTS_LIST ")"); /* as words of a recipe they are longer than one may be */
    for (long photo = 0; photo < w->plan->photos; photo++)
        need(w, NULL, RESULT_CONTACTS, photo);
}

static void describe_forces(struct writer *w, long photo)
{
    if (w->plan->together) {
        need(w, NULL, RESULT_TABLE, 0);
        return;
    }
    put_program(w, NULL);
    if (*w->plan->method) {
        put(w, "--method");
        put_quoted(w, w->plan->method);
    }
    put_start(w);
    if (photo)
        need(w, "--previous", RESULT_FORCES, photo - 1);
    need(w, "", RESULT_CONTACTS, photo);
}

/* The picture shows the first of the methods. */
static void describe_picture(struct writer *w, long photo)
{
    const char *method = w->plan->together ? "series" : w->plan->method;
    char *first = strndup(method, strcspn(method, ","));
    put_program(w, "map");
    if (!first)
        w->failed = error_memory("plan");
    else if (*first) {
        put(w, "--method");
        put_quoted(w, first);
    }
    free(first);
    need(w, "", RESULT_FORCES, photo);
}

static void describe_page(struct writer *w)
{
    put_program(w, "page");
    put(w, "--list " PLAN_PAGE_LIST);
    for (size_t k = 0; k < w->plan->count; k++) {
        struct plan_name other = plan_name(w->plan, k);
        if (other.kind != RESULT_TABLE && other.kind != RESULT_PICTURE && other.kind != RESULT_PAGE)
            need(w, NULL, other.kind, other.photo);
    }
}

static void describe(struct writer *w)
{
    long photo = w->product->of.photo;
    switch (w->product->of.kind) {
    case RESULT_GRAINS:
        describe_grains(w);
        break;
    case RESULT_TRACKS:
        describe_tracks(w, photo);
        break;
    case RESULT_CONTACTS:
        describe_contacts(w, photo);
        break;
    case RESULT_TABLE:
        describe_table(w);
        break;
    case RESULT_FORCES:
        describe_forces(w, photo);
        break;
    case RESULT_PICTURE:
        describe_picture(w, photo);
        break;
    case RESULT_PAGE:
        describe_page(w);
        break;
    }
    reads_files_of_scene(w);
}

/* One job per block and stage; the pictures go with the forces that they show. */
static void name_job(const struct plan *plan, struct product *product)
{
    static const char *const jobs[] = {"grains", "tracks", "contacts", "forces", "forces", "forces", "page"};
    enum plan_kind kind = product->of.kind;
    int whole = kind == RESULT_GRAINS || kind == RESULT_PAGE || (kind >= RESULT_TABLE && plan->together);
    int used = snprintf(product->job, sizeof product->job, "%s", jobs[kind]);
    if (!whole)
        snprintf(product->job + used, sizeof product->job - (size_t)used, "_%ld",
                 product->of.photo / plan->scene->photos.block);
}

int plan_product(const struct plan *plan, size_t k, struct product *product)
{
    size_t sizes[2];
    *product = (struct product){.of = plan_name(plan, k)};
    product->stage = stage_of[product->of.kind];
    name_job(plan, product);
    struct writer w = {.plan = plan, .product = product};
    w.command = open_memstream(&product->command, &sizes[0]);
    w.needs = open_memstream(&product->needs, &sizes[1]);
    if (w.command && w.needs)
        describe(&w);
    else
        w.failed = error_memory("plan");
    int cut = (w.command && fclose(w.command)) + (w.needs && fclose(w.needs));
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
