#include "contacts/picture/network_picture.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

enum { WIDTH = 720, HEIGHT = 420, LEFT = 70, RIGHT = 700, TOP = 60, BOTTOM = 370 };

/* Colours that are told apart with any colour vision (Okabe and Ito 2008). */
#define SKY "#56b4e9"
#define ORANGE "#e69f00"
#define VERMILLION "#d55e00"

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
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"" SKY "\"/>\n", x,
                BOTTOM - bearing, width, bearing);
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"" ORANGE "\"/>\n", x,
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
    fprintf(stream,
            "<text x=\"20\" y=\"%d\" text-anchor=\"middle\" transform=\"rotate(-90 20 %d)\">pairs of grains per "
            "%.3g px</text>\n",
            (TOP + BOTTOM) / 2, (TOP + BOTTOM) / 2, histogram->width_px);
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%.0f</text>\n", LEFT - 6, TOP + 10, most);
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">0</text>\n", LEFT - 6, BOTTOM);
    fprintf(stream,
            "<path d=\"M%.1f %d V%d\" stroke-width=\"1.5\" stroke=\"" VERMILLION "\" stroke-dasharray=\"4 3\"/>\n",
            x_of(histogram, 0), BOTTOM, TOP);
}

static void words(FILE *stream, const struct contact_summary *summary)
{
    fprintf(
        stream,
        "<rect x=\"%d\" y=\"12\" width=\"12\" height=\"12\" fill=\"" SKY "\"/><text x=\"%d\" y=\"22\">both grains can "
        "be squeezed</text>\n<rect x=\"%d\" y=\"12\" width=\"12\" height=\"12\" fill=\"" ORANGE "\"/><text x=\"%d\" "
        "y=\"22\">one is free</text>\n<path d=\"M%d 18 h24\" stroke=\"#222\" stroke-width=\"1.5\"/><text x=\"%d\" "
        "y=\"22\">fitted density</text>\n",
        LEFT, LEFT + 18, LEFT + 230, LEFT + 248, LEFT + 350, LEFT + 380);
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

static int write_picture(FILE *stream, const struct contact_summary *summary)
{
    double most = highest(&summary->histogram), scale = (BOTTOM - TOP) / most;
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
    return ferror(stream) ? -1 : 0;
}

int overlap_picture_is_svg(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ".svg");
}

int overlap_picture(const char *path, const struct contact_summary *summary)
{
    struct new_file target = {0};
    if (!overlap_picture_is_svg(path))
        return error_input("%s: no picture of overlaps has this ending: name it .svg", path);
    if (new_file_begin(&target, path))
        return -1;
    FILE *stream = fopen(target.temporary, "w");
    int failed = !stream || write_picture(stream, summary);
    if (stream)
        failed |= fclose(stream) != 0;
    if (!failed)
        return new_file_commit(&target);
    error_set(EXIT_FAILED, "%s: cannot be written: %s: free some space", path, strerror(errno));
    new_file_discard(&target);
    return -1;
}
