/* The contact network from rendered photos, against what was drawn.
 *
 *     bench_network [--as-is] FOLDER... folders of tests/bench/network_photos; --as-is: nothing injected
 *     bench_network --box FILE SCALE    width and height between the walls of a packing, px
 *
 * For every folder and injected radius offset: what `--radius-offset auto` finds, precision, recall and F1 of the
 * contacts (between grains that were found and are not flagged) and of those without rattlers, the best plain threshold
 * chosen with the truth; then, over all folders, the reliability of the probabilities, the errors of overlaps and of
 * motions against what is stated. A true contact is a pair of drawn faces, or a face and a wall, that overlap. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contacts/files.h"
#include "contacts/find_contacts.h"
#include "network_score.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"

enum { INJECTED = 5 };
static const double injected_px[INJECTED] = {0, -0.3, -0.1, 0.1, 0.3};
static int injections = INJECTED;

/* Sums of (error, stated error) for RMS values. */
struct spread {
    double square, stated, ratio, count;
};

static void spread_add(struct spread *spread, double error, double stated)
{
    if (!isfinite(error) || !(stated > 0))
        return;
    spread->square += error * error;
    spread->stated += stated * stated;
    spread->ratio += pow(error / stated, 2);
    spread->count++;
}

static struct {
    struct spread overlap, wall_overlap, un, dun, wall_un, offset;
    struct network_figures figures;
    struct network_figures once; /* without the injected offsets: every pair counts once */
    double found, drawn;         /* contacts, also of grains that were not found */
} all;

/* One photo with its truth. */
struct view {
    struct photo_state photo;
    struct photo_grains drawn;
    struct packing truth;     /* walls of the simulation */
    struct contacts contacts; /* of the faces as drawn */
    long *row;                /* found grain -> drawn grain; -1: none */
    unsigned char *seen;      /* drawn grains that were found */
    double lost;              /* drawn grains that were not */
    double offset;            /* px: median of drawn radius less found radius */
};

static void view_free(struct view *view)
{
    photo_state_free(&view->photo);
    table_free(&PHOTO_GRAINS, &view->drawn);
    table_free(&CONTACTS, &view->contacts);
    packing_free(&view->truth);
    free(view->row);
    free(view->seen);
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int match(struct view *view)
{
    const struct photo_grains *found = &view->photo.grains, *drawn = &view->drawn;
    double *difference = malloc((found->count + 1) * sizeof *difference);
    size_t n = 0;
    view->row = malloc((found->count + 1) * sizeof *view->row);
    view->seen = calloc(drawn->count + 1, 1);
    if (!view->row || !view->seen || !difference) {
        free(difference);
        return error_memory("rows");
    }
    for (size_t k = 0; k < found->count; k++) {
        double nearest = 0.5 * found->radius_px[k];
        view->row[k] = -1;
        for (size_t m = 0; m < drawn->count; m++) {
            double d = hypot(found->x_px[k] - drawn->x_px[m], found->y_px[k] - drawn->y_px[m]);
            if (d < nearest) {
                nearest = d;
                view->row[k] = (long)m;
            }
        }
        if (found->flags[k] & GRAIN_DISTRUST) /* measured badly, and known to be */
            view->row[k] = -1;
        if (view->row[k] >= 0)
            difference[n++] = drawn->radius_px[view->row[k]] - found->radius_px[k];
        if (view->row[k] >= 0)
            view->seen[view->row[k]] = 1;
    }
    for (size_t m = 0; m < drawn->count; m++)
        view->lost += !view->seen[m];
    qsort(difference, n, sizeof *difference, by_value);
    view->offset = n ? difference[n / 2] : 0;
    free(difference);
    return 0;
}

static int view_read(const char *folder, int index, struct view *view)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", NULL}, *const pairs[] = {"i", "j", "overlap",
                                                                                                NULL};
    char path[4096];
    *view = (struct view){0};
    snprintf(path, sizeof path, "%s/%s", folder, index ? "0001.tracks.hdf" : "0000.grains.hdf");
    if (photo_state_read(path, &view->photo))
        return -1;
    snprintf(path, sizeof path, "%s/truth/%04d.truth.hdf", folder, index);
    if (packing_read(path, &view->truth))
        return -1;
    snprintf(path, sizeof path, "%s/truth/%04d.photo-truth.hdf", folder, index);
    struct state *file = state_open(path);
    if (!file)
        return -1;
    int status = state_read(file, "grains", &PHOTO_GRAINS, columns, &view->drawn) ||
                         state_read(file, "contacts", &CONTACTS, pairs, &view->contacts)
                     ? -1
                     : 0;
    state_close(file);
    return status || match(view) ? -1 : 0;
}

/* A drawn contact between bodies that were found: what a contact finder can be asked for. */
static int is_wanted(const struct view *view, size_t c)
{
    size_t i = (size_t)view->contacts.i[c], j = (size_t)view->contacts.j[c];
    return view->contacts.overlap[c] > 0 && view->seen[i] && (j >= view->drawn.count || view->seen[j]);
}

/* The drawn pair of a found one, i < j in the drawn numbering; 0 when a grain has no match. */
static int drawn_pair(const struct view *view, const struct packing *found, size_t c, int64_t *i, int64_t *j)
{
    int64_t n = (int64_t)found->grains.count, grains = (int64_t)view->drawn.count;
    *i = view->row[found->contacts.i[c]];
    *j = found->contacts.j[c] < n
             ? view->row[found->contacts.j[c]]
             : grains + walls_find(&view->truth.walls, found->walls.name[found->contacts.j[c] - n]);
    if (*i < 0 || *j < 0)
        return 0;
    if (*j < *i) {
        int64_t swap = *i;
        *i = *j;
        *j = swap;
    }
    return 1;
}

/* Overlap of a drawn pair, m; -1: apart. */
static double drawn_contact(const struct view *view, int64_t i, int64_t j)
{
    for (size_t c = 0; c < view->contacts.count; c++)
        if (view->contacts.i[c] == i && view->contacts.j[c] == j)
            return view->contacts.overlap[c];
    return -1;
}

/* Distance of the drawn centres, or of a centre from the wall, px. */
static double drawn_distance(const struct view *view, double scale, int64_t i, int64_t j)
{
    const struct grains *grains = &view->truth.grains;
    if ((size_t)j < grains->count)
        return hypot(view->drawn.x_px[j] - view->drawn.x_px[i], view->drawn.y_px[j] - view->drawn.y_px[i]);
    size_t w = (size_t)j - grains->count;
    struct vec from = vec_sub(vec(grains->x[i], grains->y[i]), vec(view->truth.walls.x0[w], view->truth.walls.y0[w]));
    return vec_dot(from, wall_inward(&view->truth.walls, w)) / scale;
}

static double drawn_overlap(const struct view *view, double scale, int64_t i, int64_t j)
{
    double sum = view->drawn.radius_px[i];
    if ((size_t)j < view->drawn.count)
        sum += view->drawn.radius_px[j];
    for (size_t c = 0; c < view->contacts.count; c++) /* with its shapes, where it is drawn as a contact */
        if (view->contacts.i[c] == i && view->contacts.j[c] == j)
            return view->contacts.overlap[c] / scale;
    return view->drawn.shape_c && view->drawn.shape_c[i] != 0 ? NAN : sum - drawn_distance(view, scale, i, j);
}

/* The pairs of the file beside their truth. */
static int pair_up(const struct view *view, const struct packing *found, double scale, struct scored_network *network)
{
    size_t n = view->photo.grains.count, drawn = view->drawn.count, wanted = 0, listed = 0, carrying = 0, walls = 0;
    unsigned char *carries = malloc(drawn + 1);
    if (!carries)
        return error_memory("grains that carry");
    network->mean = find_carrying(&view->contacts, drawn, carries);
    for (size_t c = 0; c < view->contacts.count; c++) {
        int is = is_wanted(view, c);
        wanted += is;
        carrying += is && view->contacts.overlap[c] > 0.01 * network->mean;
        walls += is && (size_t)view->contacts.j[c] >= drawn;
    }
    int status = 0;
    for (size_t c = 0; c < found->contacts.count && status == 0; c++) {
        int64_t i, j;
        if (!drawn_pair(view, found, c, &i, &j))
            continue;
        size_t a = (size_t)found->contacts.i[c], b = (size_t)found->contacts.j[c];
        struct scored_pair pair = {
            .overlap = found->contacts.overlap[c] / scale,
            .probability = found->contacts.probability[c],
            .truth = drawn_contact(view, i, j),
            .contact = !(found->contacts.flags[c] & CONTACT_CANDIDATE),
            .idle = ((found->grains.flags[a] | (b < n ? found->grains.flags[b] : 0)) & GRAIN_RATTLER) != 0,
            .wall = b >= n,
            .carries = carries[i] && ((size_t)j >= drawn || carries[j])};
        listed += pair.truth > 0;
        carrying -= pair.truth > 0.01 * network->mean;
        walls -= pair.truth > 0 && pair.wall;
        status = scored_network_add(network, pair);
    }
    network->missing = (double)(wanted - listed);
    network->missing_carrying = (double)carrying;
    network->missing_wall = (double)walls;
    free(carries);
    return status;
}

/* Precision, recall and F1 of one network, with a line of the table. */
static int score(const struct view *view, const struct packing *found, double scale, const char *folder, int index,
                 double injected, const struct contact_summary *summary)
{
    struct scored_network network = {0};
    struct network_figures one = {0};
    if (pair_up(view, found, scale, &network)) {
        scored_network_free(&network);
        return -1;
    }
    network_figures_add(&network, &one);
    network_figures_add(&network, &all.figures);
    if (injected == 0)
        network_figures_add(&network, &all.once);
    scored_network_free(&network);
    for (size_t c = 0; c < view->contacts.count; c++)
        all.drawn += view->contacts.overlap[c] > 0;
    all.found += one.all.right;
    double error = summary->radius_offset_px - (view->offset - injected);
    if (!summary->undecided && injected == 0)
        spread_add(&all.offset, error, summary->s_radius_offset_px);
    printf(
        "%-14.14s %d %+5.1f %7.3f %7.4f %6.4f | %6.4f %6.4f %6.4f  %6.4f %6.4f | %6.4f | %6.4f %6.4f %6.4f  %6.4f %4zu "
        "%3.0f %6.3f %6.3f %s\n",
        folder, index, injected, view->offset - injected, error, summary->s_radius_offset_px, precision(one.all),
        recall(one.all), f1(one.all), f1(one.best), recall(one.best), f1(one.bearing), precision(one.carrying),
        recall(one.carrying), f1(one.carrying), f1(one.best_carrying), summary->rattlers, view->lost,
        summary->mean_overlap_px, summary->s_overlap_px, summary->undecided ? summary->undecided : "");
    return 0;
}

/* Errors of overlaps and motions, px, for contacts of the photo as it is (nothing injected). */
static void errors(const struct view *first, const struct view *view, const struct packing *found, double scale,
                   int moved)
{
    const struct contacts *contacts = &found->contacts;
    for (size_t c = 0; c < contacts->count; c++) {
        int64_t i, j;
        if ((contacts->flags[c] & CONTACT_CANDIDATE) || !drawn_pair(view, found, c, &i, &j))
            continue;
        int wall = (size_t)j >= view->drawn.count;
        double error = contacts->overlap[c] / scale - drawn_overlap(view, scale, i, j);
        spread_add(wall ? &all.wall_overlap : &all.overlap, error, contacts->s_overlap[c] / scale);
        if (!moved)
            continue;
        double un = drawn_distance(view, scale, i, j) - drawn_distance(first, scale, i, j);
        spread_add(wall ? &all.wall_un : &all.un, contacts->un[c] / scale - un, contacts->s_un[c] / scale);
        if (!wall)
            spread_add(&all.dun, contacts->dun[c] / scale - un, contacts->s_dun[c] / scale);
    }
}

static int try_offset(const struct scene *scene, const struct view *view, const struct view *first, const char *folder,
                      int index, double injected, const struct packing *previous, struct packing *found)
{
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    struct contact_summary summary;
    struct contact_input input = {.scene = scene,
                                  .grains = &view->photo.grains,
                                  .patches = &view->photo.patches,
                                  .seen = !strcmp(view->photo.info.coordinates, "seen"),
                                  .previous = previous,
                                  .is_reference = index == 0};
    options.radius_offset_auto = 1;
    for (size_t k = 0; k < view->photo.grains.count; k++)
        view->photo.grains.radius_px[k] += injected;
    int status = find_contacts(&input, &options, found, &summary);
    for (size_t k = 0; k < view->photo.grains.count; k++)
        view->photo.grains.radius_px[k] -= injected;
    if (status)
        return -1;
    if (score(view, found, scene->scale, folder, index, injected, &summary))
        return -1;
    if (injected == 0)
        errors(first, view, found, scene->scale, index > 0);
    return 0;
}

static int folder_run(const char *folder)
{
    struct scene scene = {0};
    struct view view[2];
    struct packing reference = {0};
    char path[4096];
    const char *name = strrchr(folder, '/') ? strrchr(folder, '/') + 1 : folder;
    memset(view, 0, sizeof view);
    snprintf(path, sizeof path, "%s/scene.json", folder);
    int status = scene_read(path, &scene) || view_read(folder, 0, &view[0]) || view_read(folder, 1, &view[1]) ? -1 : 0;
    for (int index = 0; index < 2; index++)
        for (int k = 0; status == 0 && k < injections; k++) {
            struct packing found = {0};
            status = try_offset(&scene, &view[index], &view[0], name, index, injected_px[k],
                                index && reference.grains.count ? &reference : NULL, &found);
            if (index == 0 && injected_px[k] == 0)
                reference = found;
            else
                packing_free(&found);
        }
    packing_free(&reference);
    view_free(&view[0]);
    view_free(&view[1]);
    scene_free(&scene);
    return status;
}

static void print_spread(const char *name, const struct spread *spread)
{
    printf("%-36s %6.0f %9.4f %9.4f %9.2f\n", name, spread->count, sqrt(spread->square / spread->count),
           sqrt(spread->stated / spread->count), sqrt(spread->ratio / spread->count));
}

static void print_hits(const char *name, struct hits hits)
{
    printf("%-44s %9.4f %7.4f %7.4f %8.0f\n", name, precision(hits), recall(hits), f1(hits), hits.expected);
}

static void print_all(void)
{
    printf("\npooled                                       precision  recall      F1 expected\n");
    print_hits("all contacts", all.figures.all);
    print_hits("best threshold on the overlap, with the truth", all.figures.best);
    print_hits("without rattlers", all.figures.bearing);
    print_hits("carrying force", all.figures.carrying);
    print_hits("best threshold for these", all.figures.best_carrying);
    print_hits("walls", all.figures.walls);
    for (int r = 0; r < RULES; r++) {
        char name[40];
        snprintf(name, sizeof name, "probability above %.1f", 0.1 * (r + 1));
        print_hits(name, all.figures.rule[r]);
    }
    printf("recall with the contacts of lost grains %.4f\n", all.found / all.drawn);
    printf("\n%-36s %6s %9s %9s %9s\n", "px", "n", "RMS", "stated", "RMS of error/stated");
    print_spread("radius offset", &all.offset);
    print_spread("overlap, grains", &all.overlap);
    print_spread("overlap, walls", &all.wall_overlap);
    print_spread("un since the reference, grains", &all.un);
    print_spread("un since the reference, walls", &all.wall_un);
    print_spread("dun since the previous, grains", &all.dun);
    printf("\n");
    print_reliability(&all.once);
}

static int print_box(const char *path, double scale)
{
    struct packing packing = {0};
    if (packing_read(path, &packing))
        return -1;
    long right = walls_find(&packing.walls, "right"), top = walls_find(&packing.walls, "top");
    printf("%.0f %.0f\n", packing.walls.x0[right] / scale, packing.walls.y0[top] / scale);
    packing_free(&packing);
    return 0;
}

int main(int argc, char **argv)
{
    int status = 0;
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (argc == 4 && !strcmp(argv[1], "--box")) {
        status = print_box(argv[2], atof(argv[3]));
    } else {
        printf("folder      photo   off  needed   error stated | P      R      F1     best   its R  | F1 without "
               "rattlers | "
               "carrying: P, R, F1, best     rattlers lost overlap s_x\n");
        for (int a = 1; a < argc && status == 0; a++) {
            if (!strcmp(argv[a], "--as-is"))
                injections = 1;
            else
                status = folder_run(argv[a]);
        }
        if (status == 0)
            print_all();
    }
    if (status)
        fprintf(stderr, "bench_network: %s\n", error_message());
    return status != 0;
}
