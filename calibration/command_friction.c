/* calibration friction: options, call, write. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands.h"
#include "calibration/friction.h"
#include "pipeline/cli.h"
#include "pipeline/error.h"

struct options {
    struct cli cli;
    struct cli_inputs tests;
};

static const char documentation[] =
    "The friction coefficient between grains from three-rod tests (thesis Appendix B): rod C (radius R) rests on two "
    "fixed rods and carries weights P1 and P2 at equal arms L; P2 grows until C turns and slides; alpha is the angle "
    "between the vertical and the lines of centres.\v"
    "Each test is one argument P1,P2,L,R,ALPHA: two weights in N, two lengths in m, an angle in degrees.\n\n"
    "Example: calibration friction 3.0,7.4,0.03,0.02,45 3.0,7.2,0.03,0.02,45 -o friction.json\n\n"
    "The result holds mu (for the scene's contact.mu), its standard error, and the angle phi.";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->tests, argument) ? ENOMEM : 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which test? Give P1,P2,L,R,ALPHA");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* "P1,P2,L,R,ALPHA" */
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

static int run(const struct options *options)
{
    size_t count = options->tests.count;
    struct friction_test *tests = calloc(count, sizeof *tests);
    struct friction friction;
    int status = tests ? 0 : error_memory("tests");
    for (size_t k = 0; k < count && status == 0; k++)
        status = parse_test(options->tests.paths[k], &tests[k]);
    if (status == 0)
        status = friction_estimate(tests, count, &friction);
    if (status == 0)
        status = calibration_write(options->cli.output, describe(&friction));
    free(tests);
    return status;
}

int command_friction(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {NULL, parse_option, "P1,P2,L,R,ALPHA...", documentation, children, NULL, NULL};
    struct options options = {.cli = {.max_flagged = CLI_MAX_FLAGGED, .needs = CLI_NEEDS_OUTPUT}};
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.tests);
    return status;
}
