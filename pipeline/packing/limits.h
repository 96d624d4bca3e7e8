/* Beyond these a result is worth a second look: what forces says when it ends and what the page warns of. They are
 * generous, as a warning is no verdict; each is some twice what good data reach (docs/forces_measured.md). */
#ifndef PIPELINE_LIMITS_H
#define PIPELINE_LIMITS_H

/* Squared errors over their variances, per datum: 1 where photos, loads and law agree. The scatter of some 1000 data is
 * 1 +- 0.05, so that 1.5 is no chance, yet leaves room for standard errors that are 20 % too small. */
#define LIMIT_MISFIT 1.5
/* Overlaps times kn over the loads, or the inverse: 1 where scale, stiffness and loads are right. It goes with the
 * square of a wrong scale: 1.4 is a scale that is 18 % wrong, or a stiffness that is not that of the rods. */
#define LIMIT_OVERLAPS_OVER_LOADS 1.4
/* Weber's stress over the applied one, less 1: thesis 4.3 finds 10 to 20 % in experiments. */
#define LIMIT_STRESS 0.10
/* Largest unbalanced force over <fn> of a method that seeks equilibrium. */
#define LIMIT_IMBALANCE 0.05
/* Share of the grains of a photo that are flagged as not to be trusted. */
#define LIMIT_FLAGGED 0.05
/* Least median ZNCC of a photo's grains with the reference. */
#define LIMIT_ZNCC 0.9

/* The loads on opposite walls differ by more than that share of their mean: a load is wrong or missing, or friction on
 * the base takes part of it. */
#define LIMIT_LOADS 0.02

/* Beyond these the forces are void (packing/verdict.h): loads that do not balance, a Weber stress that is not the
 * applied one, and the mean unbalanced force of a grain over <fn> (a few grains that miss a contact leave less). */
#define VOID_LOADS 0.1
#define VOID_STRESS 0.3
#define VOID_UNBALANCED 0.1

#endif
