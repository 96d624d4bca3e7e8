/* The axis of a chart: from values to px, with ticks at numbers that people count in. */
#ifndef DRAW_AXIS_H
#define DRAW_AXIS_H

struct axis {
    int log;
    double from, to, step; /* what its ends and ticks stand for: values, or their decadic logarithms when log */
    double begin, length;  /* px: where `from` lies, and from there to `to`; negative on an axis that runs up */
    int fine, first;       /* log, with ticks at ..., 1, 2, 5, 10, ...: the number of the first one, 0 is that of 1 */
};

/* Linear, from the last tick below `low` to the first one above `high`: up to 7 ticks at multiples of 1, 2 or 5 times a
 * power of ten, at whole numbers when `whole`. Values that differ by rounding alone get an axis of some length all the
 * same. */
struct axis axis_linear(double low, double high, double begin, double length, int whole);
/* Logarithmic, `low` and `high` being logarithms: ticks at decades; below two decades at 1, 2, 5 and so on, so that
 * there is always more than one. */
struct axis axis_log(double low, double high, double begin, double length);

/* The value on the axis, its logarithm when that is logarithmic; NaN where it has no place there. */
double axis_value(int log, double value);
/* px of such a number. */
double axis_place(const struct axis *axis, double value);
/* Is there a tick of that number, from 0 on? Then *value is where it lies on the axis, `text` its number in words. */
int axis_tick(const struct axis *axis, int number, double *value, char text[32]);

/* The largest of 1, 2, 5 times a power of ten that is not above the value > 0; the smallest that is not below it. */
double axis_round_down(double value);
double axis_round_up(double value);

#endif
