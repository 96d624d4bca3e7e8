/* metres = s pixels + e, e of one size for all lengths: s = sum(p m) / sum(p^2), variance sigma^2 / sum(p^2). sigma is
 * that of a length between two marks, 2^1/2 times that of a mark. */
#include "calibration/rods/scale.h"

#include "pipeline/speak/error.h"

int scale_estimate(const struct known_length *lengths, size_t count, double error_px, struct scale *scale)
{
    double square = 0, product = 0, misfit = 0;
    for (size_t k = 0; k < count; k++) {
        double pixels = vec_norm(vec_sub(lengths[k].b, lengths[k].a));
        if (!(pixels > 1 && lengths[k].metres > 0))
            return error_input("length %zu: %g px, %g m: give two marks apart and a length above 0", k + 1, pixels,
                               lengths[k].metres);
        square += pixels * pixels;
        product += pixels * lengths[k].metres;
    }
    scale->m_per_px = product / square;
    for (size_t k = 0; k < count; k++) {
        double pixels = vec_norm(vec_sub(lengths[k].b, lengths[k].a));
        misfit += pow(lengths[k].metres / scale->m_per_px - pixels, 2);
    }
    scale->scatter_px = count > 1 ? sqrt(misfit / (double)(count - 1)) : NAN;
    double error = sqrt(2) * error_px; /* of a length between two marks */
    if (scale->scatter_px > error)
        error = scale->scatter_px;
    scale->s_m_per_px = scale->m_per_px * error / sqrt(square);
    return 0;
}
