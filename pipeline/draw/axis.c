/* Ticks of an axis. A length of the axis is parted into six or fewer steps s = 1, 2 or 5 times a power of ten, the
 * least that is not below a sixth of it, and its ends move outwards to multiples of s: from s floor(low / s) to s
 * ceil(high / s). The 1e-9 in floor, ceil and comparisons is more than the rounding of such quotients (some 1e-15) and
 * less than can be seen: a value that is a tick but for rounding does not get a step more. */
#include "pipeline/draw/axis.h"

#include <math.h>
#include <stdio.h>

/* Of an axis, over its largest value: what differs by less is alike but for rounding, and so small steps would not move
 * a number of that size. */
static const double LEAST_SPAN = 1e-9;

/* value = digit 10^k with digit in [1, 10). */
double axis_round_down(double value)
{
    double power = pow(10, floor(log10(value))), digit = value / power;
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

/* Above 1 follows 2 (twice), above 2 follows 5 (2.5 times), above 5 follows 10 (twice). */
double axis_round_up(double value)
{
    double below = axis_round_down(value), first = below / pow(10, floor(log10(below) + 1e-9));
    return below >= value * (1 - 1e-9) ? below : first > 1.5 && first < 3 ? 2.5 * below : 2 * below;
}

/* An axis with even steps, of `least_step` at least: 1 keeps ticks at whole numbers, and at decades of a logarithmic
 * one. Values all alike get a tenth of their size to both sides. */
static struct axis stepped(double low, double high, double begin, double length, double least_step)
{
    if (!(high - low > LEAST_SPAN * fmax(fabs(low), fabs(high)))) {
        double room = fmax(fabs(low) * 0.1, 1e-12);
        low -= room;
        high += room;
    }
    struct axis axis = {.begin = begin, .length = length};
    axis.step = fmax(axis_round_up((high - low) / 6), least_step);
    axis.from = axis.step * floor(low / axis.step + 1e-9);
    axis.to = axis.step * ceil(high / axis.step - 1e-9);
    return axis;
}

struct axis axis_linear(double low, double high, double begin, double length, int whole)
{
    return stepped(low, high, begin, length, whole ? 1 : 0);
}

/* The logarithms of ..., 1, 2, 5, 10, 20, ...: 0 is that of 1. */
static double fine_tick(int number)
{
    static const double digits[] = {1, 2, 5};
    int decade = (int)floor(number / 3.0);
    return decade + log10(digits[number - 3 * decade]);
}

struct axis axis_log(double low, double high, double begin, double length)
{
    if (high - low >= 2) {
        struct axis decades = stepped(low, high, begin, length, 1);
        decades.log = 1;
        return decades;
    }
    struct axis axis = {.log = 1, .begin = begin, .length = length, .fine = 1};
    axis.first = 3 * (int)floor(low);
    while (fine_tick(axis.first + 1) <= low + 1e-9)
        axis.first++;
    int last = axis.first + 1;
    while (fine_tick(last) < high - 1e-9)
        last++;
    axis.from = fine_tick(axis.first);
    axis.to = fine_tick(last);
    return axis;
}

double axis_value(int log, double value)
{
    if (!isfinite(value) || (log && value <= 0))
        return NAN;
    return log ? log10(value) : value;
}

double axis_place(const struct axis *axis, double value)
{
    return axis->begin + axis->length * (value - axis->from) / (axis->to - axis->from);
}

int axis_tick(const struct axis *axis, int number, double *value, char text[32])
{
    double v = axis->fine ? fine_tick(axis->first + number) : axis->from + number * axis->step;
    *value = !axis->fine && fabs(v) < 1e-9 * axis->step ? 0 : v;
    if (axis->log)
        snprintf(text, 32, "%g", pow(10, *value));
    else
        snprintf(text, 32, "%.7g", fabs(*value) < 1e-12 ? 0 : *value);
    return v <= axis->to + (axis->fine ? 1e-9 : 0.01 * axis->step);
}
