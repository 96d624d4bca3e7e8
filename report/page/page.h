/* report.html: one self-contained file about a series, warnings first. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "pipeline/draw/chart.h"
#include "report/page/html.h"
#include "report/states/state_series.h"

#define PAGE_MAPS 6

struct page {
    const char *name;         /* of the scene */
    const char *truth_folder; /* with NAME.truth.hdf and NAME.photo-truth.hdf; NULL: no truth */
    int maps;                 /* pictures at most, spread over the series */
    const char *folder;       /* where the page will lie, with a slash at its end; "": here; NULL: no links to files */
};

/* The whole page into `html`, which the caller began and will end. */
int page_write(const struct page *page, const struct series *series, struct html *html);

/* Parts of it. */
int page_warnings(const struct series *series, struct html *html);
void page_photos(const struct series *series, struct html *html);
void page_states(const struct series *series, struct html *html);
void page_stresses(const struct series *series, struct html *html);
void page_inputs(const struct series *series, struct html *html);
void page_files(const struct page *page, const struct series *series, struct html *html);
int page_quality(const struct series *series, struct html *html);
/* Of one state, inside an open block of charts. */
int page_balance(const struct series *series, const struct packing *packing, const struct packing_summary *summary,
                 struct html *html);
int page_chart(const struct chart *chart, struct html *html);
/* A line of a chart: the value below which 0 to 100 % of the trusted rows lie, times `unit`. values NULL: no line. */
int page_put_quantiles(struct chart *chart, const char *name, const double *values, const uint32_t *flags, size_t rows,
                       double unit);
int page_persistence(const struct series *series, struct html *html);
int page_last_state(const struct series *series, struct html *html);
int page_curves(const struct series *series, struct html *html);
int page_truth(const struct page *page, const struct series *series, struct html *html);
int page_pictures(const struct page *page, const struct series *series, struct html *html);

#endif
