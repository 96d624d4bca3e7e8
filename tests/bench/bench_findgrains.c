/* findgrains on rendered photos: speed against error, beside what else finds circles and the bound of what can be
 * found.
 *
 *     bench_findgrains [--seed N] [--grains N] [--case NAME]... [--peers] [--curve] [--unknown] [--json FILE]
 *                      [--save FOLDER]
 *
 * A packing of N discs (proportions of the real grading, radii 67 to 167 px, or 14 to 35 px in the case "small") is
 * compressed by the virtual test and photographed by the virtual camera. Centre: RMS per coordinate. x: overlap of
 * true contacts along the branch, of the faces as drawn. Bound: Cramer-Rao for the visible rim (more than 1.2 blurs
 * from anything else) and white noise only, with known grey levels (k) and with levels of their own on both sides in
 * every place, to be learnt from a band of 5 blurs on either side (u). --curve: pixel of the votes, band, sectors and
 * number of iterations against time and error. --unknown: findgrains is not told the range of radii. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "findgrains/capture/detect.h"
#include "findgrains/find_grains.h"
#include "findgrains/rims/measure.h"
#include "findgrains/rims/rims_table.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "simulation/render/render.h"
#include "tests/bench/find_score.h"
#include "tests/bench/packed.h"
#include "tests/bench/peers.h"

struct bench {
    uint64_t seed;
    long grains;
    int peers, first, curve, unknown;
    FILE *json;
    const char *save;
    struct photo_grains truth; /* px, circles; the faces' shapes are drawn per case */
    int width, height;
    double low, high; /* radii */
};

/* ---- the photos ---- */

static struct optics plain_optics(uint64_t seed)
{
    struct optics optics = OPTICS_DEFAULT;
    optics.seed = seed;
    optics.psf = 1.05;
    optics.bits = 16;
    optics.read_noise = 0.0075; /* 1.5 % of the grains' level */
    optics.shot_noise = 0;
    optics.grain = (struct surface){.level = 0.5, .spread = 0.12};
    return optics;
}

static struct optics speckled_optics(uint64_t seed, double dots)
{
    struct optics optics = plain_optics(seed);
    optics.grain.paint[0] = (struct paint){1.0, 3.0, 0.6 * dots, 0.08, 0.25};
    optics.grain.paint[1] = (struct paint){1.0, 3.0, 0.4 * dots, 0.6, 0.85};
    optics.grain.paint_count = 2;
    optics.ring_spacing = 9;
    optics.ring_contrast = 0.1;
    optics.shading = 0.1;
    optics.hollow.paint[0] = (struct paint){2, 8, 0.3, 0.02, 0.06};
    optics.hollow.paint_count = 1;
    return optics;
}

struct kind {
    const char *name;
    double scale; /* of the packing */
};
static const struct kind kinds[] = {
    {"clean", 1}, {"base", 1},  {"ellipse", 1}, {"specks30", 1},  {"lowcontrast", 1}, {"noise2", 1}, {"noise3", 1},
    {"psf07", 1}, {"psf15", 1}, {"shading", 1}, {"saturated", 1}, {"small", 0.21},    {"bevel", 1},  {NULL, 0}};

static struct optics case_optics(const char *name, uint64_t seed)
{
    struct optics optics = strcmp(name, "clean") ? speckled_optics(seed, 0.2) : plain_optics(seed);
    if (!strcmp(name, "ellipse"))
        optics.ellipticity = 0.01;
    else if (!strcmp(name, "specks30"))
        optics = speckled_optics(seed, 0.3);
    else if (!strcmp(name, "lowcontrast")) {
        optics.exposure = 0.26;
        optics.hollow.level = 0.03;
    } else if (!strcmp(name, "noise2"))
        optics.read_noise = 0.01;
    else if (!strcmp(name, "noise3"))
        optics.read_noise = 0.015;
    else if (!strcmp(name, "psf07"))
        optics.psf = 0.7;
    else if (!strcmp(name, "psf15"))
        optics.psf = 1.5;
    else if (!strcmp(name, "shading"))
        optics.shading = 0.5;
    else if (!strcmp(name, "saturated"))
        optics.exposure = 1.9;
    else if (!strcmp(name, "bevel")) {
        optics.bevel_width = 2;
        optics.bevel_depth = 0.6;
    }
    return optics;
}

/* Faces: circles, or ellipses whose mean of (longest - shortest radius) / mean radius is `ellipticity`. */
static void draw_shapes(struct photo_grains *grains, double ellipticity, uint64_t seed)
{
    for (size_t k = 0; k < grains->count; k++) {
        double size = 0.5 * ellipticity * grains->radius_px[k] * 2 * random_uniform(seed, 2 * k);
        double angle = 2 * M_PI * random_uniform(seed, 2 * k + 1);
        grains->shape_c[k] = size * cos(angle);
        grains->shape_s[k] = size * sin(angle);
    }
}

/* ---- the score ---- */

#define BAND 5.0 /* blurs: the widest that findgrains tries */

static void print_score(struct bench *bench, const char *photo, const char *method, const struct find_score *s)
{
    double u = sqrt(1 - sqrt(M_PI) / BAND); /* the bell projected off a constant over the band: see bound_of() */
    printf("%-12s %-18s %5.3f %4zu  %7.4f %7.4f %+8.4f  %7.4f  %5.2f %5.2f  %5.2f %5.2f  %5.2f %5.2f  %6.2f\n", photo,
           method, (double)s->found / (double)s->truth, s->wrong, s->centre, s->radius, s->bias, s->overlap,
           s->ratio_centre, s->ratio_radius, s->centre / s->bound_centre, s->radius / s->bound_radius,
           u * s->centre / s->bound_centre, u * s->radius / s->bound_radius, s->cpu);
    fflush(stdout);
    if (!bench->json)
        return;
    fprintf(
        bench->json,
        "%s{\"photo\": \"%s\", \"method\": \"%s\", \"grains\": %zu, \"found\": %zu, \"false\": %zu, \"centre_px\": "
        "%.5f, "
        "\"radius_px\": %.5f, \"bias_px\": %.5f, \"overlap_px\": %.5f, \"ratio_centre\": %.3f, \"ratio_radius\": %.3f, "
        "\"bound_centre_px\": %.5f, \"bound_radius_px\": %.5f, \"cpu_s\": %.3f}",
        bench->first ? "" : ",\n", photo, method, s->truth, s->found, s->wrong, s->centre, s->radius, s->bias,
        s->overlap, s->ratio_centre, s->ratio_radius, s->bound_centre, s->bound_radius, s->cpu);
    bench->first = 0;
}

/* ---- the runs ---- */

static double cpu_now(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static void run_peer(struct bench *bench, const char *name, enum peer peer, int shrink, const struct photo *photo,
                     const struct photo_grains *truth, double per_length, double blur)
{
    static const char *const names[] = {"hough", "hough alt", "distance", "contours"};
    static const char *const columns[] = {"x_px", "y_px", "radius_px", NULL};
    enum { ROOM = 20000 };
    static double circles[ROOM][3];
    struct photo_grains grains = {0};
    struct find_score score = {0};
    char label[64];
    double begin = cpu_now();
    int count =
        peer_find(peer, photo->pixels, photo->width, photo->height, shrink, bench->low, bench->high, circles, ROOM);
    score.cpu = cpu_now() - begin;
    if (table_alloc(&PHOTO_GRAINS, &grains, (size_t)count, columns))
        return;
    for (int k = 0; k < count; k++) {
        grains.x_px[k] = circles[k][0];
        grains.y_px[k] = circles[k][1];
        grains.radius_px[k] = circles[k][2];
    }
    find_score(truth, &grains, per_length, blur, &score);
    snprintf(label, sizeof label, "%s 1/%d", names[peer], shrink);
    print_score(bench, name, label, &score);
    table_free(&PHOTO_GRAINS, &grains);
}

static int run_findgrains(struct bench *bench, const char *name, const struct photo *photo,
                          const struct photo_grains *truth, double per_length, double blur)
{
    struct find_options options = FIND_OPTIONS_DEFAULT;
    struct photo_grains grains = {0};
    struct find_score score = {0};
    options.radius_min_px = bench->unknown ? NAN : bench->low;
    options.radius_max_px = bench->unknown ? NAN : bench->high;
    double begin = cpu_now();
    if (find_grains(photo, &options, &grains, NULL))
        return -1;
    score.cpu = cpu_now() - begin;
    find_score(truth, &grains, per_length, blur, &score);
    print_score(bench, name, "findgrains", &score);
    table_free(&PHOTO_GRAINS, &grains);
    return 0;
}

/* One setting of the fine fit on rims that were detected before: CPU of the fit alone. */
static int run_setting(struct bench *bench, const char *label, const struct photo *photo, const struct zone *zone,
                       const struct candidates *found, const struct rims_state *state, int iterations,
                       const struct photo_grains *truth, double per_length, double blur)
{
    struct rims rims = {0};
    struct photo_grains grains = {0};
    struct find_score score = {0};
    double begin = cpu_now();
    if (rims_make(found, &rims) || rims_approach(photo, zone, state, 1, &rims, rims_all(&rims)) ||
        rims_iterate(photo, zone, state, iterations, &rims, rims_all(&rims)))
        return -1;
    score.cpu = cpu_now() - begin;
    struct rims_state own = *state;
    own.correlation = rims_correlation(&rims);
    int status = rims_table(zone, &own, &rims, 0, &grains);
    if (!status) {
        find_score(truth, &grains, per_length, blur, &score);
        print_score(bench, "curve", label, &score);
    }
    table_free(&PHOTO_GRAINS, &grains);
    rims_free(&rims);
    return status;
}

/* Votes at coarser and finer pixels: all of findgrains after them is as usual; CPU of the detection alone. */
static int run_votes(struct bench *bench, double vote_radius, const struct photo *photo, const struct zone *zone,
                     const struct grey_levels *levels, const struct photo_grains *truth, double per_length, double blur)
{
    struct candidates found = {0};
    struct rims rims = {0};
    struct photo_grains grains = {0};
    struct find_score score = {0};
    struct rims_state state = rims_first_guess(levels);
    size_t peaks;
    char label[64];
    double range[2] = {bench->low, bench->high}, begin = cpu_now();
    if (detect_grains_at(vote_radius, photo, zone, levels, range, &found, &peaks))
        return -1;
    score.cpu = cpu_now() - begin;
    int status = rims_make(&found, &rims) || measure_rims(photo, zone, FIND_SHAPE_AUTO, 0, &state, &rims) ||
                 rims_table(zone, &state, &rims, 0, &grains);
    if (!status) {
        snprintf(label, sizeof label, "votes 1/%.1f R", vote_radius);
        find_score(truth, &grains, per_length, blur, &score);
        print_score(bench, "curve", label, &score);
    }
    table_free(&PHOTO_GRAINS, &grains);
    rims_free(&rims);
    candidates_free(&found);
    return status ? -1 : 0;
}

/* Pixel of the votes, band, sectors and iterations around what the photo chose itself. */
static int run_curve(struct bench *bench, const struct photo *photo, const struct photo_grains *truth,
                     double per_length, double blur)
{
    static const double votes[] = {3.5, 5, 7, 10, 14}, windows[] = {1.7, 2.5, 3.5, 5}, sectors[] = {1.5, 3, 6, 12};
    static const int iterations[] = {0, 1, 2, 3, 5, 10};
    struct zone zone;
    struct grey_levels levels;
    struct candidates found = {0};
    struct rims rims = {0};
    size_t peaks;
    double range[2] = {bench->low, bench->high}, begin = cpu_now();
    char label[64];
    if (zone_make(photo->width, photo->height, NULL, 0, &zone) || threshold_find(photo, &zone, &levels) ||
        detect_grains(photo, &zone, &levels, range, &found, &peaks))
        return -1;
    printf("detection: %.2f CPU s\n", cpu_now() - begin);
    struct rims_state chosen = rims_first_guess(&levels);
    begin = cpu_now();
    if (rims_make(&found, &rims) || measure_rims(photo, &zone, FIND_SHAPE_AUTO, 0, &chosen, &rims))
        return -1;
    printf("measurement with what the photo chose (band %.2f blurs, texture %.1f): %.2f CPU s\n",
           chosen.window / chosen.blur, chosen.texture, cpu_now() - begin);
    rims_free(&rims);
    int status = 0;
    for (size_t k = 0; k < 5 && !status; k++)
        status = run_votes(bench, votes[k], photo, &zone, &levels, truth, per_length, blur);
    for (size_t k = 0; k < 4 && !status; k++) {
        struct rims_state state = chosen;
        state.window = windows[k] * chosen.blur;
        snprintf(label, sizeof label, "band %.1f blurs", windows[k]);
        status = run_setting(bench, label, photo, &zone, &found, &state, 10, truth, per_length, blur);
    }
    for (size_t k = 0; k < 4 && !status; k++) {
        struct rims_state state = chosen;
        state.sector = sectors[k];
        snprintf(label, sizeof label, "sectors %.1f px", sectors[k]);
        status = run_setting(bench, label, photo, &zone, &found, &state, 10, truth, per_length, blur);
    }
    for (size_t k = 0; k < 6 && !status; k++) {
        snprintf(label, sizeof label, "%d iterations", iterations[k]);
        status = run_setting(bench, label, photo, &zone, &found, &chosen, iterations[k], truth, per_length, blur);
    }
    candidates_free(&found);
    return status;
}

static int run_case(struct bench *bench, const struct kind *kind)
{
    struct optics optics = case_optics(kind->name, bench->seed);
    struct photo_grains truth = {0};
    struct photo photo = {0};
    if (table_copy(&PHOTO_GRAINS, &truth, &bench->truth))
        return -1;
    for (size_t k = 0; k < truth.count; k++) {
        truth.x_px[k] *= kind->scale;
        truth.y_px[k] *= kind->scale;
        truth.radius_px[k] *= kind->scale;
    }
    bench->low = 67 * kind->scale * 0.97;
    bench->high = 167.5 * kind->scale * 1.03;
    draw_shapes(&truth, optics.ellipticity, bench->seed);
    struct picture picture = {.width = (int)(bench->width * kind->scale), .height = (int)(bench->height * kind->scale)};
    picture.grains = &truth;
    int status = render_picture(&picture, &optics, &photo);
    double blur = sqrt(optics.psf * optics.psf + 1.0 / 12);
    double step = optics.exposure * (optics.grain.level - optics.hollow.level);
    double per_length = step * step / (2 * sqrt(M_PI) * blur * optics.read_noise * optics.read_noise);
    if (!status && bench->save) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s.tif", bench->save, kind->name);
        status = photo_write(path, &photo);
    }
    if (!status)
        status = run_findgrains(bench, kind->name, &photo, &truth, per_length, blur);
    if (!status && bench->curve)
        status = run_curve(bench, &photo, &truth, per_length, blur);
    int shrink = kind->scale < 1 ? 1 : 4;
    if (!status && bench->peers) {
        run_peer(bench, kind->name, PEER_HOUGH_GRADIENT, shrink, &photo, &truth, per_length, blur);
        run_peer(bench, kind->name, PEER_HOUGH_GRADIENT_ALT, shrink, &photo, &truth, per_length, blur);
        if (shrink > 1)
            run_peer(bench, kind->name, PEER_HOUGH_GRADIENT_ALT, 1, &photo, &truth, per_length, blur);
        run_peer(bench, kind->name, PEER_DISTANCE_TRANSFORM, shrink, &photo, &truth, per_length, blur);
        run_peer(bench, kind->name, PEER_CONTOURS, shrink, &photo, &truth, per_length, blur);
        if (shrink > 1)
            run_peer(bench, kind->name, PEER_CONTOURS, 1, &photo, &truth, per_length, blur);
    }
    photo_free(&photo);
    table_free(&PHOTO_GRAINS, &truth);
    return status;
}

static int chosen(int argc, char **argv, const char *name)
{
    int any = 0;
    for (int k = 1; k + 1 < argc; k++)
        if (!strcmp(argv[k], "--case")) {
            any = 1;
            if (!strcmp(argv[k + 1], name))
                return 1;
        }
    return !any;
}

static int run(struct bench *bench, int argc, char **argv)
{
    if (packed_grains(bench->seed, bench->grains, &bench->truth, &bench->width, &bench->height))
        return -1;
    printf("%zu grains, %d x %d px, seed %llu; CPU seconds of one thread without decoding\n", bench->truth.count,
           bench->width, bench->height, (unsigned long long)bench->seed);
    printf(
        "photo        method             found false centre  radius      bias        x  err/s:c     r  err/k:c     r  "
        "err/u:c     r     CPU\n");
    for (const struct kind *kind = kinds; kind->name; kind++)
        if (chosen(argc, argv, kind->name) && run_case(bench, kind))
            return -1;
    return 0;
}

int main(int argc, char **argv)
{
    struct bench bench = {.seed = 2024, .grains = 300, .first = 1};
    for (int k = 1; k < argc; k++) {
        const char *next = k + 1 < argc ? argv[k + 1] : "";
        if (!strcmp(argv[k], "--seed"))
            bench.seed = strtoull(next, NULL, 10);
        else if (!strcmp(argv[k], "--grains"))
            bench.grains = strtol(next, NULL, 10);
        else if (!strcmp(argv[k], "--peers"))
            bench.peers = 1;
        else if (!strcmp(argv[k], "--curve"))
            bench.curve = 1;
        else if (!strcmp(argv[k], "--unknown"))
            bench.unknown = 1;
        else if (!strcmp(argv[k], "--save"))
            bench.save = next;
        else if (!strcmp(argv[k], "--json"))
            bench.json = fopen(next, "w");
    }
    if (bench.json)
        fputs("[\n", bench.json);
    int status = run(&bench, argc, argv);
    if (bench.json) {
        fputs("\n]\n", bench.json);
        fclose(bench.json);
    }
    if (status)
        fprintf(stderr, "bench_findgrains: %s\n", error_message());
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("peak memory %.0f MB (the rendering included)\n", (double)usage.ru_maxrss / 1024);
    table_free(&PHOTO_GRAINS, &bench.truth);
    return status ? 1 : 0;
}
