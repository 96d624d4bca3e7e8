/* CPU time, memory and size of photos and state files.
 *
 *     build/bench/bench_files [--full] [--json FILE]
 *
 * --full: 10320 x 7752 px (80 Mpixel) instead of 2580 x 1938, and a state of 5,000,002 grains with 10^7 contacts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <tiffio.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/scene/photo.h"
#include "pipeline/numbers/random.h"

static FILE *json;

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void report(const char *what, double seconds, const char *path)
{
    struct rusage usage;
    struct stat status = {0};
    getrusage(RUSAGE_SELF, &usage);
    stat(path, &status);
    printf("%-40s %9.3f CPU s %9.1f MB on disk %9.0f MB peak memory\n", what, seconds, (double)status.st_size / 1e6,
           (double)usage.ru_maxrss / 1e3);
    if (json)
        fprintf(json, "{\"what\":\"%s\",\"cpu_s\":%.6g,\"file_bytes\":%lld,\"peak_bytes\":%ld}\n", what, seconds,
                (long long)status.st_size, usage.ru_maxrss * 1024);
}

static void stop(void)
{
    fprintf(stderr, "bench_files: %s\n", error_message());
    exit(1);
}

/* 12-bit steps in 16-bit words, 1 % noise on a slow gradient. */
static void fill(struct photo *photo)
{
    for (int y = 0; y < photo->height; y++)
        for (int x = 0; x < photo->width; x++) {
            double grey = 2000 + 500 * sin(0.01 * x) + 41 * random_normal(1, (uint64_t)y * 100000 + (uint64_t)x);
            photo->pixels[(size_t)y * (size_t)photo->width + (size_t)x] = (uint16_t)(16 * (int)grey);
        }
}

/* One plain strip, as cameras write it. */
static void write_plain(const char *path, const struct photo *photo)
{
    TIFF *tiff = TIFFOpen(path, "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, photo->width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, photo->height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, photo->height);
    TIFFWriteEncodedStrip(tiff, 0, photo->pixels, (tmsize_t)photo->width * photo->height * 2);
    TIFFClose(tiff);
}

static void read_back(const char *what, const char *path)
{
    struct photo photo;
    struct photo_request any = {0};
    double begin = cpu_seconds();
    if (photo_read(path, &any, &photo))
        stop();
    report(what, cpu_seconds() - begin, path);
    photo_free(&photo);
}

static void bench_photos(int width, int height)
{
    char plain[] = "/tmp/bench_plain.XXXXXX", packed[] = "/tmp/bench_packed.XXXXXX";
    struct photo photo;
    if (photo_alloc(&photo, width, height))
        stop();
    fill(&photo);
    close(mkstemp(plain));
    close(mkstemp(packed));
    write_plain(plain, &photo);
    double begin = cpu_seconds();
    if (photo_write(packed, &photo))
        stop();
    report("photo: write Deflate with predictor", cpu_seconds() - begin, packed);
    photo_free(&photo);
    read_back("photo: read one plain strip", plain);
    read_back("photo: read Deflate with predictor", packed);
    unlink(plain);
    unlink(packed);
}

static void make_packing(struct packing *packing, size_t grains)
{
    memset(packing, 0, sizeof *packing);
    packing->length_m = 0.06;
    packing->forces = calloc(1, sizeof *packing->forces);
    packing->force_count = 1;
    strcpy(packing->forces->method, "qsm");
    size_t contacts = 2 * (grains - 2);
    if (table_alloc(&GRAINS, &packing->grains, grains, NULL) ||
        table_alloc(&CONTACTS, &packing->contacts, contacts, NULL) ||
        table_alloc(&CONTACT_FORCES, &packing->forces->contact, contacts, NULL) ||
        table_alloc(&RESIDUALS, &packing->forces->residual, grains, NULL))
        stop();
    for (size_t k = 0; k < grains; k++) {
        packing->grains.x[k] = random_uniform(2, 2 * k);
        packing->grains.y[k] = random_uniform(2, 2 * k + 1);
        packing->grains.radius[k] = 0.01;
    }
    for (size_t c = 0; c < contacts; c++) {
        packing->contacts.i[c] = (int64_t)(c / 2);
        packing->contacts.j[c] = (int64_t)(c / 2 + 1 + c % 2);
        packing->contacts.nx[c] = 1;
        packing->contacts.ny[c] = packing->contacts.x[c] = packing->contacts.y[c] = 0;
        packing->forces->contact.fn[c] = packing->forces->contact.ft[c] = random_uniform(3, c);
    }
}

/* Every row came back as it was written. */
static void check_packing(const struct packing *packing, size_t grains)
{
    size_t wrong = packing->grains.count != grains || packing->contacts.count != 2 * (grains - 2);
    for (size_t k = 0; !wrong && k < grains; k++)
        wrong += packing->grains.x[k] != random_uniform(2, 2 * k);
    for (size_t c = 0; !wrong && c < packing->contacts.count; c++)
        wrong += packing->contacts.j[c] != (int64_t)(c / 2 + 1 + c % 2) ||
                 packing->forces->contact.fn[c] != random_uniform(3, c);
    if (wrong) {
        fprintf(stderr, "bench_files: the state of %zu grains did not come back as it was written\n", grains);
        exit(1);
    }
}

static void bench_states(size_t grains)
{
    char path[] = "/tmp/bench_state.XXXXXX", what[80];
    struct packing packing;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "bench";
    make_packing(&packing, grains);
    close(mkstemp(path));
    double begin = cpu_seconds();
    if (packing_write(path, &packing, &provenance))
        stop();
    snprintf(what, sizeof what, "state of %zu grains, all columns: write", grains);
    report(what, cpu_seconds() - begin, path);
    packing_free(&packing);
    begin = cpu_seconds();
    if (packing_read(path, &packing))
        stop();
    snprintf(what, sizeof what, "state of %zu grains, all columns: read", grains);
    report(what, cpu_seconds() - begin, path);
    check_packing(&packing, grains);
    packing_free(&packing);
    unlink(path);
}

int main(int argc, char **argv)
{
    int full = 0;
    for (int k = 1; k < argc; k++) {
        full |= !strcmp(argv[k], "--full");
        if (!strcmp(argv[k], "--json") && k + 1 < argc)
            json = fopen(argv[++k], "w");
    }
    bench_states(1850);
    bench_states(18500);
    if (full)
        bench_states(5000002);
    bench_photos(full ? 10320 : 2580, full ? 7752 : 1938);
    if (json)
        fclose(json);
    return 0;
}
