/* calibration rescale: k_n (and k_t) from the stresses of a whole series (thesis 2.1.1, 3.3).
 *
 * The Weber stress of forces that follow from overlaps grows in proportion with k_n at a fixed k_t / k_n, because
 * Coulomb's law knows no scale: k_n is the slope of measured over computed stress (rescale.h). */
#include <math.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/rescale.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    struct rescale_options rescale;
    const char *picture;
};

static const char documentation[] =
    "The contact stiffness k_n (with --tangential also k_t) that makes the Weber stress of a whole series equal to "
    "the stress measured at the walls (thesis 2.1.1, 3.3).\v"
    "FILE.hdf: contacts files of one series, in order: forces come from their overlaps and motions by the contact "
    "elasticity method with the scene's mu. With --method NAME: forces files, whose forces of that method are "
    "scaled.\n\n"
    "Example: calibration rescale --scene scene.json contacts/*.contacts.hdf -o stiffness.json\n\n"
    "The result holds kn_N_per_m and kt_over_kn for the scene's contact, their standard errors, and measured beside "
    "rescaled stress of every state.";

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"tangential", NULL, OPTION_SWITCH, AT(rescale.fit_kt), .help = "Seek k_t too (needs sheared states)"},
    {"increments", NULL, OPTION_SWITCH, AT(rescale.increments),
     .help = "Compare stress changes since the first file, not stresses"},
    {"method", NULL, OPTION_TEXT, AT(rescale.method), "NAME", .help = "Scale this method's forces in forces files"},
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE",
     .help = "Rescaled against measured stress as a picture (.svg, .pdf, .png)"},
    {0}};

/* For struct program: forces that are there have their kt / kn already. */
static int check(void *input)
{
    const struct rescale_options *rescale = &((const struct options *)input)->rescale;
    if (rescale->method && rescale->fit_kt)
        return error_input("--method scales forces that are there: --tangential needs contacts files without it");
    return 0;
}

/* film.rescale/1: stiffness for the scene's contact, and measured beside rescaled stress, compression positive, Pa (N/m
 * without a length), of every state. */
static cJSON *describe(const struct rescale *rescale)
{
    static const char *const names[] = {"xx", "yy", "xy"};
    cJSON *object = cJSON_CreateObject(), *states = cJSON_CreateArray();
    cJSON_AddStringToObject(object, "schema", "film.rescale/1");
    calibration_add(object, "kn_N_per_m", rescale->kn);
    calibration_add(object, "s_kn_N_per_m", rescale->s_kn);
    calibration_add(object, "kt_over_kn", rescale->kt_over_kn);
    calibration_add(object, "s_kt_over_kn", rescale->s_kt_over_kn);
    calibration_add(object, "stress_ratio", rescale->ratio);
    calibration_add(object, "s_stress_ratio", rescale->s_ratio);
    calibration_add(object, "rms_left_over", rescale->rms);
    for (size_t k = 0; k < rescale->count; k++) {
        cJSON *state = cJSON_CreateObject(), *measured = cJSON_CreateObject(), *weber = cJSON_CreateObject();
        calibration_add(state, "index", (double)rescale->states[k].index);
        for (int c = 0; c < 3; c++) {
            calibration_add(measured, names[c], rescale->states[k].measured[c]);
            calibration_add(weber, names[c], rescale->states[k].weber[c]);
        }
        cJSON_AddItemToObject(state, "measured", measured);
        cJSON_AddItemToObject(state, "weber", weber);
        cJSON_AddItemToArray(states, state);
    }
    cJSON_AddItemToObject(object, "states", states);
    return object;
}

/* Weber's stress against the measured one, a dot per state, for each component. */
static int draw(const char *path, const struct rescale *rescale)
{
    static const char *const names[] = {"xx", "yy", "xy"};
    struct chart chart = {.title = "Stress of the contacts", .x_label = "measured", .y_label = "Weber, rescaled"};
    int status = 0;
    for (int c = 0; c < 3 && !status; c++) {
        struct chart_line *line = chart_add(&chart, names[c], rescale->count);
        status = line ? 0 : -1;
        for (size_t k = 0; line && k < rescale->count; k++)
            chart_put(line, rescale->states[k].measured[c], rescale->states[k].weber[c]);
        if (line)
            line->scattered = line->unjoined = 1;
    }
    if (!status)
        status = chart_write(path, &chart, 1, CALIBRATION_CHART_WIDTH, CALIBRATION_CHART_HEIGHT);
    chart_free(&chart);
    return status;
}

/* All states at once: one stiffness has to fit them all. */
static int run(struct options *options)
{
    struct scene scene = {0};
    struct rescale rescale = {0};
    size_t count = options->cli.inputs.count;
    struct packing *states = calloc(count, sizeof *states);
    int status = states ? scene_read(options->cli.scene, &scene) : error_memory("states");
    for (size_t k = 0; k < count && !status; k++)
        status = packing_read(options->cli.inputs.paths[k], &states[k]);
    options->rescale.law = scene.contact;
    if (!status && scene.contact_given && !contact_law_row(&scene.contact)->linear)
        status = error_input("%s: contact.law: rescaling finds the k_n of the linear law: make it linear",
                             options->cli.scene);
    if (!status)
        status = rescale_fit(states, count, &options->rescale, &rescale);
    if (!status)
        status = calibration_write(options->cli.output, describe(&rescale));
    if (!status && options->picture)
        status = draw(options->picture, &rescale);
    if (!status)
        calibration_tell(&options->cli, "kn_N_per_m", rescale.kn, rescale.s_kn);
    for (size_t k = 0; states && k < count; k++)
        packing_free(&states[k]);
    free(states);
    rescale_free(&rescale);
    scene_free(&scene);
    return status;
}

int command_rescale(int argc, char **argv)
{
    struct options options = {.cli = CLI_DEFAULT};
    const struct program program = {"FILE.hdf...", documentation,
                                    rows,          &options,
                                    NULL,          1,
                                    CLI_MANY,      "which series? Give its contacts files in order",
                                    check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
}
