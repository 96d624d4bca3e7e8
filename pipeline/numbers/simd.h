/* Loops that the compiler builds three times (AVX-512, AVX2, plain) and chooses between when the program starts. The
 * results are the same: each element is computed by the same operations. Not under sanitizers, which do not get along
 * with a choice that is made while the program is loaded; not with Clang. */
#ifndef PIPELINE_SIMD_H
#define PIPELINE_SIMD_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SIMD_CLONES
#endif

#endif
