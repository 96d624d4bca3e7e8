/* A state file with one thing wrong in its structure:
 *
 *     mutate_state IN OUT NUMBER       applies fault NUMBER (0, 1, 2 ...), prints what it is; status 2: there are no
 * more
 *
 * Every dataset of the file gets every fault in turn, then every attribute of the root group. */
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DATASETS = 512, NAME = 200 };
static char names[MOST_DATASETS][NAME];
static int count;

static herr_t note(hid_t file, const char *name, const H5O_info_t *info, void *data)
{
    (void)file, (void)data;
    if (info->type == H5O_TYPE_DATASET && count < MOST_DATASETS && strlen(name) < NAME)
        strcpy(names[count++], name);
    return 0;
}

/* A dataset of `type` and this shape in the place of the old one. Unwritten elements read as 0. */
static int replace(hid_t file, const char *name, hid_t type, int rank, const hsize_t *dims, hsize_t chunk)
{
    hid_t space = rank ? H5Screate_simple(rank, dims, NULL) : H5Screate(H5S_SCALAR);
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    if (chunk)
        H5Pset_chunk(properties, 1, &chunk);
    int failed = H5Ldelete(file, name, H5P_DEFAULT) < 0;
    hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    failed |= data < 0;
    H5Dclose(data), H5Pclose(properties), H5Sclose(space);
    return failed;
}

static int fill(hid_t file, const char *name, double value)
{
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(data);
    hssize_t rows = H5Sget_simple_extent_npoints(space);
    double *values = malloc((size_t)(rows + 1) * sizeof *values);
    for (hssize_t k = 0; k < rows; k++)
        values[k] = value;
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values); /* refused for texts: then no fault */
    free(values);
    H5Sclose(space), H5Dclose(data);
    return 0;
}

static hsize_t rows_of(hid_t file, const char *name)
{
    hsize_t dims[8] = {0};
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(data);
    H5Sget_simple_extent_dims(space, dims, NULL);
    H5Sclose(space), H5Dclose(data);
    return dims[0];
}

static hid_t type_of(hid_t file, const char *name)
{
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(data);
    H5Dclose(data);
    return type;
}

enum {
    TEXTS,
    FLOAT32,
    INT8,
    RANK_2,
    SCALAR,
    LONGER,
    SHORTER,
    EMPTY,
    HUGE_DATASET,
    ABSENT,
    CYCLIC_LINK,
    EXTERNAL_LINK,
    DANGLING_LINK,
    GROUP,
    NANS,
    LARGE,
    NEGATIVE,
    ZEROS,
    FAR,
    ONE_NAN,
    ONE_INFINITE,
    ONE_LARGE,
    ONE_SMALL,
    ONE_WIDE,
    TWO_APART,
    FAULTS
};
static const char *const faults[FAULTS] = {"of texts",
                                           "of float32",
                                           "of int8",
                                           "of rank 2",
                                           "a scalar",
                                           "one row more",
                                           "one row less",
                                           "empty",
                                           "2^40 rows",
                                           "absent",
                                           "a cyclic link",
                                           "an external link",
                                           "a dangling link",
                                           "a group",
                                           "NaN everywhere",
                                           "1e308 everywhere",
                                           "-1e9 throughout",
                                           "0 everywhere",
                                           "9e5 everywhere",
                                           "NaN in one row",
                                           "inf in one row",
                                           "1e300 in one row",
                                           "-1e300 in one row",
                                           "3e7 in one row",
                                           "1.5e308 and -1.5e308 in two rows"};

/* The others stay: one bad number among good ones is what a stranger's file looks like. */
static int fill_some(hid_t file, const char *name, int fault)
{
    static const double value[] = {0.0 / 0.0, 1 / 0.0, 1e300, -1e300, 3e7, 1.5e308};
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(data);
    hssize_t rows = H5Sget_simple_extent_npoints(space);
    double *values = calloc((size_t)(rows + 1), sizeof *values);
    if (H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0 && rows > 0) {
        values[rows / 2] = value[fault - ONE_NAN];
        if (fault == TWO_APART)
            values[0] = -value[fault - ONE_NAN];
        H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    }
    free(values);
    H5Sclose(space), H5Dclose(data);
    return 0;
}

/* Something else than a dataset in its place. */
static int replace_by_link(hid_t file, const char *name, int fault)
{
    char self[NAME + 1];
    snprintf(self, sizeof self, "/%s", name);
    if (H5Ldelete(file, name, H5P_DEFAULT) < 0)
        return 1;
    if (fault == CYCLIC_LINK)
        return H5Lcreate_soft(self, file, name, H5P_DEFAULT, H5P_DEFAULT) < 0;
    if (fault == EXTERNAL_LINK)
        return H5Lcreate_external("other.hdf", self, file, name, H5P_DEFAULT, H5P_DEFAULT) < 0;
    if (fault == DANGLING_LINK)
        return H5Lcreate_soft("/nowhere", file, name, H5P_DEFAULT, H5P_DEFAULT) < 0;
    if (fault == GROUP)
        return H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)) < 0;
    return 0; /* absent */
}

/* The same name with another type or shape. */
static int replace_by_dataset(hid_t file, const char *name, int fault)
{
    hsize_t rows = rows_of(file, name), dims[2] = {rows, 2}, chunk = 0;
    hid_t type = type_of(file, name), text = H5Tcopy(H5T_C_S1), other = type;
    int rank = fault == RANK_2 ? 2 : fault != SCALAR;
    H5Tset_size(text, 12);
    if (fault == TEXTS || fault == FLOAT32 || fault == INT8)
        other = fault == TEXTS ? text : fault == FLOAT32 ? H5T_IEEE_F32LE : H5T_STD_I8LE;
    if (fault == LONGER || fault == EMPTY)
        dims[0] = fault == EMPTY ? 0 : rows + 1;
    if (fault == SHORTER)
        dims[0] = rows ? rows - 1 : 3;
    if (fault == HUGE_DATASET)
        dims[0] = (hsize_t)1 << 40, chunk = 1 << 20;
    int failed = replace(file, name, other, rank, dims, chunk);
    H5Tclose(type), H5Tclose(text);
    return failed;
}

static int spoil(hid_t file, const char *name, int fault)
{
    if (fault >= ONE_NAN)
        return fill_some(file, name, fault);
    if (fault >= NANS)
        return fill(file, name, (const double[]){0.0 / 0.0, 1e308, -1e9, 0, 9e5}[fault - NANS]);
    return fault >= ABSENT ? replace_by_link(file, name, fault) : replace_by_dataset(file, name, fault);
}

/* Attributes of the root group: absent, a number, an empty text, a text of 100,000 letters. */
static int spoil_attribute(hid_t file, int attribute, int fault, char name[NAME])
{
    H5Aget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, (hsize_t)attribute, name, NAME, H5P_DEFAULT);
    int failed = H5Adelete(file, name) < 0;
    if (fault == 0)
        return failed;
    enum { LONG = 60000 }; /* an attribute of an old-format group holds at most 64 kB */
    char *words = calloc(LONG, 1);
    memset(words, 'a', fault == 3 ? LONG - 1 : 0);
    hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(fault == 1 ? H5T_IEEE_F64LE : H5T_C_S1);
    if (fault > 1)
        H5Tset_size(type, fault == 3 ? LONG : 1);
    hid_t made = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    failed |= made < 0 || H5Awrite(made, type, words) < 0;
    H5Aclose(made), H5Tclose(type), H5Sclose(space);
    free(words);
    return failed;
}

static int copy_file(const char *from, const char *to)
{
    char block[65536];
    size_t length;
    FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
    if (!in || !out)
        return -1;
    while ((length = fread(block, 1, sizeof block, in)) > 0)
        fwrite(block, 1, length, out);
    return fclose(in) | fclose(out);
}

int main(int argc, char **argv)
{
    static const char *const kinds[] = {"absent", "a number", "an empty text", "a long text"};
    if (argc != 4 || copy_file(argv[1], argv[2]))
        return fprintf(stderr, "mutate_state IN OUT NUMBER\n"), 1;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    int number = atoi(argv[3]), failed;
    hid_t file = H5Fopen(argv[2], H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, note, NULL);
    H5O_info_t root;
    H5Oget_info(file, &root);
    if (number < count * FAULTS) {
        failed = spoil(file, names[number / FAULTS], number % FAULTS);
        printf("%s %s\n", names[number / FAULTS], faults[number % FAULTS]);
    } else if ((number -= count * FAULTS) < 4 * (int)root.num_attrs) {
        char name[NAME];
        failed = spoil_attribute(file, number / 4, number % 4, name);
        printf("attribute %s %s\n", name, kinds[number % 4]);
    } else
        return H5Fclose(file), 2;
    return H5Fclose(file) < 0 || failed ? 1 : 0;
}
