/* The command's own parser sees argv from its name on; it calls itself by program_invocation_short_name, "report map",
 * in its help, its version and its messages. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/version.h"

int cli_command(const char *program, const char *what, const struct subcommand *commands, int argc, char **argv)
{
    const char *word = argc > 1 ? argv[1] : "";
    if (!strcmp(word, "--help")) {
        printf("Usage: %s COMMAND [OPTION...]\n%s\n\n", program, what);
        for (; commands->name; commands++)
            printf("  %-10s %s\n", commands->name, commands->what);
        printf("\n'%s COMMAND --help' teaches one command.\n", program);
        return EXIT_DONE;
    }
    if (!strcmp(word, "--version")) {
        printf("%s (film) %s\n", program, film_version);
        return EXIT_DONE;
    }
    for (; commands->name; commands++)
        if (!strcmp(word, commands->name)) {
            program_invocation_short_name = (char *)commands->full_name;
            return commands->run(argc - 1, argv + 1);
        }
    fprintf(stderr, "%s: %s '%s --help' lists the commands\n", program,
            argc > 1 ? "there is no such command:" : "which command?", program);
    return EXIT_USAGE;
}
