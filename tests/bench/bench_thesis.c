/* The figures of the thesis made again (docs/thesis.md):
 *
 *     bench_thesis FIGURE|all FOLDER
 *
 * writes FOLDER/figure-N.txt and FOLDER/figure-N.png. States made by simulate are kept in the folder for the next
 * figure. `all` leaves the figures alone that the folder already has, so that it goes on where it was stopped.
 * `bench_thesis list FOLDER` names the figures. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/speak/error.h"
#include "tests/bench/thesis.h"

static const struct figure *const CHAPTERS[] = {FIGURES_THREE_DISCS, FIGURES_THREE_PATHS, FIGURES_STARTS,
                                                FIGURES_CEM,         FIGURES_SERIES,      FIGURES_NETWORK,
                                                FIGURES_VARIABILITY};
enum { CHAPTER_COUNT = sizeof CHAPTERS / sizeof *CHAPTERS };

static void place(const char *folder, const struct figure *figure, const char *end, char path[1000])
{
    snprintf(path, 1000, "%s/figure-%s.txt%s", folder, figure->number, end);
}

/* The table gets its name when it is whole. */
static int make(const struct figure *figure, const char *folder)
{
    char part[1000], path[1000];
    place(folder, figure, ".part", part);
    place(folder, figure, "", path);
    struct thesis thesis = {folder, figure->number, fopen(part, "w")};
    if (!thesis.table)
        return error_failed("%s: %s", part, strerror(errno));
    double begin = states_cpu();
    thesis_line(&thesis, "Figure %s: %s", figure->number, figure->what);
    int status = figure->make(&thesis);
    printf("(%.1f CPU s)\n\n", states_cpu() - begin);
    fclose(thesis.table);
    if (!status && rename(part, path))
        status = error_failed("%s: %s", path, strerror(errno));
    return status;
}

static int is_made(const struct figure *figure, const char *folder)
{
    char path[1000];
    struct stat there;
    place(folder, figure, "", path);
    return stat(path, &there) == 0;
}

int main(int argc, char **argv)
{
    int found = 0, status = 0;
    if (argc != 3) {
        fprintf(stderr, "bench_thesis: give a figure, or all or list, and a folder: bench_thesis 3.14 OUT\n");
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "list") && mkdir(argv[2], 0777) && errno != EEXIST) {
        fprintf(stderr, "bench_thesis: %s: %s\n", argv[2], strerror(errno));
        return EXIT_FAILED;
    }
    for (int c = 0; c < CHAPTER_COUNT && !status; c++)
        for (const struct figure *figure = CHAPTERS[c]; figure->number && !status; figure++) {
            int all = !strcmp(argv[1], "all"), wanted = all || !strcmp(argv[1], figure->number);
            if (!strcmp(argv[1], "list"))
                printf("%-6s %s\n", figure->number, figure->what), found = 1;
            else if (wanted)
                status = all && is_made(figure, argv[2]) ? 0 : make(figure, argv[2]), found = 1;
        }
    if (!found) {
        fprintf(stderr, "bench_thesis: no figure %s: bench_thesis list . names them\n", argv[1]);
        return EXIT_USAGE;
    }
    if (status)
        fprintf(stderr, "bench_thesis: %s\n", error_message());
    return status ? EXIT_FAILED : EXIT_DONE;
}
