/* Input that forces refuses, naming the row and what to do; and standard errors that are missing. */
#include "pipeline/speak/error.h"
#include "tests/unit/force_checks.h"

static struct packing isotropic; /* kappa = 300 */

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    (void)state, (void)user;
    copy_packing(packing, &isotropic);
    return 0;
}

static int simulate_once(void **state)
{
    (void)state;
    struct simulation simulation = SIMULATION_DEFAULT;
    const struct grade grading[] = {{26, 8e-3}, {14, 12e-3}, {13, 14e-3}};
    simulation.grading = grading, simulation.grade_count = 3;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 300;
    return simulate(&simulation, keep_state, NULL);
}

static int forget(void **state)
{
    (void)state;
    packing_free(&isotropic);
    return 0;
}

static void check_refused(const struct packing *packing, const struct force_options *options, enum force_method method,
                          const char *word)
{
    struct forces forces;
    assert_int_equal(infer_forces(packing, options, method, &forces), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), word))
        fail_msg("'%s' does not speak of '%s'", error_message(), word);
    error_clear();
}

static void missing_numbers_are_named(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct packing packing;
    options.law.mu = NAN;
    check_refused(&isotropic, &options, METHOD_QSM, "contact.mu");
    options = usual(), options.law.kn = NAN;
    check_refused(&isotropic, &options, METHOD_CEM, "kn_N_per_m");
    check_refused(&isotropic, &options, METHOD_QSM, "kn_N_per_m");
    check_refused(&isotropic, &options, METHOD_MAP, "kn_N_per_m");
    options.start = START_OVERLAP;
    check_refused(&isotropic, &options, METHOD_CDM, "kn_N_per_m");
    options = usual(), options.start = START_PREVIOUS;
    check_refused(&isotropic, &options, METHOD_QSM, "--previous");
    options = usual();
    discs_begin(&packing, 1);
    disc_put(&packing, 0, 0, 0, 1);
    check_refused(&packing, &options, METHOD_CDM, "holds the packing");
    packing_free(&packing);
}

/* A column of numbers that are known, but for one row. */
static void spoil(const struct table_kind *kind, void *table, const char *column, size_t row, double value)
{
    for (size_t k = 0; k < kind->column_count; k++)
        if (!strcmp(kind->columns[k].name, column)) {
            double **values = (double **)table_array(&kind->columns[k], table);
            int there = *values != NULL;
            check_done(table_add(kind, table, column));
            for (size_t r = 0; !there && r < table_rows(kind, table); r++)
                (*values)[r] = 0;
            assert_true(row < table_rows(kind, table));
            (*values)[row] = value;
            return;
        }
    fail_msg("no column %s", column);
}

/* NaN or infinite, in every column that a method reads, for every method. */
static void nan_is_refused(void **state)
{
    (void)state;
    static const char *const of_grains[] = {"x", "y", "radius", "load_x", "load_y", "load_m", NULL};
    static const char *const of_contacts[] = {"nx", "ny", "x", "y", "overlap", NULL};
    static const char *const of_walls[] = {"x0", "y0", "x1", "y1", "radius", NULL};
    static const char *const *const columns[] = {of_grains, of_contacts, of_walls};
    static const struct table_kind *const kinds[] = {&GRAINS, &CONTACTS, &WALLS};
    for (int table = 0; table < 3; table++)
        for (const char *const *column = columns[table]; *column; column++)
            for (int method = METHOD_CEM; method <= METHOD_MAP; method++)
                for (int infinite = 0; infinite < 2; infinite++) {
                    struct force_options options = usual();
                    struct packing packing;
                    copy_packing(&isotropic, &packing);
                    void *tables[] = {&packing.grains, &packing.contacts, &packing.walls};
                    spoil(kinds[table], tables[table], *column, 3, infinite ? INFINITY : NAN);
                    check_refused(&packing, &options, (enum force_method)method, "3");
                    packing_free(&packing);
                }
}

/* Numbers that no packing has: refused as bad input, or borne; never blamed on the machine. */
static void absurd_numbers_are_bad_input(void **state)
{
    (void)state;
    static const char *const of_grains[] = {"x", "y", "radius", "load_x", "mass", "s_x", NULL};
    static const char *const of_contacts[] = {"x", "y", "overlap", "s_overlap", NULL};
    static const char *const of_walls[] = {"x0", "y1", "radius", "fx", "fy", NULL};
    static const char *const *const columns[] = {of_grains, of_contacts, of_walls};
    static const struct table_kind *const kinds[] = {&GRAINS, &CONTACTS, &WALLS};
    static const double absurd[] = {1e300, -1e300, 1e200, 1e100};
    for (int table = 0; table < 3; table++)
        for (const char *const *column = columns[table]; *column; column++)
            for (int method = METHOD_CEM; method <= METHOD_MAP; method++)
                for (int k = 0; k < 4; k++) {
                    struct force_options options = usual();
                    struct packing packing;
                    struct forces forces;
                    options.iterations = 20;
                    copy_packing(&isotropic, &packing);
                    void *tables[] = {&packing.grains, &packing.contacts, &packing.walls};
                    spoil(kinds[table], tables[table], *column, 3, absurd[k]);
                    if (!infer_forces(&packing, &options, (enum force_method)method, &forces))
                        forces_free(&forces);
                    else if (error_status() != EXIT_INPUT)
                        fail_msg("%s %g: %s", *column, absurd[k], error_message());
                    error_clear();
                    packing_free(&packing);
                }
}

/* One mass among good ones: the others are not thrown away in silence. */
static void one_bad_mass_is_named(void **state)
{
    (void)state;
    static const double bad[] = {NAN, 0, -1, INFINITY};
    struct force_options options = usual();
    for (int k = 0; k < 4; k++) {
        struct packing packing;
        copy_packing(&isotropic, &packing);
        size_t loaded = (size_t)packing.contacts.i[0];
        packing.grains.mass[loaded] = bad[k];
        check_refused(&packing, &options, METHOD_CDM, "mass");
        packing_free(&packing);
    }
}

/* A grain without numbers, whose contacts no flag takes out. */
static void contacts_of_flagged_grains_are_checked(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct packing packing;
    copy_packing(&isotropic, &packing);
    size_t k = (size_t)packing.contacts.i[7];
    packing.grains.flags[k] |= GRAIN_LOST;
    packing.grains.x[k] = NAN;
    for (int method = METHOD_CEM; method <= METHOD_MAP; method++)
        check_refused(&packing, &options, (enum force_method)method, "contact");
    packing_free(&packing);
}

/* The same row, flagged: it is left out, and the others are still told. */
static void flagged_rows_are_left_out(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct packing packing;
    struct forces forces;
    copy_packing(&isotropic, &packing);
    packing.contacts.overlap[3] = packing.contacts.nx[3] = NAN;
    packing.contacts.flags[3] |= CONTACT_NOT_FINITE;
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        options.iterations = method == METHOD_CDM ? 200 : 0;
        check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
        assert_int_equal(forces.contact.status[3], STATUS_NOT_USED);
        for (size_t c = 0; c < forces.contact.count; c++)
            assert_true(isfinite(forces.contact.fn[c]) && isfinite(forces.contact.ft[c]));
        forces_free(&forces);
    }
    packing_free(&packing);
}

static void infer_with_errors(double row_3, double others, const char *column, const struct table_kind *kind,
                              struct forces *forces)
{
    struct force_options options = usual();
    struct packing packing;
    copy_packing(&isotropic, &packing);
    void *table = kind == &GRAINS ? (void *)&packing.grains : (void *)&packing.contacts;
    for (size_t r = 0; r < table_rows(kind, table); r++)
        spoil(kind, table, column, r, r == 3 ? row_3 : r == 5 ? 2 * others : others);
    check_done(infer_forces(&packing, &options, METHOD_MAP, forces));
    packing_free(&packing);
}

/* A standard error that is missing among others counts as the largest of them, which row 5 has; where all are missing,
 * as exact. */
static void missing_errors_are_not_exact(void **state)
{
    (void)state;
    static const char *const columns[] = {"s_x", "s_y_ref", "s_radius", "s_overlap"};
    for (int k = 0; k < 4; k++) {
        const struct table_kind *kind = k < 3 ? &GRAINS : &CONTACTS;
        struct forces missing, largest, none, exact;
        infer_with_errors(NAN, 2e-6, columns[k], kind, &missing);
        infer_with_errors(4e-6, 2e-6, columns[k], kind, &largest);
        infer_with_errors(NAN, NAN, columns[k], kind, &none);
        infer_with_errors(0, 0, columns[k], kind, &exact);
        size_t different = 0;
        for (size_t c = 0; c < missing.contact.count; c++) {
            assert_true(missing.contact.fn[c] == largest.contact.fn[c]);
            assert_true(none.contact.fn[c] == exact.contact.fn[c]);
            different += missing.contact.fn[c] != exact.contact.fn[c];
        }
        assert_true(different > 0);
        forces_free(&missing), forces_free(&largest), forces_free(&none), forces_free(&exact);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_numbers_are_named),
        cmocka_unit_test(nan_is_refused),
        cmocka_unit_test(absurd_numbers_are_bad_input),
        cmocka_unit_test(one_bad_mass_is_named),
        cmocka_unit_test(contacts_of_flagged_grains_are_checked),
        cmocka_unit_test(flagged_rows_are_left_out),
        cmocka_unit_test(missing_errors_are_not_exact),
    };
    return cmocka_run_group_tests(tests, simulate_once, forget);
}
