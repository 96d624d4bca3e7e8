/* calibration friction: mu between grains, from three-rod tests (thesis Appendix B) or from contact forces.
 *
 * Out: film.friction/1. Of tests: mu = tan phi, phi_rad, and for two tests or more the standard errors of their means.
 * Of forces: mu where |ft| / fn ends, the width of that end, its significance, and quantiles of |ft| / fn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/friction.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    const char *method; /* of forces files; NULL: three-rod tests */
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {{"forces", NULL, OPTION_TEXT, AT(method), "METHOD",
                                          .help = "Arguments are forces files: mu from where |ft| / fn ends"},
                                         {0}};

static const char documentation[] =
    "The friction coefficient between grains from three-rod tests (thesis Appendix B): rod C (radius R) rests on two "
    "fixed rods and carries weights P1 and P2 at equal arms L; P2 grows until C turns and slides; alpha is the angle "
    "between the vertical and the lines of centres.\v"
    "Each test is one argument P1,P2,L,R,ALPHA: two weights in N, two lengths in m, an angle in degrees.\n\n"
    "Example: calibration friction 3.0,7.4,0.03,0.02,45 3.0,7.2,0.03,0.02,45 -o friction.json\n\n"
    "With --forces METHOD the arguments are forces files of one or more states instead: |ft| / fn of the contacts "
    "ends sharply at mu. The method must not have been given the answer: infer the forces with a mu well above "
    "it.\n\n"
    "The result holds mu (for the scene's contact.mu) and its standard error.";

/* "P1,P2,L,R,ALPHA" in N, N, m, m, degrees. */
static int parse_test(const char *text, struct friction_test *test)
{
    const double degree = 0.017453292519943295;
    char rest;
    if (sscanf(text, "%lf,%lf,%lf,%lf,%lf%c", &test->p1, &test->p2, &test->arm, &test->radius, &test->alpha, &rest) !=
        5)
        return error_input("test '%s': give five numbers P1,P2,L,R,ALPHA in N, N, m, m, degrees", text);
    test->alpha *= degree;
    return 0;
}

/* film.friction/1. One test has no scatter: no standard errors. */
static cJSON *describe(const struct friction *friction)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.friction/1");
    cJSON_AddNumberToObject(object, "tests", (double)friction->tests);
    cJSON_AddNumberToObject(object, "mu", friction->mu);
    cJSON_AddNumberToObject(object, "phi_rad", friction->phi);
    if (friction->tests > 1) {
        cJSON_AddNumberToObject(object, "s_mu", friction->s_mu);
        cJSON_AddNumberToObject(object, "s_phi_rad", friction->s_phi);
    }
    return object;
}

/* mu where |ft| / fn ends, and how sharply: width of the end, contacts in it, its significance in standard deviations.
 */
static cJSON *describe_mobilised(const struct mobilised *mobilised)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.friction/1");
    calibration_add(object, "mu", mobilised->mu);
    calibration_add(object, "s_mu", mobilised->s_mu);
    calibration_add(object, "width", mobilised->width);
    calibration_add(object, "contacts", (double)mobilised->contacts);
    calibration_add(object, "sliding", (double)mobilised->sliding);
    calibration_add(object, "significance", mobilised->significance);
    cJSON_AddItemToObject(object, "quantiles_10_50_90_95_99", cJSON_CreateDoubleArray(mobilised->quantile, 5));
    return object;
}

/* Append the forces of one file; *mu: that they were inferred with. */
static int collect(const char *path, const char *method, double **fn, double **ft, size_t *count, double *mu)
{
    struct packing packing = {0};
    int status = packing_read(path, &packing);
    const struct forces *forces = status ? NULL : packing_forces(&packing, method);
    if (!status && !forces)
        status = error_input("%s: no forces of method '%s': run forces --method %s", path, method, method);
    if (!status) {
        size_t more = forces->contact.count, all = *count + more;
        double *normal = realloc(*fn, (all + 1) * sizeof *normal);
        *fn = normal ? normal : *fn;
        double *tangential = realloc(*ft, (all + 1) * sizeof *tangential);
        *ft = tangential ? tangential : *ft;
        if (!normal || !tangential)
            status = error_memory("contact forces");
        for (size_t c = 0; c < more && !status; c++) {
            int wall = packing.contacts.flags && (packing.contacts.flags[c] & CONTACT_WALL);
            normal[*count + c] = wall ? NAN : forces->contact.fn[c]; /* walls have their own friction */
            tangential[*count + c] = forces->contact.ft[c];
        }
        *count = status ? *count : all;
        *mu = forces->mu;
    }
    packing_free(&packing);
    return status;
}

/* Forces that were inferred with mu end at that mu by construction, which tells nothing: refused, unless they are the
 * simulation's own (dem). */
static int run_forces(const struct options *options)
{
    double *fn = NULL, *ft = NULL, mu = NAN;
    size_t count = 0;
    struct mobilised mobilised = {0};
    int status = 0;
    for (size_t k = 0; k < options->cli.inputs.count && !status; k++)
        status = collect(options->cli.inputs.paths[k], options->method, &fn, &ft, &count, &mu);
    if (!status)
        status = friction_mobilised(fn, ft, count, &mobilised);
    if (!status && strcmp(options->method, "dem") && fabs(mobilised.mu - mu) < 2 * mobilised.width)
        status = error_input("the forces were inferred with mu = %g and |ft| / fn ends there: infer them with a larger "
                             "contact.mu, which must not be the answer",
                             mu);
    if (!status)
        status = calibration_write(options->cli.output, describe_mobilised(&mobilised));
    if (!status)
        calibration_tell(&options->cli, "mu", mobilised.mu, mobilised.s_mu);
    free(fn);
    free(ft);
    return status;
}

/* Each word is a test; the formula and its limits are in friction.h. */
static int run_tests(const struct options *options)
{
    size_t count = options->cli.inputs.count;
    struct friction_test *tests = calloc(count, sizeof *tests);
    struct friction friction;
    int status = tests ? 0 : error_memory("tests");
    for (size_t k = 0; k < count && status == 0; k++)
        status = parse_test(options->cli.inputs.paths[k], &tests[k]);
    if (status == 0)
        status = friction_estimate(tests, count, &friction);
    if (status == 0)
        status = calibration_write(options->cli.output, describe(&friction));
    if (status == 0)
        calibration_tell(&options->cli, "mu", friction.mu, friction.tests > 1 ? friction.s_mu : NAN);
    free(tests);
    return status;
}

int command_friction(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT)};
    const struct program program = {"P1,P2,L,R,ALPHA...\nFILE.hdf...",
                                    documentation,
                                    rows,
                                    &options,
                                    NULL,
                                    1,
                                    CLI_MANY,
                                    "which test? Give P1,P2,L,R,ALPHA, or forces files with --forces",
                                    NULL};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, options.method ? run_forces(&options) : run_tests(&options));
}
