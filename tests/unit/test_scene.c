/* The scene: the example of the contract is read whole; every kind of mistake is refused where it stands. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/pattern.h"
#include "pipeline/scene/scene.h"
#include "pipeline/files/json.h"
#include "pipeline/scene/scene_part.h"

static char folder[] = "test_scene_XXXXXX";
static char file_name[64];

static const char whole[] =
    "{ \"schema\": \"film.scene/1\", \"name\": \"oedometer\",\n"
    "  \"photos\": {\"pattern\": \"photos/{index:04d}.tif\", \"first\": 0, \"last\": 12, \"reference\": 1,\n"
    "    \"interval_s\": 5, \"size_px\": [10320, 7752], \"channel\": \"grey\", \"block\": 7},\n"
    "  \"scale_m_per_px\": 6.0e-5, \"origin_px\": [568, 7043], \"lens\": \"lens.json\",\n"
    "  \"drift_patches_px\": [[100, 50, 500, 450]],\n"
    "  \"frame\": {\"corners_px\": [[578,1453],[7260,1510],[7255,7070],[568,7043]], \"corner_radius_px\": 231,\n"
    "    \"markers_px\": [{\"wall\": \"top\", \"rect\": [3000, 1200, 3300, 1400]}]},\n"
    "  \"grains\": {\"radius_px\": [14, 168], \"density_kg_m3\": 730, \"length_m\": 0.06},\n"
    "  \"contact\": {\"law\": \"linear\", \"kn_N_per_m\": 1.09e7, \"kt_over_kn\": 0.8, \"mu\": 0.53, \"mu_wall\": "
    "0.1},\n"
    "  \"gravity_m_per_s2\": [0, -9.81], \"loads\": \"loads/cycle 1.csv\",\n"
    "  \"findgrains\": {}, \"tracker\": {\"subset\": 0.8}, \"contacts\": {\"radius_offset_px\": \"auto\"},\n"
    "  \"forces\": {\"method\": \"map\"}, \"simulation\": {\"seed\": 1}, \"optics\": {} }\n";

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(file_name, sizeof file_name, "%s/scene.json", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    unlink(file_name);
    return rmdir(folder);
}

static int read_text(const char *text, struct scene *scene)
{
    FILE *file = fopen(file_name, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    error_clear();
    return scene_read(file_name, scene);
}

static void reads_the_whole_example(void **state)
{
    (void)state;
    struct scene scene;
    char joined[128];
    check_done(read_text(whole, &scene));
    assert_string_equal(scene.name, "oedometer");
    assert_string_equal(scene.folder, folder);
    assert_true(scene.photos.given && scene.frame.given && scene.contact_given);
    assert_int_equal(scene.photos.first, 0);
    assert_int_equal(scene.photos.last, 12);
    assert_int_equal(scene.photos.reference, 1);
    check_near(scene.photos.interval_s, 5, 0);
    assert_int_equal(scene.photos.width, 10320);
    assert_int_equal(scene.photos.height, 7752);
    assert_int_equal(scene.photos.channel, PHOTO_GREY_OF_RGB);
    assert_int_equal(scene.photos.block, 7);
    check_near(scene.scale, 6e-5, 0);
    check_near(scene.origin_px.x, 568, 0);
    check_near(scene.origin_px.y, 7043, 0);
    snprintf(joined, sizeof joined, "%s/lens.json", folder);
    assert_string_equal(scene.lens, joined);
    snprintf(joined, sizeof joined, "%s/loads/cycle 1.csv", folder);
    assert_string_equal(scene.loads, joined);
    assert_int_equal(scene.drift_patch_count, 1);
    check_near(scene.drift_patches[0].y1, 450, 0);
    check_near(scene.frame.corners_px[CORNER_BOTTOM_RIGHT].x, 7255, 0);
    check_near(scene.frame.corners_px[CORNER_BOTTOM_LEFT].y, 7043, 0);
    check_near(scene.frame.corner_radius_px, 231, 0);
    assert_int_equal(scene.frame.marker_count, 1);
    assert_string_equal(scene.frame.markers[0].wall, "top");
    check_near(scene.frame.markers[0].rect.x1, 3300, 0);
    check_near(scene.grains.radius_min_px, 14, 0);
    check_near(scene.grains.radius_max_px, 168, 0);
    check_near(scene.grains.density, 730, 0);
    check_near(scene.grains.length, 0.06, 0);
    check_near(scene.contact.kn, 1.09e7, 0);
    check_near(scene.contact.kt_over_kn, 0.8, 0);
    check_near(scene.contact.mu, 0.53, 0);
    check_near(scene.contact.mu_wall, 0.1, 0);
    check_near(scene.gravity.y, -9.81, 0);
    assert_non_null(scene_section(&scene, "simulation"));
    assert_non_null(cJSON_GetObjectItem(scene_section(&scene, "tracker"), "subset"));
    scene_free(&scene);
    scene_free(&scene); /* a zeroed struct is fine */
}

static void what_is_left_out_is_not_modelled(void **state)
{
    (void)state;
    struct scene scene;
    check_done(read_text("{\"schema\": \"film.scene/1\", \"name\": \"x\"}", &scene));
    assert_false(scene.photos.given || scene.frame.given || scene.contact_given);
    assert_null(scene.lens);
    assert_null(scene.loads);
    assert_null(scene.photos.pattern);
    assert_true(isnan(scene.scale) && isnan(scene.photos.interval_s) && isnan(scene.grains.radius_min_px));
    assert_true(isnan(scene.grains.density) && isnan(scene.grains.length));
    assert_true(isnan(scene.contact.kn) && isnan(scene.contact.mu));
    check_near(scene.contact.kt_over_kn, 1, 0);
    check_near(scene.contact.mu_wall, 0, 0);
    check_near(scene.origin_px.x, 0, 0);
    check_near(vec_norm(scene.gravity), 0, 0);
    assert_int_equal(scene.photos.channel, PHOTO_GREY_ONLY);
    assert_int_equal(scene.photos.block, 20);
    assert_null(scene_section(&scene, "tracker"));
    assert_null(scene_photo_path(&scene, 3));
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_int_equal(scene_photo_index(&scene, "0003.tif"), -1);
    assert_int_equal(scene_lacks(&scene, "contact.mu", "forces needs the friction coefficient"), -1);
    assert_non_null(strstr(error_message(), "'contact.mu' is missing: forces needs"));
    scene_free(&scene);
}

/* In the whole example, `from` becomes `to`; the scene is refused with `expected` in the line. */
static void check_refused(const char *from, const char *to, const char *expected)
{
    char text[sizeof whole + 300];
    const char *at = strstr(whole, from);
    struct scene scene;
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - whole), whole, to, at + strlen(from));
    int status = read_text(text, &scene);
    if (status != -1 || error_status() != EXIT_INPUT || !strstr(error_message(), expected))
        print_error("%s -> %s\nexpected: %s\nmessage: %s\n", from, to, expected, error_message());
    assert_int_equal(status, -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), expected));
    assert_int_equal(strncmp(error_message(), file_name, strlen(file_name)), 0);
    assert_null(scene.path); /* freed */
}

static void refuses_mistakes_in_the_root(void **state)
{
    (void)state;
    check_refused("film.scene/1", "film.scene/2", ":1:13: this is not a scene");
    check_refused("\"schema\"", "\"skema\"", ":1:1: this is not a scene");
    check_refused("\"name\": \"oedometer\",", "", "'name' is missing");
    check_refused("\"oedometer\"", "\"\"", ":1:37: 'name' is missing");
    check_refused("\"gravity_m_per_s2\"", "\"graivty_m_per_s2\"", ":10:3: unknown key 'graivty_m_per_s2': did you");
    check_refused("\"tracker\": {\"subset\": 0.8}", "\"tracker\": 1", ":11:32: 'tracker' must be a group");
    check_refused("6.0e-5", "0", ":4:21: 'scale_m_per_px' must be");
    check_refused("6.0e-5", "1e-300", "'scale_m_per_px' must be"); /* what is painted would never be done */
    check_refused("6.0e-5", "-1", ":4:21: ");
    check_refused("6.0e-5", "\"6.0e-5\"", "'scale_m_per_px' must be a number");
    check_refused("[568, 7043], \"lens\"", "[568], \"lens\"", "'origin_px' must be a list of 2 numbers");
    check_refused("[0, -9.81]", "[0, 1e999]", ":10:27: the number is not finite");
    check_refused("\"density_kg_m3\": 730, ", "", ":10:23: gravity needs masses");
    check_refused("\"loads/cycle 1.csv\"", "\"/etc/loads.csv\"", ":10:44: an absolute path");
    check_refused("\"loads/cycle 1.csv\"", "\"../loads.csv\"", "'..' in a path");
    check_refused("\"loads/cycle 1.csv\"", "\"a/../loads.csv\"", "'..' in a path");
    check_refused("\"loads/cycle 1.csv\"", "\"a/..\"", "'..' in a path");
    check_refused("\"loads/cycle 1.csv\"", "\"\"", "an empty path");
    check_refused("\"lens.json\"", "\"a\\nb\"", "a control character");
    check_refused("\"lens.json\"", "7", "'lens' must be text");
}

/* The photos that count, in ascending order whatever the order of the list. */
static void photos_may_be_skipped(void **state)
{
    (void)state;
    struct scene scene;
    check_done(read_text("{\"schema\": \"film.scene/1\", \"name\": \"x\", \"photos\": {\"pattern\": \"{index}.tif\", "
                         "\"first\": 3, \"last\": 9, \"reference\": 5, \"skip\": [9, 3, 7, 6]}}",
                         &scene));
    const long expected[] = {4, 5, 8, 10};
    long index = scene.photos.first - 1;
    for (int k = 0; k < 4; k++)
        assert_int_equal(index = scene_photo_next(&scene, index), expected[k]);
    assert_true(scene_photo_skipped(&scene, 3) && scene_photo_skipped(&scene, 9) && !scene_photo_skipped(&scene, 5));
    char *before = scene_part(&scene, "findgrains"), *tracks = scene_part(&scene, "tracker");
    assert_null(strstr(before, "skip"));
    assert_non_null(strstr(tracks, "skip")); /* the photo behind a gap starts from another one */
    free(before);
    free(tracks);
    scene_free(&scene);
    check_done(read_text("{\"schema\": \"film.scene/1\", \"name\": \"x\"}", &scene));
    assert_false(scene_photo_skipped(&scene, 0));
    scene_free(&scene);
    check_refused("\"block\": 7", "\"skip\": [3, 13]", "'skip' names photos that the series does not have");
    check_refused("\"block\": 7", "\"skip\": [-1]", "'skip' names photos that the series does not have");
    check_refused("\"block\": 7", "\"skip\": [2.5]", "'skip' names photos that the series does not have");
    check_refused("\"block\": 7", "\"skip\": [\"3\"]", "'skip' names photos that the series does not have");
    check_refused("\"block\": 7", "\"skip\": 3", "'skip' must be");
    check_refused("\"block\": 7", "\"skip\": [4, 2, 4]", "'skip' names photo 4 twice");
    check_refused("\"block\": 7", "\"skip\": [1]", "'skip' names the reference photo");
}

static void refuses_mistakes_in_photos(void **state)
{
    (void)state;
    check_refused("{index:04d}", "{index:4d}", "write the number as");
    check_refused("{index:04d}", "%04d", "put {index}");
    check_refused("{index:04d}", "{index:04d}{index}", "exactly one {index}");
    check_refused("{index:04d}", "}{index}", "exactly one {index}");
    check_refused("{index:04d}", "{index:00d}", "write the number as");
    check_refused("{index:04d}", "{index:010d}", "write the number as");
    check_refused("{index:04d}", "{index", "write the number as");
    check_refused("photos/{index:04d}.tif", "{index}/p.tif", "into the file's name");
    check_refused("photos/{index:04d}.tif", "/photos/{index:04d}.tif", "an absolute path");
    check_refused("photos/{index:04d}.tif", "../{index:04d}.tif", "'..' in a path");
    check_refused("\"last\": 12,", "", "belong together");
    check_refused("\"first\": 0", "\"first\": 13", "'last' is before 'first'");
    check_refused("\"first\": 0", "\"first\": -1", "'first' must be");
    check_refused("\"first\": 0", "\"first\": 0.5", "'first' must be a whole number");
    check_refused("\"reference\": 1", "\"reference\": 13", "'reference' must be");
    check_refused("\"interval_s\": 5", "\"interval_s\": 0", "'interval_s' must be");
    check_refused("[10320, 7752]", "[10320, 0]", ":3:33: 'size_px' must be");
    check_refused("[10320, 7752]", "[10320, 7752.5]", "'size_px' must be");
    check_refused("[10320, 7752]", "[999999, 999999]", "more than 1073741824 pixels");
    check_refused("\"channel\": \"grey\"", "\"channel\": \"gray\"", "give one of: grey, red, green, blue");
    check_refused("\"block\": 7", "\"block\": 0", "'block' must be");
    check_refused("\"block\": 7", "\"blok\": 7", "did you mean 'block'");
}

static void refuses_mistakes_in_groups(void **state)
{
    (void)state;
    check_refused("[[100, 50, 500, 450]]", "[[500, 50, 100, 450]]", ":5:24: an empty rectangle");
    check_refused("[[100, 50, 500, 450]]", "[[100, 50, 500]]", "four numbers");
    check_refused("[[100, 50, 500, 450]]", "[[100, 50, 11000, 450]]", "leaves the photo");
    check_refused("[[100, 50, 500, 450]]", "[100, 50, 500, 450]", ":5:24: a rectangle is four numbers");
    check_refused("[[578,1453],[7260,1510],[7255,7070],[568,7043]]", "[[578,1453],[7260,1510],[7255,7070]]",
                  "four corners");
    check_refused("[[578,1453],[7260,1510],[7255,7070],[568,7043]]", "[[568,7043],[7255,7070],[7260,1510],[578,1453]]",
                  "right order");
    check_refused("[[578,1453],[7260,1510],[7255,7070],[568,7043]]", "[[7260,1510],[7255,7070],[568,7043],[578,1453]]",
                  "begin at the wrong one");
    check_refused("[[578,1453],[7260,1510],[7255,7070],[568,7043]]", "[[578,1453],[7260,1510],[3000,3000],[568,7043]]",
                  "no convex frame");
    check_refused("[568,7043]],", "[568,\"7043\"]],", "a corner is two numbers");
    check_refused("\"corner_radius_px\": 231", "\"corner_radius_px\": 2900", "'corner_radius_px' must be");
    check_refused("\"wall\": \"top\"", "\"wall\": \"up\"", "give one of: top, bottom, left, right");
    check_refused("\"wall\": \"top\", ", "", "a marker needs 'wall' and 'rect'");
    check_refused("[14, 168]", "[168, 14]", ":8:27: 'radius_px' is no range");
    check_refused("[14, 168]", "[0, 14]", "'radius_px' is no range");
    check_refused("[14, 168]", "[0.5, 14]", "'radius_px' is no range"); /* nothing can be seen of such a grain */
    check_refused("[14, 168]", "[1e-9, 1]", "'radius_px' is no range");
    check_refused("\"density_kg_m3\": 730", "\"density_kg_m3\": -730", "'density_kg_m3' must be");
    check_refused("\"length_m\"", "\"length_mm\"", "did you mean 'length_m'");
    check_refused("\"linear\"", "\"hertz-ish\"", "give one of: linear");
    check_refused("1.09e7", "0", "'kn_N_per_m' must be");
    check_refused("\"mu\": 0.53", "\"mu\": -0.1", "'mu' must be");
    check_refused("\"kt_over_kn\"", "\"kt_ovr_kn\"", "did you mean 'kt_over_kn'");
}

static void patterns(void **state)
{
    (void)state;
    assert_null(pattern_check("a{index}.tif", 0));
    assert_non_null(pattern_check("a.tif", 0));
    char *name = pattern_format("d%d/p_{index:04d}_%s.tif", 7);
    assert_string_equal(name, "d%d/p_0007_%s.tif"); /* a pattern is never a printf format */
    free(name);
    name = pattern_format("{index:03d}", 12345);
    assert_string_equal(name, "12345");
    free(name);
    assert_int_equal(pattern_index("photos/{index:04d}.tif", "elsewhere/0012.tif"), 12);
    assert_int_equal(pattern_index("{index:04d}.tif", "12345.tif"), 12345);
    assert_int_equal(pattern_index("{index:04d}.tif", "012.tif"), -1);
    assert_int_equal(pattern_index("{index:04d}.tif", "00012.tif"), -1);
    assert_int_equal(pattern_index("{index}.tif", "7.tif"), 7);
    assert_null(pattern_check("one.tif", 1)); /* a single photo needs no number */
    assert_non_null(pattern_check("one.tif", 0));
    assert_non_null(pattern_check("one}.tif", 1));
    assert_int_equal(pattern_index("photos/one.tif", "elsewhere/one.tif"), 0);
    assert_int_equal(pattern_index("photos/one.tif", "elsewhere/two.tif"), -1);
    assert_int_equal(pattern_index("{index}.tif", "07.tif"), -1);
    assert_int_equal(pattern_index("{index}.tif", "-7.tif"), -1);
    assert_int_equal(pattern_index("{index}.tif", ".tif"), -1);
    assert_int_equal(pattern_index("p{index}.tif", "p7.tiff"), -1);
    assert_int_equal(pattern_index("{index}.tif", "99999999999999999999.tif"), -1);
    assert_int_equal(pattern_index("a{index}a", "aa"), -1);
}

static void photos_of_a_series(void **state)
{
    (void)state;
    struct scene scene;
    char expected[128];
    check_done(read_text(whole, &scene));
    char *path = scene_photo_path(&scene, 3);
    snprintf(expected, sizeof expected, "%s/photos/0003.tif", folder);
    assert_string_equal(path, expected);
    free(path);
    assert_int_equal(scene_photo_index(&scene, expected), 3);
    assert_int_equal(scene_photo_index(&scene, "0013.tif"), -1); /* after the last */
    assert_int_equal(scene_photo_index(&scene, "other.tif"), -1);
    check_near(scene_time(&scene, 3), 15, 0);
    assert_true(isnan(scene_time(&scene, -1)));
    struct photo_request request = scene_photo_request(&scene);
    assert_int_equal(request.width, 10320);
    assert_int_equal(request.channel, PHOTO_GREY_OF_RGB);
    scene_free(&scene);
}

static void pixels_become_metres(void **state)
{
    (void)state;
    struct scene scene;
    check_done(read_text(whole, &scene));
    struct vec m = scene_metres(&scene, vec(668, 7143)); /* 100 px right, 100 px below the origin */
    check_near(m.x, 6e-3, 1e-15);
    check_near(m.y, -6e-3, 1e-15);
    struct vec px = scene_pixels(&scene, m);
    check_near(px.x, 668, 1e-9);
    check_near(px.y, 7143, 1e-9);
    scene_free(&scene);
}

/* A scene beside the user: no folder in its path. */
static void a_scene_without_a_folder(void **state)
{
    (void)state;
    struct scene scene;
    check_done(read_text(whole, &scene));
    scene_free(&scene);
    assert_int_equal(chdir(folder), 0);
    int status = scene_read("scene.json", &scene);
    assert_int_equal(chdir(".."), 0);
    check_done(status);
    assert_string_equal(scene.folder, ".");
    char *path = scene_photo_path(&scene, 0);
    assert_string_equal(path, "photos/0000.tif");
    free(path);
    scene_free(&scene);
}

/* A link that leads out of the scene's folder, and one that stays in it. */
static void links_lead_nowhere_else(void **state)
{
    (void)state;
    char link[80], folder_of_links[80];
    struct scene scene;
    snprintf(link, sizeof link, "%s/lens.json", folder);
    assert_int_equal(symlink("/etc/passwd", link), 0);
    assert_int_equal(read_text(whole, &scene), -1);
    assert_non_null(strstr(error_message(), "a symbolic link there leads out of the scene's folder"));
    assert_int_equal(error_status(), EXIT_INPUT);
    unlink(link);
    assert_int_equal(symlink("scene.json", link), 0);
    check_done(read_text(whole, &scene));
    snprintf(folder_of_links, sizeof folder_of_links, "%s/photos", folder);
    assert_int_equal(symlink("/", folder_of_links), 0);
    assert_non_null(scene.lens);
    char *path = scene_photo_path(&scene, 3); /* /0003.tif is not there: it leads nowhere */
    assert_non_null(path);
    free(path);
    unlink(folder_of_links);
    scene_free(&scene);
    unlink(link);
}

/* Last: it holds for the whole process. */
static void outside_where_allowed(void **state)
{
    (void)state;
    char link[80];
    struct scene scene;
    char text[sizeof whole + 100];
    const char *at = strstr(whole, "loads/cycle 1.csv");
    scene_allow_outside();
    snprintf(text, sizeof text, "%.*s/data/../loads.csv%s", (int)(at - whole), whole, at + strlen("loads/cycle 1.csv"));
    snprintf(link, sizeof link, "%s/lens.json", folder);
    assert_int_equal(symlink("/etc/passwd", link), 0);
    check_done(read_text(text, &scene));
    assert_string_equal(scene.loads, "/data/../loads.csv");
    scene_free(&scene);
    unlink(link);
    check_refused("\"loads/cycle 1.csv\"", "\"\"", "an empty path");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_whole_example),
        cmocka_unit_test(what_is_left_out_is_not_modelled),
        cmocka_unit_test(refuses_mistakes_in_the_root),
        cmocka_unit_test(photos_may_be_skipped),
        cmocka_unit_test(refuses_mistakes_in_photos),
        cmocka_unit_test(refuses_mistakes_in_groups),
        cmocka_unit_test(patterns),
        cmocka_unit_test(photos_of_a_series),
        cmocka_unit_test(pixels_become_metres),
        cmocka_unit_test(a_scene_without_a_folder),
        cmocka_unit_test(links_lead_nowhere_else),
        cmocka_unit_test(outside_where_allowed),
    };
    return cmocka_run_group_tests_name("scene", tests, make_folder, remove_folder);
}
