/* What every program says and with which status it ends, seen from outside: the program `speaker` is run. */
#include "pipeline/speak/version.h"
#include "tests/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define SPEAKER FILM_BINARY_DIR "/tests/speaker"
static const char good[] = SPEAKER " --scene s.json -o out ";

static char out[4000], err[4000];

static void read_back(const char *name, char *text, size_t size)
{
    FILE *file = fopen(name, "r");
    assert_non_null(file);
    size_t n = fread(text, 1, size - 1, file);
    text[n] = '\0';
    fclose(file);
    unlink(name);
}

/* Run a shell command; its exit status, and what it wrote in `out` and `err`. */
static int run(const char *command, const char *arguments)
{
    char line[1000];
    snprintf(line, sizeof line, "%s %s >test_cli.out.tmp 2>test_cli.err.tmp", command, arguments);
    int status = system(line);
    read_back("test_cli.out.tmp", out, sizeof out);
    read_back("test_cli.err.tmp", err, sizeof err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static int lines(const char *text)
{
    int count = 0;
    for (; *text; text++)
        count += *text == '\n';
    return count;
}

static void help_and_version_are_data(void **state)
{
    (void)state;
    assert_int_equal(run(SPEAKER, "--help"), 0);
    assert_string_equal(err, "");
    static const char *const expected[] = {"Usage: speaker",  "--scene",       "--output", "--threads",
                                           "Common options:", "--max-flagged", "--size",   "default 0.05)"};
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        assert_non_null(strstr(out, expected[k]));
    assert_int_equal(run(SPEAKER, "--version"), 0);
    char version[100];
    snprintf(version, sizeof version, "speaker (film) %s\n", film_version);
    assert_string_equal(out, version);
    assert_string_equal(err, "");
}

static void a_good_command_line(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--size 2e-1 --colour green a b --threads 2"), 0);
    assert_string_equal(out, "size=0.2 colour=1 threads=2 inputs=2\n");
    assert_string_equal(err, "");
}

static void check_usage(const char *command, const char *arguments, const char *expected)
{
    int status = run(command, arguments);
    if (status != 2 || !strstr(err, expected))
        print_error("%s %s: status %d: %s", command, arguments, status, err);
    assert_int_equal(status, 2);
    assert_string_equal(out, "");
    assert_non_null(strstr(err, expected));
    assert_int_equal(strncmp(err, "speaker: ", 9), 0); /* the base name only */
}

static void a_wrong_command_line_is_2(void **state)
{
    (void)state;
    check_usage(SPEAKER, "-o out", "Give --scene");
    check_usage(SPEAKER, "--scene s.json", "Give -o OUT");
    check_usage(good, "--nonsense", "unrecognized option");
    check_usage(good, "--size", "requires an argument");
    check_usage(good, "--size ten", "--size ten: give a number");
    check_usage(good, "--size 0x1p3", "give a number");
    check_usage(good, "--size nan", "give a number");
    check_usage(good, "--size 11", "--size 11: give a number from 0 to 10");
    check_usage(good, "--colour blue", "--colour blue: give one of: red, green");
    check_usage(good, "--threads 1.5", "give a whole number");
    check_usage(good, "--threads -1", "from 0 to 4096");
    check_usage(good, "--max-flagged 2", "from 0 to 1");
}

/* What --help says of each type is what the row judges by. */
static void help_tells_range_default_and_key(void **state)
{
    (void)state;
    static const char *const expected[] = {"Size (from 0 to 10; default 0.25; scene: tracker.size)",
                                           "Draws (0, or from 2 to 100; default 0; scene: tracker.count)",
                                           "Many (from 0 to 9007199254740992; default 7; scene: tracker.group.many)",
                                           "Speak up (scene: tracker.loud)",
                                           "Colour (red, green; default red; scene: tracker.colour)",
                                           "Scale (from 0.5 to 2, or auto; default 1; scene: tracker.group.scale)",
                                           "Two (scene: tracker.pair)",
                                           "What to do\n"};
    assert_int_equal(run("ARGP_HELP_FMT=rmargin=200 " SPEAKER, "--help"), 0);
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        assert_non_null(strstr(out, expected[k]));
    assert_null(strstr(out, "depth"));
}

static void write_scene(const char *section)
{
    FILE *file = fopen("test_cli.scene.tmp", "w");
    assert_non_null(file);
    fprintf(file, "{\"schema\": \"film.scene/1\", \"name\": \"options\",\n\"tracker\": {%s}}\n", section);
    fclose(file);
}

static void check_values(const char *section, const char *arguments, const char *expected)
{
    write_scene(section);
    assert_int_equal(run(SPEAKER " --scene test_cli.scene.tmp -o out --work scene", arguments), 0);
    assert_string_equal(err, "");
    assert_string_equal(out, expected);
    unlink("test_cli.scene.tmp");
}

/* Each type from the command line, from the scene, and from both: the command line wins. */
static void the_line_wins_over_the_scene(void **state)
{
    (void)state;
    static const char section[] = "\"size\": 2.5, \"count\": 3, \"loud\": true, \"colour\": \"green\", \"pair\": "
                                  "\"5,6\", \"elsewhere\": [1], \"group\": {\"many\": 4294967296, \"scale\": "
                                  "\"auto\", \"inner\": {\"depth\": 3}}";
    static const char line[] = "--size 1e-1 --count 2 --many 9007199254740992 --scale 2 --pair 1,2 --colour red "
                               "--list a --list b";
    check_values("", "--pair 3,4 --work scene",
                 "size=0.25 count=0 many=7 loud=0 colour=red scale=1 pair=3,4 depth=0 list=0\n");
    check_values("", "", "size=0.25 count=0 many=7 loud=0 colour=red scale=1 pair=0,0 depth=0 list=0\n");
    check_values(section, "",
                 "size=2.5 count=3 many=4294967296 loud=1 colour=green scale=1 auto pair=5,6 depth=3 "
                 "list=0\n");
    check_values("", line,
                 "size=0.1 count=2 many=9007199254740992 loud=0 colour=red scale=2 pair=1,2 depth=0 "
                 "list=2\n");
    check_values(section, line,
                 "size=0.1 count=2 many=9007199254740992 loud=1 colour=red scale=2 pair=1,2 depth=3 "
                 "list=2\n");
    check_values("\"group\": {\"scale\": 0.5}", "--scale auto",
                 "size=0.25 count=0 many=7 loud=0 colour=red scale=1 auto pair=0,0 depth=0 list=0\n");
    check_values("\"loud\": false, \"count\": 0", "--loud",
                 "size=0.25 count=0 many=7 loud=1 colour=red scale=1 pair=0,0 depth=0 list=0\n");
}

/* The same value is refused by both, with the same words: status 2 from the command line, 3 from the scene. */
static void line_and_scene_are_judged_alike(void **state)
{
    (void)state;
    static const struct {
        const char *line, *section, *remedy;
    } wrong[] = {{"--size 10.5", "\"size\": 10.5", "from 0 to 10"},
                 {"--size -1e-9", "\"size\": -1e-9", "from 0 to 10"},
                 {"--size auto", "\"size\": \"auto\"", "from 0 to 10"},
                 {"--count 1", "\"count\": 1", "0, or from 2 to 100"},
                 {"--count 2.9", "\"count\": 2.9", "0, or from 2 to 100"},
                 {"--count 0.5", "\"count\": 0.5", "0, or from 2 to 100"},
                 {"--count 101", "\"count\": 101", "0, or from 2 to 100"},
                 {"--count -2", "\"count\": -2", "0, or from 2 to 100"},
                 {"--many 0.5", "\"group\": {\"many\": 0.5}", "from 0 to 9007199254740992"},
                 {"--many 1e17", "\"group\": {\"many\": 1e17}", "from 0 to 9007199254740992"},
                 {"--colour blue", "\"colour\": \"blue\"", "give one of: red, green"},
                 {"--scale 3", "\"group\": {\"scale\": 3}", "from 0.5 to 2, or auto"},
                 {"--scale automatic", "\"group\": {\"scale\": \"automatic\"}", "auto"},
                 {"--pair 1", "\"pair\": \"1\"", "give two numbers, I,J"},
                 {"--count 60 --loud", "\"count\": 60, \"loud\": true", "count above 50 and loud"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        check_usage(good, wrong[k].line, wrong[k].remedy);
        write_scene(wrong[k].section);
        assert_int_equal(run(SPEAKER " --scene test_cli.scene.tmp -o out --work scene", ""), 3);
        assert_int_equal(lines(err), 1);
        assert_non_null(strstr(err, wrong[k].remedy));
    }
    /* A wrong value of the scene is wrong also where the command line has another; what both say is judged too. */
    write_scene("\"count\": 1, \"loud\": true");
    assert_int_equal(run(SPEAKER " --scene test_cli.scene.tmp -o out --work scene", "--count 2"), 3);
    write_scene("\"loud\": true");
    assert_int_equal(run(SPEAKER " --scene test_cli.scene.tmp -o out --work scene", "--count 60"), 3);
    static const char *const unknown[] = {
        "\"sizes\": 1", "\"many\": 1", "\"group\": {\"size\": 1}", "\"group\": {\"inner\": {\"many\": 1}}",
        "\"group\": 1", "\"loud\": 1", "\"work\": \"scene\""};
    for (size_t k = 0; k < sizeof unknown / sizeof *unknown; k++) {
        write_scene(unknown[k]);
        assert_int_equal(run(SPEAKER " --scene test_cli.scene.tmp -o out --work scene", ""), 3);
        assert_non_null(strstr(err, "test_cli.scene.tmp:2:"));
    }
    unlink("test_cli.scene.tmp");
}

/* Whatever the option is called and however it is spelt. */
static void an_output_is_no_input(void **state)
{
    (void)state;
    static const char *const wrong[] = {"--scene F -o F",
                                        "--scene s -oF F",
                                        "--scene s -o x --writ=F F",
                                        "--scene s -o x --log F --list a --list F",
                                        "--scene s -o F --written ./F",
                                        "--scene s -o x --work F --log L",
                                        "--scene s -o x --pair 1,2 --log F F"};
    FILE *file = fopen("F", "w");
    assert_non_null(file);
    fclose(file);
    unlink("L"); /* of a run that failed */
    assert_int_equal(symlink("F", "L"), 0);
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        check_usage(SPEAKER, wrong[k], "would be overwritten");
    assert_int_equal(run(SPEAKER, "--scene s -o F --log new.tmp a b"), 0);
    unlink("F");
    unlink("L");
    unlink("new.tmp");
}

static void a_failure_is_one_line(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--work input"), 3);
    assert_string_equal(err, "speaker: a.tif: two?lines: do this\n");
    assert_string_equal(out, "");
    assert_int_equal(run(good, "--work memory"), 1);
    assert_int_equal(lines(err), 1);
    assert_int_equal(run(good, "--log no-such-folder/log"), 1);
    assert_int_equal(lines(err), 1);
    assert_non_null(strstr(err, "no-such-folder/log"));
    /* Standard output that cannot be written is a failure too. */
    assert_int_equal(run("sh -c '" SPEAKER " --scene s -o o >/dev/full'", ""), 1);
    assert_int_equal(lines(err), 1);
}

static int is_clean(const char *text)
{
    for (; *text; text++)
        if (((unsigned char)*text < 0x20 && *text != '\n') || *text == 0x7F || !strncmp(text, "\xC2\x9B", 2))
            return 0;
    return 1;
}

/* A word of the command line neither moves the cursor of a terminal nor makes a line of its own. */
static void odd_words_are_shown_plainly(void **state)
{
    (void)state;
    static const char *const words[] = {"--colour $'blue\\e[31m\\nspeaker: all is well'", "$'--a\\e]0;title\\a'",
                                        "--size $'\\xC2\\x9B31m'", "--log $'no-such-folder/\\e[31m\\x7F'",
                                        "--work odd"};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        char line[500];
        snprintf(line, sizeof line, "bash -c \"%s%s\"", good, words[k]);
        assert_int_not_equal(run(line, ""), 0);
        assert_int_equal(strncmp(err, "speaker: ", 9), 0);
        assert_true(is_clean(err));
        assert_int_equal(lines(err), k < 3 ? 2 : 1); /* argp: "Try ..." */
        assert_non_null(strstr(err, "?"));
    }
}

/* What a program prints is whole or its status is not 0, also when only an early part could not be written. */
static void cut_output_is_a_failure(void **state)
{
    (void)state;
    /* The disk has no room at first and has some later: the last write of all succeeds. */
    assert_int_equal(run(SPEAKER " --scene s -o o --work hole", ""), 1);
    assert_int_equal(lines(err), 1);
    assert_non_null(strstr(err, "standard output"));
}

static void many_flags_are_4(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--work flag"), 4); /* 6 of 100, default 0.05 */
    assert_int_equal(lines(err), 1);
    assert_non_null(strstr(err, "6 of 100 grains are flagged"));
    assert_int_equal(run(good, "--work flag --max-flagged 0.06"), 0);
    assert_string_equal(err, "");
}

static void a_summary_is_one_line_unless_quiet(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--work summary"), 0);
    assert_string_equal(err, "speaker: 7 grains,?0.50 px\n");
    assert_string_equal(out, "");
    assert_int_equal(run(good, "--work summary --quiet"), 0);
    assert_string_equal(err, "");
    assert_string_equal(out, "");
}

/* A warning is not for people only: --quiet does not silence it. */
static void a_doubt_is_4_and_never_silent(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--work doubt --quiet"), 4);
    assert_string_equal(err, "speaker: 0 contacts: give a radius\n");
}

static void the_log_is_json(void **state)
{
    (void)state;
    char log[2000];
    assert_int_equal(run(good, "--work log --log test_cli.log.tmp"), 0);
    read_back("test_cli.log.tmp", log, sizeof log);
    static const char first[] = "{\"event\":\"step\",\"third\":0.33333333333333331,\"missing\":null}\n";
    assert_int_equal(strncmp(log, first, strlen(first)), 0);
    assert_int_equal(lines(log), 2);
    assert_non_null(strstr(log, "{\"event\":\"finish\",\"status\":0,\"cpu_s\":"));
    assert_non_null(strstr(log, "\"peak_memory_bytes\":"));
    assert_int_equal(run(good, "--log /dev/full"), 1);
    assert_int_equal(lines(err), 1);
}

/* The bar is for people at a terminal: `script` gives the program one. */
static void the_bar_needs_a_terminal(void **state)
{
    (void)state;
    assert_int_equal(run(good, "--work count"), 0);
    assert_string_equal(out, "counted 200\n");
    assert_string_equal(err, "");
    if (system("command -v script >/dev/null"))
        return;
    assert_int_equal(run("script -qec '" SPEAKER " --scene s -o o --work count' /dev/null </dev/null", ""), 0);
    assert_non_null(strstr(out, "counting ["));
    assert_non_null(strstr(out, " of 200"));
    assert_non_null(strstr(out, "\r\033[K")); /* and is wiped away */
    assert_non_null(strstr(out, "counted 200"));
    assert_int_equal(run("script -qec '" SPEAKER " --scene s -o o --quiet --work count' /dev/null </dev/null", ""), 0);
    assert_null(strstr(out, "counting ["));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_version_are_data),
        cmocka_unit_test(a_good_command_line),
        cmocka_unit_test(a_wrong_command_line_is_2),
        cmocka_unit_test(a_failure_is_one_line),
        cmocka_unit_test(many_flags_are_4),
        cmocka_unit_test(a_summary_is_one_line_unless_quiet),
        cmocka_unit_test(a_doubt_is_4_and_never_silent),
        cmocka_unit_test(the_log_is_json),
        cmocka_unit_test(the_bar_needs_a_terminal),
        cmocka_unit_test(odd_words_are_shown_plainly),
        cmocka_unit_test(cut_output_is_a_failure),
        cmocka_unit_test(help_tells_range_default_and_key),
        cmocka_unit_test(the_line_wins_over_the_scene),
        cmocka_unit_test(line_and_scene_are_judged_alike),
        cmocka_unit_test(an_output_is_no_input),
    };
    return cmocka_run_group_tests_name("cli", tests, NULL, NULL);
}
