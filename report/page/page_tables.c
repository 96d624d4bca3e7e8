#include <math.h>
#include <string.h>

#include "report/page/page.h"

/* rad per degree. */
static const double DEGREE = 0.017453292519943295;

/* Rows; a table with more is folded when the page opens. */
enum { LONG_TABLE = 60 };

/* Long tables are folded. */
static void table_begin(struct html *html, const char *title, size_t rows, const char *headings)
{
    fprintf(html->stream,
            "<h2>%s</h2>\n<details%s><summary>%zu rows</summary><div class=\"table\"><table><tr>%s</tr>\n", title,
            rows > LONG_TABLE ? "" : " open", rows, headings);
}

/* Closes what table_begin() opened. */
static void table_end(struct html *html)
{
    fputs("</table></div></details>\n", html->stream);
}

/* "lost 2, cut 5"; the bits of one half. */
static void cell_flags(struct html *html, const size_t of_bit[32], int first, int last)
{
    int some = 0;
    fputs("<td class=\"left\">", html->stream);
    for (int bit = first; bit <= last; bit++)
        if (of_bit[bit]) {
            html_format(html, "%s%s %zu", some ? ", " : "", GRAIN_FLAG_NAMES[bit] ? GRAIN_FLAG_NAMES[bit] : "?",
                        of_bit[bit]);
            some = 1;
        }
    fputs(some ? "</td>" : "–</td>", html->stream);
}

/* One file of findgrains ("found") or of the tracker ("tracked"): how many rows carry which flag, the likeness to
 * the reference, and the median standard errors. Bits 0 to 15 and 16 to 31 have a column each, since only the former
 * say that a row is not to be trusted. */
static void photo_row(struct html *html, const struct series_row *row, const char *what,
                      const struct photo_summary *photo)
{
    fputs("<tr>", html->stream);
    html_cell(html, row->name);
    html_cell(html, what);
    html_number(html, row->time_s, 6);
    html_number(html, (double)photo->grains, 9);
    html_number(html, (double)photo->distrusted, 9);
    cell_flags(html, photo->flags, 0, 15);
    cell_flags(html, photo->flags, 16, 31);
    html_number(html, photo->zncc.middle, 5);
    html_number(html, photo->zncc.least, 5);
    html_number(html, photo->s_place.middle, 3);
    html_number(html, photo->s_angle.middle / DEGREE, 3);
    html_number(html, photo->s_size.middle, 3);
    fputs("</tr>\n", html->stream);
}

void page_photos(const struct series *series, struct html *html)
{
    size_t rows = 0;
    for (size_t k = 0; k < series->count; k++)
        rows += (series->rows[k].grains.path != NULL) + (series->rows[k].tracks.path != NULL);
    if (rows == 0)
        return;
    table_begin(html, "Photos", rows,
                "<th class=\"left\">photo</th><th class=\"left\">grains</th><th>time<br>s</th><th>rows</th>"
                "<th>flagged</th><th class=\"left\">do not trust</th><th class=\"left\">information</th>"
                "<th>ZNCC<br>median</th><th>ZNCC<br>least</th><th>s of place<br>px, median</th>"
                "<th>s of angle<br>deg, median</th><th>s of radius<br>px, median</th>");
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        if (row->grains.path)
            photo_row(html, row, "found", &row->grains);
        if (row->tracks.path)
            photo_row(html, row, "tracked", &row->tracks);
    }
    table_end(html);
}

void page_states(const struct series *series, struct html *html)
{
    size_t rows = 0;
    for (size_t k = 0; k < series->count; k++)
        rows += series->rows[k].packing.path != NULL;
    if (rows == 0)
        return;
    table_begin(html, "Packings", rows,
                "<th class=\"left\">state</th><th>ε<sub>xx</sub></th><th>ε<sub>yy</sub></th><th>grains</th>"
                "<th>contacts</th><th>with walls</th><th>candidates</th><th>rattlers</th><th>floating</th><th>z</th>"
                "<th>void<br>ratio</th><th class=\"left\">do not trust</th>");
    for (size_t k = 0; k < series->count; k++) {
        const struct packing_summary *packing = &series->rows[k].packing;
        if (!packing->path)
            continue;
        fputs("<tr>", html->stream);
        html_cell(html, series->rows[k].name);
        html_number(html, packing->strain[0], 4);
        html_number(html, packing->strain[1], 4);
        html_number(html, (double)packing->grains, 9);
        html_number(html, (double)packing->fabric.contacts, 9);
        html_number(html, (double)packing->fabric.wall_contacts, 9);
        html_number(html, (double)packing->candidates, 9);
        html_number(html, (double)packing->fabric.rattlers, 9);
        html_number(html, (double)packing->floating, 9);
        html_number(html, packing->fabric.z, 4);
        html_number(html, packing->fabric.void_ratio, 4);
        cell_flags(html, packing->flags, 0, 15);
        fputs("</tr>\n", html->stream);
    }
    table_end(html);
}

/* The stress that the forces of one method make, beside what is applied. In the plane the stress tensor is symmetric
 * when moments balance, so xy is the mean of xy and yx. Methods without iterations show a dash. */
static void stress_row(struct html *html, const struct series_row *row, const struct force_summary *forces)
{
    const struct packing_summary *packing = &row->packing;
    double unit = packing->in_pascal ? 1e-3 : 1;
    fputs("<tr>", html->stream);
    html_cell(html, row->name);
    html_cell(html, forces->method);
    html_cell(html, forces->start);
    html_number(html, unit * packing->applied[0][0], 5);
    html_number(html, unit * forces->weber[0][0], 5);
    html_number(html, unit * packing->applied[1][1], 5);
    html_number(html, unit * forces->weber[1][1], 5);
    html_number(html, unit * 0.5 * (forces->weber[0][1] + forces->weber[1][0]), 3);
    html_number(html, forces->mean_fn, 5);
    html_number(html, 100 * forces->slipping, 3);
    html_number(html, forces->imbalance, 2);
    html_number(html, (double)forces->iterations, 9);
    fputs(forces->iterations == 0 ? "<td>–</td>"
          : forces->converged     ? "<td>yes</td>"
                                  : "<td class=\"off\">no</td>",
          html->stream);
    fputs("</tr>\n", html->stream);
}

/* Headings of the table of forces, the stresses in `units`, a string literal. */
#define FORCE_HEADS(units)                                                                                             \
    "<th class=\"left\">state</th><th class=\"left\">method</th><th class=\"left\">start</th>"                         \
    "<th>applied xx<br>" units "</th><th>Weber xx<br>" units "</th><th>applied yy<br>" units                           \
    "</th><th>Weber yy<br>" units "</th><th>Weber xy<br>" units                                                        \
    "</th><th>⟨fn⟩<br>N</th><th>slipping<br>%</th><th>imbalance<br>⟨fn⟩</th><th>iterations</th><th>converged</th>"

void page_stresses(const struct series *series, struct html *html)
{
    size_t rows = 0;
    int pascal = 0;
    for (size_t k = 0; k < series->count; k++) {
        rows += series->rows[k].packing.force_count;
        pascal |= series->rows[k].packing.in_pascal;
    }
    if (rows == 0)
        return;
    table_begin(html, "Forces", rows, pascal ? FORCE_HEADS("kPa") : FORCE_HEADS("N/m"));
    for (size_t k = 0; k < series->count; k++)
        for (size_t f = 0; f < series->rows[k].packing.force_count; f++)
            stress_row(html, &series->rows[k], &series->rows[k].packing.forces[f]);
    table_end(html);
    fputs(
        "<p class=\"small\">Compression positive. Applied: from the loads on walls and grains. Weber: from the contact "
        "forces. Imbalance: the largest force that a grain does not balance, over the mean normal force.</p>\n",
        html->stream);
}

void page_inputs(const struct series *series, struct html *html)
{
    fputs("<h2>Inputs</h2>\n<details><summary>What each file was made from, with SHA-256</summary>\n"
          "<div class=\"table\"><table><tr><th class=\"left\">file</th><th class=\"left\">made from</th>"
          "<th class=\"left\">SHA-256</th></tr>\n",
          html->stream);
    for (size_t k = 0; k < series->input_count; k++) {
        fputs("<tr>", html->stream);
        html_cell(html, series->inputs[k].file);
        html_cell(html, series->inputs[k].name);
        fputs("<td class=\"left\"><code>", html->stream);
        html_text(html, series->inputs[k].sha256);
        fputs("</code></td></tr>\n", html->stream);
    }
    fputs("</table></div></details>\n", html->stream);
}
