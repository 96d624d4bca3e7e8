/* Flags from profiles along rays. A camera that does not stand straight in front of a rod sees its flank beside the
 * face: a plateau darker than the face and brighter than the void, on one side. The rim then is that of the face, and
 * right; but forces from overlaps across a flank should be looked at. */
#include "findgrains/rims/rim_looks.h"

#include "findgrains/rims/edge_fit.h"
#include "findgrains/look/grey.h"

#include <math.h>

enum { RAYS = 96, DEPTHS = 3 };
#define FIRST 2.5        /* blurs outside the rim: where its own edge has ended */
#define PLATEAU 2.0      /* px that are averaged there */
#define WIDEST 0.25      /* of the radius: a flank is not wider */
#define FAINTEST 0.12    /* of the contrast, above the voids */
#define VOID_SPREADS 3.0 /* ... and of standard deviations of the voids: they may be lit unevenly themselves */
#define BRIGHTEST 0.75   /* of the contrast: brighter is another grain */
#define VOID_AGAIN 0.06  /* of the contrast: the flank has ended */
#define LEAST_SHARE 0.12 /* of the rays */
#define LEAST_SIDED 0.6  /* |mean of exp(i theta)| over the rays with a flank */
#define SATURATED 0.25

/* Along one ray: a plateau behind the rim, then the void, and nothing brighter between. */
static int ray_shows_flank(const struct photo *photo, const struct rim *rim, double c, double s,
                           const struct grey_levels *levels, double blur)
{
    double void_level = levels->void_level, contrast = levels->grain_level - void_level;
    double faintest = fmax(FAINTEST, VOID_SPREADS * levels->void_spread / contrast);
    double first = rim_radius_at(rim, c, s) + FIRST * blur, last = first + fmax(6, WIDEST * rim->radius), level = 0;
    if (rim->x + last * c < 0 || rim->x + last * c > photo->width - 1 || rim->y + last * s < 0 ||
        rim->y + last * s > photo->height - 1)
        return 0;
    int count = 0;
    for (double r = first; r < first + PLATEAU; r += 0.5, count++)
        level += (grey_at(photo, rim->x + r * c, rim->y + r * s) - void_level) / contrast;
    level /= count;
    if (level < faintest || level > BRIGHTEST)
        return 0;
    double before = level;
    for (double r = first + PLATEAU; r < last; r += 1) {
        double now = (grey_at(photo, rim->x + r * c, rim->y + r * s) - void_level) / contrast;
        if (0.5 * (now + before) < VOID_AGAIN)
            return 1;
        if (now > level + FAINTEST)
            return 0;
        before = now;
    }
    return 0;
}

int rim_shows_flank(const struct photo *photo, const struct rim *rim, const struct grey_levels *levels, double blur)
{
    double x = 0, y = 0, count = 0;
    for (int ray = 0; ray < RAYS; ray++) {
        double c = cos(2 * M_PI * ray / RAYS), s = sin(2 * M_PI * ray / RAYS);
        if (!ray_shows_flank(photo, rim, c, s, levels, blur))
            continue;
        x += c;
        y += s;
        count += 1;
    }
    return count >= LEAST_SHARE * RAYS && hypot(x, y) >= LEAST_SIDED * count;
}

/* The edge of a clipped grain is cut off at the top, and its half level seems to lie further out. Looked at two to four
 * blurs below the rim, where the grain has its own level. */
int rim_is_saturated(const struct photo *photo, const struct rim *rim, double blur)
{
    int end = photo->bits > 0 && photo->bits < 16 ? (1 << photo->bits) - 1 : 65535, full = 0, seen = 0;
    for (int ray = 0; ray < RAYS; ray++)
        for (int depth = 0; depth < DEPTHS; depth++) {
            double a = 2 * M_PI * ray / RAYS, r = rim->radius - (2 + depth) * blur;
            int x = (int)lround(rim->x + r * cos(a)), y = (int)lround(rim->y + r * sin(a));
            if (r < 0 || x < 0 || y < 0 || x >= photo->width || y >= photo->height)
                continue;
            seen++;
            full += photo_row(photo, y)[x] >= end;
        }
    return full > SATURATED * seen;
}
