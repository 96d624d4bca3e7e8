/* report.html: one self-contained file about a series, warnings first. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "pipeline/draw/chart.h"
#include "report/page/html.h"
#include "report/states/state_series.h"

struct scene;
#define PAGE_MAPS 6

struct page {
    const struct scene *scene; /* its name, and the photos that it skips */
    const char *truth_folder;  /* with NAME.truth.hdf and NAME.photo-truth.hdf; NULL: no truth */
    int maps;                  /* pictures at most, spread over the series */
    const char *folder;        /* where the page will lie, with a slash at its end; "": here; NULL: no links to files */
};

/* The whole page into `html`, which the caller began and will end. 0, or -1 with a line: a file of the series or of the
 * truth cannot be read or does not fit, memory is gone; `html` is of no use then. Writing into html->stream does not
 * fail here: html_end() tells. */
int page_write(const struct page *page, const struct series *series, struct html *html);
/* Parts of the page, in its order. Each writes nothing where the series has nothing for it; those that return an int
 * return 0, or -1 like page_write().
 *
 * What is wrong or doubtful, first of all; a green line when nothing is. */
int page_warnings(const struct scene *scene, const struct series *series, struct html *html);
/* Virtual tests: circles, motions and forces against the truth in page->truth_folder, photo by photo and state by
 * state, and the errors of the last state's forces. */
int page_truth(const struct page *page, const struct series *series, struct html *html);
/* Stress against strain and the other curves through the series. */
int page_curves(const struct series *series, struct html *html);
/* Correlations of the forces with those of the state before (thesis Fig. 4.28), per method; part of the curves. */
int page_persistence(const struct series *series, struct html *html);
/* How well the photos were read: likeness and standard errors through the series, and over the grains of its last
 * photo. */
int page_quality(const struct series *series, struct html *html);
/* Tables: photos, states, stresses. */
void page_photos(const struct series *series, struct html *html);
void page_states(const struct series *series, struct html *html);
void page_stresses(const struct series *series, struct html *html);
/* The last state with contacts: distribution of normal forces, balance, directions. */
int page_last_state(const struct series *series, struct html *html);
/* Of one state, inside an open block of charts: what its forces leave unbalanced, and the stress that they make. */
int page_balance(const struct series *series, const struct packing *packing, const struct packing_summary *summary,
                 struct html *html);
/* Force maps of up to page->maps states, evenly spread with the first and the last; the last by every method. */
int page_pictures(const struct page *page, const struct series *series, struct html *html);
/* Links to the files where page->folder is theirs, and what was read to make them. */
void page_files(const struct page *page, const struct series *series, struct html *html);
void page_inputs(const struct series *series, struct html *html);
/* The chart as a picture (SVG); nothing when it has no finite point. */
int page_chart(const struct chart *chart, struct html *html);
/* A line of a chart: the value below which 0 to 100 % of the trusted rows lie, times `unit`. values NULL: no line.
 * flags NULL: every row is trusted. */
int page_put_quantiles(struct chart *chart, const char *name, const double *values, const uint32_t *flags, size_t rows,
                       double unit);

#endif
