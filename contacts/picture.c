#include "contacts/picture.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/error.h"

enum { WIDTH = 720, HEIGHT = 420, LEFT = 60, RIGHT = 700, TOP = 60, BOTTOM = 370 };

static double x_of(const struct overlap_histogram *histogram, double px)
{
    double whole = HISTOGRAM_BINS * histogram->width_px;
    return LEFT + (RIGHT - LEFT) * (px - histogram->low_px) / whole;
}

static double highest(const struct overlap_histogram *histogram)
{
    double most = 1;
    for (int b = 0; b < HISTOGRAM_BINS; b++)
        most = fmax(
            most, fmax(histogram->bearing[b] + histogram->idle[b], histogram->fit_bearing[b] + histogram->fit_idle[b]));
    return 1.05 * most;
}

static void bars(FILE *stream, const struct overlap_histogram *histogram, double scale)
{
    for (int b = 0; b < HISTOGRAM_BINS; b++) {
        double x = x_of(histogram, histogram->low_px + b * histogram->width_px);
        double width = (double)(RIGHT - LEFT) / HISTOGRAM_BINS, idle = scale * histogram->idle[b];
        double bearing = scale * histogram->bearing[b];
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#9ecae1\"/>\n", x,
                BOTTOM - bearing, width, bearing);
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#fdae6b\"/>\n", x,
                BOTTOM - bearing - idle, width, idle);
    }
}

static void curve(FILE *stream, const struct overlap_histogram *histogram, double scale)
{
    fputs("<polyline fill=\"none\" stroke=\"#222\" stroke-width=\"1.5\" points=\"", stream);
    for (int b = 0; b < HISTOGRAM_BINS; b++)
        fprintf(stream, "%.1f,%.1f ", x_of(histogram, histogram->low_px + (b + 0.5) * histogram->width_px),
                BOTTOM - scale * (histogram->fit_bearing[b] + histogram->fit_idle[b]));
    fputs("\"/>\n", stream);
}

static void axis(FILE *stream, const struct overlap_histogram *histogram, double most)
{
    double reach = -histogram->low_px, step = pow(10, floor(log10(reach)));
    step *= reach / step < 2 ? 0.5 : reach / step < 5 ? 1 : 2;
    fprintf(stream, "<path d=\"M%d %d H%d M%d %d V%d\" stroke=\"#222\" fill=\"none\"/>\n", LEFT, BOTTOM, RIGHT, LEFT,
            BOTTOM, TOP);
    for (double px = -floor(reach / step) * step; px <= reach; px += step)
        fprintf(stream, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.3g</text>\n", x_of(histogram, px),
                BOTTOM + 18, fabs(px) < 1e-9 * step ? 0 : px);
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">overlap, px (below zero: gaps)</text>\n",
            (LEFT + RIGHT) / 2, BOTTOM + 40);
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%.0f</text>\n", LEFT - 6, TOP + 10, most);
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">0</text>\n", LEFT - 6, BOTTOM);
    fprintf(stream, "<path d=\"M%.1f %d V%d\" stroke=\"#d62728\" stroke-dasharray=\"4 3\"/>\n", x_of(histogram, 0),
            BOTTOM, TOP);
}

static void words(FILE *stream, const struct contact_summary *summary)
{
    fprintf(
        stream,
        "<text x=\"%d\" y=\"22\">Pairs of grains per %.3g px: <tspan fill=\"#3182bd\">both can be squeezed</tspan>, "
        "<tspan fill=\"#e6550d\">one is free</tspan>, and the fitted density</text>\n",
        LEFT, summary->histogram.width_px);
    if (summary->undecided)
        fprintf(stream, "<text x=\"%d\" y=\"42\">radii as given: %s</text>\n", LEFT, summary->undecided);
    else if (summary->doubt)
        fprintf(stream, "<text x=\"%d\" y=\"42\">doubtful: %s</text>\n", LEFT, summary->doubt);
    else if (summary->s_radius_scale > 0)
        fprintf(stream, "<text x=\"%d\" y=\"42\">radii times %.6f &#177; %.6f, found here</text>\n", LEFT,
                summary->radius_scale, summary->s_radius_scale);
    else if (summary->s_radius_offset_px > 0)
        fprintf(stream, "<text x=\"%d\" y=\"42\">radii %+.4f &#177; %.4f px, found here</text>\n", LEFT,
                summary->radius_offset_px, summary->s_radius_offset_px);
    else
        fprintf(stream, "<text x=\"%d\" y=\"42\">radii times %.6g %+.4g px, as given</text>\n", LEFT,
                summary->radius_scale, summary->radius_offset_px);
}

int overlap_picture(const char *path, const struct contact_summary *summary)
{
    double most = highest(&summary->histogram), scale = (BOTTOM - TOP) / most;
    FILE *stream = fopen(path, "w");
    if (!stream)
        return error_failed("%s: %s: choose a place that can be written", path, strerror(errno));
    fprintf(stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family=\"sans-serif\" "
            "font-size=\"13\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            WIDTH, HEIGHT);
    if (summary->histogram.width_px > 0) {
        bars(stream, &summary->histogram, scale);
        curve(stream, &summary->histogram, scale);
        axis(stream, &summary->histogram, most);
    }
    words(stream, summary);
    fputs("</svg>\n", stream);
    int failed = ferror(stream);
    if (fclose(stream) || failed) {
        remove(path);
        return error_failed("%s: cannot be written: free some space", path);
    }
    return 0;
}
