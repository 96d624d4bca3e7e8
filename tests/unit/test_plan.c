/* The planner on made-up scenes: which results there are and in which order, what each one is made from, what bash
 * reads from its quoting, and what counts as changed. The photos are empty files: nobody reads them. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/plan/plan.h"
#include "pipeline/plan/plan_marks.h"
#include "pipeline/plan/scene_check.h"
#include "pipeline/plan/shell_word.h"
#include "pipeline/speak/error.h"
#include "tests/check.h"

#define FOLDER "test_plan.files"
#define OUT FOLDER "/out"

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

/* At `second` after 2001; what does not exist is made. */
static void touch(const char *path, long second)
{
    const struct timespec times[2] = {{1000000000 + second, 0}, {1000000000 + second, 0}};
    int file = open(path, O_WRONLY | O_CREAT, 0666);
    assert_true(file >= 0);
    assert_int_equal(futimens(file, times), 0);
    close(file);
}

static int make_files(void **state)
{
    (void)state;
    assert_int_equal(system("rm -rf " FOLDER), 0);
    mkdir(FOLDER, 0777);
    mkdir(FOLDER "/bin", 0777);
    mkdir(OUT, 0777);
    mkdir(OUT "/.running", 0777);
    mkdir(OUT "/.failed", 0777);
    for (int stage = 0; stage < PLAN_STAGES; stage++) {
        char path[100];
        snprintf(path, sizeof path, FOLDER "/bin/%s", PLAN_STAGE[stage]);
        touch(path, 0);
    }
    touch(FOLDER "/lens.json", 0);
    touch(FOLDER "/loads.csv", 0);
    for (int k = 8; k < 13; k++) {
        char path[100];
        snprintf(path, sizeof path, FOLDER "/%d.tif", k);
        touch(path, 0);
    }
    return 0;
}

struct given {
    struct scene scene;
    struct plan plan;
};

/* A series of `photos` photos, numbers from 8 on, the reference is the second; `more`: further keys, `of_photos`: those
 * of the photos. */
static int try_plan_of(struct given *given, long photos, const char *more, const char *method, const char *start,
                       const char *of_photos)
{
    char text[1000];
    snprintf(text, sizeof text,
             "{\"schema\": \"film.scene/1\", \"name\": \"plan\", \"lens\": \"lens.json\", \"loads\": \"loads.csv\",%s\n"
             "\"photos\": {\"pattern\": \"{index}.tif\", \"first\": 8, \"last\": %ld, \"reference\": 9%s}}",
             more, 7 + photos, of_photos);
    write_text(FOLDER "/scene.json", text);
    check_done(scene_read(FOLDER "/scene.json", &given->scene));
    const struct plan_words words = {OUT, method, start, FOLDER "/bin", "/run it", 0};
    return plan_make(&given->plan, &given->scene, &words);
}

/* Two photos in a block. */
static int try_plan(struct given *given, long photos, const char *more, const char *method, const char *start)
{
    return try_plan_of(given, photos, more, method, start, ", \"block\": 2");
}

static void end(struct given *given)
{
    plan_free(&given->plan);
    scene_free(&given->scene);
}

/* The result of that name; its number is given back. */
static size_t find(const struct plan *plan, const char *name, struct product *product)
{
    size_t k = 0;
    while (k < plan->count && strcmp(plan_name(plan, k).name, name))
        k++;
    assert_true(k < plan->count);
    check_done(plan_product(plan, k, product));
    return k;
}

static void check_product(const struct plan *plan, const char *name, const char *job, const char *needs, size_t reads,
                          const char *ending)
{
    struct product product;
    find(plan, name, &product);
    assert_string_equal(product.job, job);
    assert_string_equal(product.needs, needs);
    assert_int_equal(product.read_count, reads);
    for (size_t k = 0; k < reads; k++)
        assert_true(*product.reads[k] == '/');
    size_t length = strlen(product.command), tail = strlen(ending);
    assert_true(length >= tail);
    assert_string_equal(product.command + length - tail, ending);
    product_free(&product);
}

static void test_products(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 5, "", "qsm,map", "overlap"));
    const struct plan *plan = &given.plan;
    assert_int_equal(plan->count, 4 * 5 + 2);
    check_product(plan, "0009.grains.hdf", "grains", "", 2, "/9.tif");
    check_product(plan, "0008.tracks.hdf", "tracks_0", "0009.grains.hdf", 3, "/8.tif");
    check_product(plan, "0009.tracks.hdf", "tracks_0", "0009.grains.hdf 0008.tracks.hdf", 3, "/9.tif");
    check_product(plan, "0010.tracks.hdf", "tracks_1", "0009.grains.hdf", 3, "/10.tif");
    check_product(plan, "0012.tracks.hdf", "tracks_2", "0009.grains.hdf", 3, "/12.tif");
    check_product(plan, "0008.contacts.hdf", "contacts_0", "0008.tracks.hdf", 2, "scene.json 0008.tracks.hdf");
    check_product(plan, "0010.contacts.hdf", "contacts_1", "0009.contacts.hdf 0010.tracks.hdf", 2,
                  " --previous 0009.contacts.hdf 0010.tracks.hdf");
    check_product(plan, "0010.forces.hdf", "forces_1", "0009.forces.hdf 0010.contacts.hdf", 0,
                  " --method qsm,map --start overlap --previous 0009.forces.hdf 0010.contacts.hdf");
    check_product(plan, "0010.forces.png", "forces_1", "0010.forces.hdf", 0,
                  "/report map --method qsm 0010.forces.hdf");
    struct product page;
    assert_int_equal(find(plan, "report.html", &page), plan->count - 1);
    assert_int_equal(strlen(page.needs), 5 * (15 + 17 + 15) + 15 + 3 * 5);
    assert_non_null(strstr(page.command, "$'/run it' report.html "));
    product_free(&page);
    end(&given);
}

/* Each result comes after those that it is made from, none twice. */
static void check_order(const struct plan *plan)
{
    for (size_t k = 0; k < plan->count; k++) {
        struct product product;
        char *rest = NULL;
        check_done(plan_product(plan, k, &product));
        for (char *name = strtok_r(product.needs, " ", &rest); name; name = strtok_r(NULL, " ", &rest)) {
            struct product before;
            assert_true(find(plan, name, &before) < k);
            product_free(&before);
        }
        product_free(&product);
        for (size_t other = 0; other < k; other++)
            assert_string_not_equal(plan_name(plan, other).name, plan_name(plan, k).name);
    }
}

/* What comes behind a gap goes on from the last photo there is, in tracks only inside the block. */
static void check_gap(const struct plan *plan, int skipped)
{
    assert_int_equal(plan->count, 4 * (skipped ? 5 : 6) + 2);
    check_product(plan, "0011.tracks.hdf", "tracks_0", "0009.grains.hdf 0009.tracks.hdf", 3, "/11.tif");
    check_product(plan, "0012.tracks.hdf", "tracks_1", "0009.grains.hdf", 3, "/12.tif");
    check_product(plan, "0011.contacts.hdf", "contacts_0", "0009.contacts.hdf 0011.tracks.hdf", 2,
                  " --previous 0009.contacts.hdf 0011.tracks.hdf");
    check_product(plan, "0011.forces.hdf", "forces_0", "0009.forces.hdf 0011.contacts.hdf", 0,
                  " --previous 0009.forces.hdf 0011.contacts.hdf");
    check_product(plan, "0013.forces.hdf", "forces_1", "0012.forces.hdf 0013.contacts.hdf", 0,
                  " --previous 0012.forces.hdf 0013.contacts.hdf");
    struct product page;
    find(plan, "report.html", &page);
    assert_null(strstr(page.needs, "0010."));
    assert_non_null(strstr(page.needs, "0011.forces.hdf"));
    product_free(&page);
    check_order(plan);
}

/* Photo 10 is skipped, or is not there: then its own results alone are to fail. */
static void test_gap(void **state)
{
    (void)state;
    struct given given;
    char list[100] = "";
    touch(FOLDER "/13.tif", 0);
    for (int skipped = 0; skipped < 2; skipped++) {
        remove(FOLDER "/10.tif");
        check_done(
            try_plan_of(&given, 6, "", "map", "", skipped ? ", \"block\": 4, \"skip\": [10]" : ", \"block\": 4"));
        check_gap(&given.plan, skipped);
        if (!skipped)
            check_product(&given.plan, "0010.tracks.hdf", "tracks_0", "0009.grains.hdf 0009.tracks.hdf", 3, "/10.tif");
        check_done(plan_begin(&given.plan));
        FILE *file = fopen(OUT "/" PLAN_CONTACTS_LIST, "r");
        assert_true(file && fread(list, 1, sizeof list, file) == 5 * 18);
        fclose(file);
        assert_null(memmem(list, 5 * 18, "0010", 4));
        end(&given);
    }
    touch(FOLDER "/10.tif", 0);
    check_done(try_plan_of(&given, 6, "", "map", "", ", \"block\": 4, \"skip\": [10]"));
    check_gap(&given.plan, 1); /* a bad photo that lies there is left out as well */
    end(&given);
}

static void test_together(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 3, "\"forces\": {\"method\": \"series\"},", "", ""));
    assert_true(given.plan.together);
    assert_int_equal(given.plan.count, 4 * 3 + 3);
    check_product(&given.plan, "series.csv", "forces", "0008.contacts.hdf 0009.contacts.hdf 0010.contacts.hdf", 0,
                  " --method series $(<.scene/contacts.list)");
    check_product(&given.plan, "0009.forces.hdf", "forces", "series.csv", 0, "");
    check_product(&given.plan, "0009.forces.png", "forces", "0009.forces.hdf", 0, " --method series 0009.forces.hdf");
    check_order(&given.plan);
    end(&given);
    check_done(try_plan(&given, 3, "\"forces\": {\"method\": \"series\"},", "map", ""));
    assert_false(given.plan.together);
    check_order(&given.plan);
    end(&given);
}

/* A file to start from is read; a word is not, even where a file has its name. */
static void test_start(void **state)
{
    (void)state;
    struct given given;
    touch(FOLDER "/zero.hdf", 0);
    check_done(try_plan(&given, 2, "", "", FOLDER "/zero.hdf"));
    check_product(&given.plan, "0008.forces.hdf", "forces_0", "0008.contacts.hdf", 1, "/zero.hdf 0008.contacts.hdf");
    end(&given);
    touch("overlap", 0);
    check_done(try_plan(&given, 2, "", "", "overlap"));
    check_product(&given.plan, "0008.forces.hdf", "forces_0", "0008.contacts.hdf", 0,
                  "--start overlap 0008.contacts.hdf");
    end(&given);
    remove("overlap");
}

static void test_limits(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 100000, "", "map", ""));
    end(&given);
    assert_int_equal(try_plan(&given, 100001, "", "map", ""), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "are 100001 photos: give at most 100000"));
    scene_free(&given.scene);
    check_done(try_plan(&given, 10000, "", "series", ""));
    end(&given);
    assert_int_equal(try_plan(&given, 10001, "", "series", ""), -1);
    scene_free(&given.scene);
}

/* What scene_check() gives for walls of 0.2 m, 1000 px of 2e-4 m, pushed with `force` N. */
static int check_of(double force, const char *more, double kn, double scale)
{
    struct given given;
    char keys[500], loads[200];
    snprintf(loads, sizeof loads, "index,wall,fx_N,fy_N\n8,top,0,%g\n9,top,0,%g\n10,top,0,0\n", -force, -force / 2);
    write_text(FOLDER "/loads.csv", loads);
    snprintf(keys, sizeof keys,
             "\"frame\": {\"corners_px\": [[0, 0], [1000, 0], [1000, 1000], [0, 1000]]}, \"scale_m_per_px\": %g, %s "
             "\"contact\": {\"law\": \"linear\", \"kn_N_per_m\": %g},",
             scale, more, kn);
    check_done(try_plan(&given, 3, keys, "", ""));
    error_clear();
    int status = scene_check(&given.scene) ? error_status() : 0;
    end(&given);
    return status;
}

/* Overlap of a radius: 2 F / (L kn). In pixels with a radius r: r times as much, without one a tenth of the frame. */
static void test_overlaps(void **state)
{
    (void)state;
    const char *radius = "\"grains\": {\"radius_px\": [5, 15]},";
    assert_int_equal(check_of(0.99e4, radius, 1e6, 2e-4), 0);
    assert_int_equal(check_of(1.01e4, radius, 1e6, 2e-4), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "of a radius, where 0.1 is too much: put loads right first"));
    assert_int_equal(check_of(1e3, "", 1e4, 2e-4), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "put contact.kn_N_per_m right first"));
    assert_int_equal(check_of(1e3, "", 1e6, 2e-7), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "put scale_m_per_px right first"));
    assert_int_equal(check_of(10.1, radius, 1e6, 2e-4), 0);
    assert_int_equal(check_of(9.9, radius, 1e6, 2e-4), EXIT_FLAGGED);
    assert_non_null(strstr(error_message(), "overlaps of 0.00099 px, which no photo shows: look at loads first"));
    assert_int_equal(check_of(1.01, "", 1e6, 2e-4), 0);
    assert_int_equal(check_of(0.99, "", 1e6, 2e-4), EXIT_FLAGGED);
    assert_int_equal(check_of(1e3, "", 1e12, 2e-4), EXIT_FLAGGED);
    assert_non_null(strstr(error_message(), "look at contact.kn_N_per_m first"));
    touch(FOLDER "/loads.csv", 0);
}

/* bash reads the word that was quoted, for every byte and for some that would be commands. */
static void test_quote(void **state)
{
    (void)state;
    char all[256];
    for (int k = 0; k < 255; k++)
        all[k] = (char)(k + 1);
    all[255] = '\0';
    const char *const words[] = {all,   "",  "plain-1.tif", "$(id)", "`id`", "a b",   "it's",
                                 "\\'", "~", "-n",          "\n",    "*",    "{a,b}", NULL};
    for (int k = 0; words[k]; k++) {
        char *command = NULL, *said = NULL;
        size_t size, room = 0;
        FILE *stream = open_memstream(&command, &size);
        fputs("printf '%s\\0' ", stream);
        shell_word(stream, words[k]);
        fclose(stream);
        assert_null(strchr(command, '\n'));
        write_text(FOLDER "/quoted", command);
        FILE *answer = popen("/bin/bash " FOLDER "/quoted", "r");
        assert_non_null(answer);
        assert_true(getdelim(&said, &room, '\0', answer) > 0);
        assert_string_equal(said, words[k]);
        assert_int_equal(pclose(answer), 0);
        free(command);
        free(said);
    }
}

static int is_changed(const struct plan *plan, const char *name)
{
    int parts[PLAN_STAGES];
    struct product product;
    plan_changed_parts(plan, parts);
    find(plan, name, &product);
    int changed = plan_is_changed(plan, parts, &product);
    product_free(&product);
    return changed;
}

/* All is there, made at second 10 from what is of second 0 or 5. */
static void make_results(const struct plan *plan)
{
    char path[200];
    for (size_t k = 0; k < plan->count; k++) {
        snprintf(path, sizeof path, OUT "/%s", plan_name(plan, k).name);
        touch(path, 10);
    }
    for (int stage = 0; stage < PLAN_STAGES; stage++) {
        snprintf(path, sizeof path, OUT "/.scene/%s", PLAN_STAGE[stage]);
        touch(path, 5);
    }
}

static int any_changed(const struct plan *plan)
{
    int changed = 0;
    for (size_t k = 0; k < plan->count; k++)
        changed += is_changed(plan, plan_name(plan, k).name);
    return changed;
}

static void test_changed(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 3, "", "map", ""));
    const struct plan *plan = &given.plan;
    assert_int_equal(any_changed(plan), 0); /* nothing is there, so nothing is older than it should be */
    check_done(plan_begin(plan));
    make_results(plan);
    assert_int_equal(any_changed(plan), 0);
    touch(FOLDER "/10.tif", 20);
    assert_int_equal(is_changed(plan, "0010.tracks.hdf"), 1);
    assert_int_equal(any_changed(plan), 1);
    touch(FOLDER "/10.tif", 10); /* of the same time is not newer */
    assert_int_equal(any_changed(plan), 0);
    touch(FOLDER "/9.tif", 20); /* the reference */
    assert_int_equal(any_changed(plan), 4);
    touch(FOLDER "/9.tif", 0);
    touch(FOLDER "/loads.csv", 20);
    assert_int_equal(any_changed(plan), 3);
    touch(FOLDER "/loads.csv", 0);
    touch(FOLDER "/lens.json", 20);
    assert_int_equal(any_changed(plan), 7);
    touch(FOLDER "/lens.json", 0);
    touch(FOLDER "/bin/forces", 20);
    assert_int_equal(any_changed(plan), 3);
    touch(FOLDER "/bin/forces", 0);
    touch(OUT "/.scene/report", 20);
    assert_int_equal(any_changed(plan), 4);
    touch(OUT "/.scene/report", 5);
    touch(OUT "/.running/0009.contacts.hdf", 0);
    assert_int_equal(is_changed(plan, "0009.contacts.hdf"), 1);
    check_done(plan_begin(plan)); /* and then it is gone */
    assert_int_equal(access(OUT "/0009.contacts.hdf", F_OK), -1);
    assert_int_equal(access(OUT "/.running/0009.contacts.hdf", F_OK), -1);
    end(&given);
}

/* Another method changes forces and what is shown; another friction all that comes after the tracks. */
static void test_parts(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 3, "", "map", ""));
    check_done(plan_begin(&given.plan));
    make_results(&given.plan);
    end(&given);
    check_done(try_plan(&given, 3, "", "qsm", ""));
    assert_int_equal(any_changed(&given.plan), 3 + 4);
    end(&given);
    check_done(try_plan(&given, 3, "\"contact\": {\"law\": \"linear\", \"mu\": 0.5},", "map", ""));
    assert_int_equal(any_changed(&given.plan), 3 + 3 + 4);
    assert_int_equal(is_changed(&given.plan, "0009.tracks.hdf"), 0);
    end(&given);
    /* One file of those that series.csv stands for is lost. */
    check_done(try_plan(&given, 3, "", "series", ""));
    check_done(plan_begin(&given.plan));
    make_results(&given.plan);
    assert_int_equal(any_changed(&given.plan), 0);
    remove(OUT "/0010.forces.hdf");
    assert_int_equal(is_changed(&given.plan, "series.csv"), 1);
    end(&given);
}

static void test_no_links(void **state)
{
    (void)state;
    struct given given;
    check_done(try_plan(&given, 3, "", "map", ""));
    touch(FOLDER "/ours", 0);
    remove(OUT "/.scene/tracker");
    assert_int_equal(symlink("../../ours", OUT "/.scene/tracker"), 0);
    assert_int_equal(plan_begin(&given.plan), -1);
    assert_non_null(strstr(error_message(), ".scene/tracker: is a symbolic link"));
    struct stat info;
    assert_int_equal(stat(FOLDER "/ours", &info), 0);
    assert_int_equal(info.st_size, 0);
    remove(OUT "/.scene/tracker");
    end(&given);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_overlaps), cmocka_unit_test(test_products),
                                       cmocka_unit_test(test_gap),      cmocka_unit_test(test_together),
                                       cmocka_unit_test(test_start),    cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_quote),    cmocka_unit_test(test_changed),
                                       cmocka_unit_test(test_parts),    cmocka_unit_test(test_no_links)};
    return cmocka_run_group_tests(tests, make_files, NULL);
}
