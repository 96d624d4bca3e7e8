/* Links to the files of every state, where the page lies beside them. Elsewhere the bare name stands: a page that is
 * sent on must not tell the folders of the machine that made it. */
#include <ctype.h>
#include <string.h>

#include "report/page/page.h"

/* A file beside the page, as an address (RFC 3986): whatever its name, it is no scheme and leads nowhere else. */
static void put_address(struct html *html, const char *name)
{
    fputs("./", html->stream);
    for (; *name; name++)
        if (isascii((unsigned char)*name) && (isalnum((unsigned char)*name) || strchr("._-", *name)))
            fputc(*name, html->stream);
        else
            fprintf(html->stream, "%%%02X", (unsigned)(unsigned char)*name);
}

/* A dash for NULL. */
static void cell_link(const struct page *page, struct html *html, const char *path)
{
    const char *name = path ? basename(path) : NULL;
    size_t folder = path ? (size_t)(name - path) : 0;
    fputs("<td class=\"left\">", html->stream);
    if (!path) {
        fputs("–", html->stream);
    } else if (page->folder && strlen(page->folder) == folder && !strncmp(page->folder, path, folder)) {
        fputs("<a href=\"", html->stream);
        put_address(html, name);
        fputs("\">", html->stream);
        html_text(html, name);
        fputs("</a>", html->stream);
    } else {
        html_text(html, name);
    }
    fputs("</td>", html->stream);
}

void page_files(const struct page *page, const struct series *series, struct html *html)
{
    fprintf(
        html->stream,
        "<h2>Files</h2>\n<details><summary>%zu states: HDF5, which ParaView, Python, MATLAB and Julia open</summary>"
        "<div class=\"table\"><table><tr><th class=\"left\">state</th><th class=\"left\">grains</th>"
        "<th class=\"left\">tracks</th><th class=\"left\">contacts</th><th class=\"left\">forces</th></tr>\n",
        series->count);
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        fputs("<tr>", html->stream);
        html_cell(html, row->name);
        cell_link(page, html, row->grains.path);
        cell_link(page, html, row->tracks.path);
        cell_link(page, html, row->contacts_path);
        cell_link(page, html, row->packing.force_count ? row->packing.path : NULL);
        fputs("</tr>\n", html->stream);
    }
    fputs("</table></div></details>\n", html->stream);
}
