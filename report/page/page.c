/* The page from its parts, in the order in which a reader asks: is something wrong, is it right (where a truth is
 * known), what happened, how well was it seen, the numbers, the last state, the pictures, the files. Everything is
 * inside the file, charts as SVG and maps as PNG; a policy in its head forbids the browser to load anything else, so
 * that a page from somebody else is harmless. */
#include "report/page/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/scene.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "report/pictures/force_map.h"
#include "report/pictures/page_picture.h"

/* Readable on a phone and on paper, without a script or anything from elsewhere. */
static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data: 'self'; "
    "style-src 'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<style>\n"
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;max-width:72rem;margin:0 auto;padding:1rem}\n"
    "h1{font-size:1.6rem;margin-bottom:.2rem}h2{font-size:1.2rem;margin-top:2.2rem;border-bottom:1px solid #ccc}\n"
    ".table{overflow-x:auto;margin-bottom:1rem}table{border-collapse:collapse;font-size:.85rem}\n"
    "th,td{padding:.2rem .6rem;text-align:right;border-bottom:1px solid #e4e4e4;white-space:nowrap}\n"
    "th{vertical-align:bottom;background:#f6f6f4}th.left,td.left{text-align:left}\n"
    "summary{font-size:.85rem;color:#555;cursor:pointer}"
    ".warn{background:#fdf0e3;border-left:.4rem solid #d55e00;padding:.5rem 1rem}\n"
    ".void{background:#fbe9e7;border-left:.4rem solid #b00020;color:#7f0017;padding:.5rem 1rem}\n"
    ".good{background:#e9f5f0;border-left:.4rem solid #009e73;padding:.5rem 1rem}\n"
    ".off{color:#b34a00;font-weight:600}.small{font-size:.8rem;color:#555}\n"
    ".charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(26rem,100%),1fr));gap:1rem}\n"
    ".charts figcaption{display:none}.charts figure{margin:0}\n"
    "figure{margin:1rem 0;break-inside:avoid}img{max-width:100%;height:auto;border:1px solid #ddd}\n"
    "figcaption{font-size:.85rem;color:#555}code{font-size:.85em}\n"
    "@media print{body{max-width:none;font-size:11pt}.table{overflow:visible}"
    "h2{break-after:avoid}.charts{grid-template-columns:1fr 1fr}img{max-height:12cm}}\n"
    "</style>\n";

static int draw_into(struct canvas *canvas, const void *map)
{
    return force_map_draw(map, canvas);
}

static int draw_map(const struct packing *packing, const struct forces *forces, double mean_fn, const char *title,
                    struct html *html)
{
    struct force_map map = {.packing = packing, .forces = forces, .title = title, .width = 1000, .mean_fn = mean_fn};
    if (force_map_measure(&map))
        return -1;
    struct picture picture = {title, map.width, map.height, draw_into, &map};
    return picture_put(&picture, CANVAS_PNG, html);
}

/* The forces by the one method of the series, or by every method. */
static int draw_forces(const struct series *series, const struct series_row *row, const struct packing *packing,
                       int every_method, struct html *html)
{
    const struct forces *chosen;
    char title[200];
    int result = method_choose(packing, row->packing.path, series->method, &chosen);
    for (size_t f = 0; f < packing->force_count && result == 0; f++) {
        const struct forces *forces = &packing->forces[f];
        if (!every_method && forces != chosen)
            continue;
        snprintf(title, sizeof title, "%s: forces by %.15s", row->name, forces->method);
        result = draw_map(packing, forces, methods_mean_fn(&series->methods, series->method), title, html);
    }
    return result;
}

static int draw_state(const struct series *series, const struct series_row *row, int every_method, struct html *html)
{
    struct packing packing;
    char title[200];
    if (packing_read(row->packing.path, &packing))
        return -1;
    snprintf(title, sizeof title, "%s: contacts", row->name);
    int result = packing.force_count ? draw_forces(series, row, &packing, every_method, html)
                                     : draw_map(&packing, NULL, NAN, title, html);
    packing_free(&packing);
    return result;
}

/* Of `states` pictures at most `most`, evenly spread, the first and the last among them. */
static int is_chosen(size_t state, size_t states, size_t most)
{
    if (states <= most)
        return 1;
    if (most == 1)
        return state == states - 1;
    for (size_t k = 0; k < most; k++)
        if (k * (states - 1) / (most - 1) == state)
            return 1;
    return 0;
}

static void picture_note(const struct series *series, size_t drawn, size_t states, struct html *html)
{
    double mean_fn = methods_mean_fn(&series->methods, series->method);
    fputs("<h2>Force maps</h2>\n<p class=\"small\">", html->stream);
    html_format(html, "%zu of %zu states", drawn, states);
    if (series->method)
        html_format(html, " by %s, the last one by every method", series->method);
    html_format(html, "; draw others with report map.");
    if (mean_fn > 0)
        html_format(html, " Widths comparable between the maps: ⟨fn⟩ = %.4g N, the mean of the states, is the unit.",
                    mean_fn);
    fputs("</p>\n", html->stream);
}

int page_pictures(const struct page *page, const struct series *series, struct html *html)
{
    size_t states = 0, state = 0, most = page->maps < 0 ? 0 : (size_t)page->maps;
    for (size_t k = 0; k < series->count; k++)
        states += series->rows[k].packing.path != NULL;
    if (states == 0 || most == 0)
        return 0;
    picture_note(series, states < most ? states : most, states, html);
    for (size_t k = 0; k < series->count; k++) {
        if (!series->rows[k].packing.path)
            continue;
        int last = state == states - 1;
        if (is_chosen(state++, states, most) && draw_state(series, &series->rows[k], last, html))
            return -1;
    }
    return 0;
}

int page_write(const struct page *page, const struct series *series, struct html *html)
{
    fputs(head, html->stream);
    fputs("<title>", html->stream);
    html_text(html, page->scene->name);
    fputs("</title></head><body>\n<h1>", html->stream);
    html_text(html, page->scene->name);
    fputs("</h1>\n<p class=\"small\">", html->stream);
    html_format(html, "%zu states. Written by: %s.", series->count, series->versions);
    fputs("</p>\n", html->stream);
    if (page_warnings(page->scene, series, html))
        return -1;
    if (page->truth_folder && page_truth(page, series, html))
        return -1;
    if (page_curves(series, html))
        return -1;
    if (page_quality(series, html))
        return -1;
    page_photos(series, html);
    page_states(series, html);
    page_stresses(series, html);
    if (page_last_state(series, html) || page_pictures(page, series, html))
        return -1;
    page_files(page, series, html);
    page_inputs(series, html);
    fputs("</body></html>\n", html->stream);
    return 0;
}
