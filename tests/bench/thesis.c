#include "tests/bench/thesis.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "report/pictures/force_map.h"

void thesis_line(struct thesis *thesis, const char *format, ...)
{
    char line[400];
    va_list values;
    va_start(values, format);
    vsnprintf(line, sizeof line, format, values);
    va_end(values);
    puts(line);
    fflush(stdout);
    fprintf(thesis->table, "%s\n", line);
}

/* ---- pictures ---- */

static void name_picture(const struct thesis *thesis, char path[1000])
{
    snprintf(path, 1000, "%s/figure-%s.png", thesis->folder, thesis->figure);
}

int thesis_picture(const struct thesis *thesis, struct chart *charts, size_t count)
{
    char path[1000];
    name_picture(thesis, path);
    int status = chart_write(path, charts, count, 560, 380);
    for (size_t k = 0; k < count; k++)
        chart_free(&charts[k]);
    return status;
}

int thesis_maps(const struct thesis *thesis, const struct packing *const *packings, const struct forces *const *forces,
                const char *const *titles, size_t count)
{
    enum { WIDTH = 620 };
    char path[1000];
    struct canvas canvas = {0};
    struct force_map first = {.packing = packings[0], .forces = forces[0], .mean_fn = NAN, .width = WIDTH};
    name_picture(thesis, path);
    if (force_map_measure(&first) || canvas_begin(&canvas, path, WIDTH * (double)count, first.height))
        return -1;
    int failed = 0;
    for (size_t k = 0; k < count && !failed; k++) {
        struct force_map map = {
            .packing = packings[k], .forces = forces[k], .title = titles[k], .mean_fn = NAN, .width = WIDTH};
        canvas_move(&canvas, WIDTH * (double)k, 0, 0);
        failed = force_map_measure(&map) || force_map_draw(&map, &canvas);
        canvas_restore(&canvas);
    }
    return canvas_end(&canvas, failed);
}

struct chart_line *thesis_scatter(struct chart *chart, const char *name, size_t capacity)
{
    struct chart_line *line = chart_add(chart, name, 2 * capacity + 2);
    if (line)
        line->scattered = 1, line->without_key = !*name;
    return line;
}

void thesis_point(struct chart_line *line, double x, double y)
{
    chart_put(line, x, y);
    chart_put(line, NAN, NAN);
}

/* ---- states ---- */

int thesis_states(const struct thesis *thesis, const struct thesis_test *test, struct states *states)
{
    const struct states_test wanted = {test->grains, test->kappa, test->seed,    test->steps,
                                       test->strain, 1e-8,        test->patience};
    return states_keep(thesis->folder, &wanted, states);
}

static double height_of(const struct packing *packing)
{
    long top = walls_find(&packing->walls, "top"), bottom = walls_find(&packing->walls, "bottom");
    return packing->walls.y0[top] - packing->walls.y0[bottom];
}

double thesis_strain(const struct states *states, size_t s)
{
    return 1 - height_of(&states->state[s]) / height_of(&states->state[0]);
}

double thesis_indeterminacy(const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    double h = -2; /* two loaded walls */
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        int wall = j >= grains->count;
        if (!(grains->flags[i] & GRAIN_RATTLER) && (wall || !(grains->flags[j] & GRAIN_RATTLER)))
            h += wall ? 1 : 2;
    }
    for (size_t k = 0; k < grains->count; k++)
        h -= grains->flags[k] & GRAIN_RATTLER ? 0 : 3;
    return h;
}

/* ---- estimates ---- */

struct force_options thesis_options(enum force_start start)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1.09e7;
    options.law.mu = 0.5;
    options.start = start;
    return options;
}

/* r of the contacts whose true fn lies in (from, to], those that are missing counting as 0. */
static double r_between(const struct packing *truth, const struct packing *measured, const double *force, double from,
                        double to)
{
    const struct contacts *contacts = &truth->contacts;
    const double *fn = packing_forces(truth, "dem")->contact.fn;
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        if (fn[c] <= from || fn[c] > to)
            continue;
        double p = fn[c], q = states_force_at(&measured->contacts, force, contacts->i[c], contacts->j[c], c);
        n++, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
    }
    return (ab - a * b / n) / sqrt((aa - a * a / n) * (bb - b * b / n));
}

static double distance(const struct packing *truth, const struct packing *measured, const struct contact_forces *found)
{
    const struct contact_forces *known = &packing_forces(truth, "dem")->contact;
    const struct contacts *contacts = &truth->contacts;
    double sum = 0;
    for (size_t c = 0; c < known->count; c++) {
        double fn = states_force_at(&measured->contacts, found->fn, contacts->i[c], contacts->j[c], c);
        double ft = states_force_at(&measured->contacts, found->ft, contacts->i[c], contacts->j[c], c);
        sum += hypot(fn - known->fn[c], ft - known->ft[c]);
    }
    return sum / (double)known->count / states_mean_force(truth);
}

int thesis_try(const struct packing *truth, const struct packing *measured, const struct force_options *options,
               enum force_method method, struct trial *trial)
{
    if (infer_forces(measured, options, method, &trial->forces))
        return -1;
    const struct contact_forces *known = &packing_forces(truth, "dem")->contact, *found = &trial->forces.contact;
    double mean = states_mean_force(truth);
    trial->rn = states_r(truth, measured, known->fn, found->fn, 1);
    trial->rt = states_r(truth, measured, known->ft, found->ft, 0);
    trial->strong = r_between(truth, measured, found->fn, mean, INFINITY);
    trial->weak = r_between(truth, measured, found->fn, 0, mean);
    trial->distance = distance(truth, measured, found);
    return 0;
}

void trial_free(struct trial *trial)
{
    forces_free(&trial->forces);
}

int thesis_keep(struct packing *packing, struct forces *forces)
{
    struct forces *grown = realloc(packing->forces, (packing->force_count + 1) * sizeof *grown);
    if (!grown)
        return error_memory("forces");
    packing->forces = grown;
    grown[packing->force_count++] = *forces;
    memset(forces, 0, sizeof *forces);
    return 0;
}
