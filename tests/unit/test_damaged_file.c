/* A state file in which one byte changed is either refused, with a line that names it, or read as if nothing had
 * happened: never as something else. Bytes all over a packing file of the sample's truth are changed, one by one.
 *
 *     test_damaged_file [STEP]        every STEP-th byte (default 53; 1: all of them, minutes) */
#include "tests/check.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"

/* HDF5 1.10.8 itself keeps a block when it meets a damaged file. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libhdf5";
}

static const char source[] = FILM_SOURCE_DIR "/sample_images/truth/0002.truth.hdf";
static char path[] = "/tmp/test_damaged.XXXXXX";
static size_t step = 53;

static int same_bytes(const void *a, const void *b, size_t size)
{
    return size == 0 || !memcmp(a, b, size);
}

static int same_table(const struct table_kind *kind, const void *a, const void *b)
{
    size_t rows = table_rows(kind, a);
    if (table_rows(kind, b) != rows)
        return 0;
    for (size_t k = 0; k < kind->column_count; k++) {
        const struct column *column = &kind->columns[k];
        const void *left = *table_array(column, a), *right = *table_array(column, b);
        if (!left != !right || (left && !same_bytes(left, right, rows * column_size(column->type))))
            return 0;
    }
    return 1;
}

static int same_forces(const struct forces *a, const struct forces *b)
{
    return !strcmp(a->method, b->method) && !strcmp(a->start, b->start) && a->iterations == b->iterations &&
           a->converged == b->converged && same_bytes(&a->imbalance, &b->imbalance, sizeof(double)) &&
           same_bytes(a->stress, b->stress, sizeof a->stress) && same_bytes(&a->kn, &b->kn, sizeof(double)) &&
           same_bytes(&a->kt, &b->kt, sizeof(double)) && same_bytes(&a->mu, &b->mu, sizeof(double)) &&
           same_bytes(a->misfit, b->misfit, sizeof a->misfit) &&
           same_table(&CONTACT_FORCES, &a->contact, &b->contact) && same_table(&RESIDUALS, &a->residual, &b->residual);
}

static int same_text(const char *a, const char *b)
{
    return a && b ? !strcmp(a, b) : a == b;
}

static int same_info(const struct state_info *a, const struct state_info *b)
{
    return !strcmp(a->stage, b->stage) && !strcmp(a->coordinates, b->coordinates) &&
           !strcmp(a->program_version, b->program_version) && same_text(a->parameters, b->parameters) &&
           same_text(a->inputs, b->inputs) && a->index == b->index &&
           same_bytes(&a->time_s, &b->time_s, sizeof a->time_s) && same_bytes(a->strain, b->strain, sizeof a->strain) &&
           same_bytes(&a->length_m, &b->length_m, sizeof a->length_m);
}

static int same_packing(const struct packing *a, const struct packing *b)
{
    int same = same_info(&a->info, &b->info) && same_bytes(&a->length_m, &b->length_m, sizeof a->length_m) &&
               same_table(&GRAINS, &a->grains, &b->grains) && same_table(&WALLS, &a->walls, &b->walls) &&
               same_table(&CONTACTS, &a->contacts, &b->contacts) && a->force_count == b->force_count;
    for (size_t f = 0; same && f < a->force_count; f++)
        same = same_forces(&a->forces[f], &b->forces[f]);
    return same;
}

static void test_one_byte(void **unused)
{
    (void)unused;
    struct packing whole;
    size_t refused = 0, untouched = 0, length = 0, capacity = 1 << 22;
    char *bytes = malloc(capacity);
    FILE *stream = fopen(source, "rb");
    assert_non_null(bytes);
    assert_non_null(stream);
    length = fread(bytes, 1, capacity, stream);
    fclose(stream);
    assert_true(length > 10000 && length < capacity);
    check_done(packing_read(source, &whole));
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, bytes, length), length);
    for (size_t at = 0; at < length; at += step) {
        char changed = (char)(bytes[at] ^ (1 << at % 8));
        struct packing read;
        assert_int_equal(pwrite(fd, &changed, 1, (off_t)at), 1);
        if (packing_read(path, &read)) {
            refused++;
            assert_non_null(strstr(error_message(), path));
        } else {
            if (!same_packing(&whole, &read))
                fail_msg("byte %zu of %zu changed: the file is read, as something else", at, length);
            untouched++;
            packing_free(&read);
        }
        assert_int_equal(pwrite(fd, bytes + at, 1, (off_t)at), 1);
    }
    print_message("%zu changed bytes: %zu refused, %zu where nothing is read\n", refused + untouched, refused,
                  untouched);
    assert_true(refused > untouched);
    close(fd);
    unlink(path);
    free(bytes);
    packing_free(&whole);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_byte)};
    if (argc > 1)
        step = strtoul(argv[1], NULL, 10) ? strtoul(argv[1], NULL, 10) : 1;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
