/* Well-formed HDF5 that is wrong inside. The input is a list of changes to a whole packing (corpus/state/packing.hdf):
 * objects vanish, become links (soft, external, to themselves or a group above), get another type, rank, length, chunk
 * or filter, other values, other attributes. HDF5 itself writes the changed file, so that its checksums are right and
 * every change reaches the readers. */
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/state_reader.h"
#include "tests/fuzz/target.h"

enum { MOST_OBJECTS = 400, NAME = 200, MOST_CHANGES = 12 };

/* One change: eight bytes of the input. */
struct change {
    uint8_t what, object, a, b, value[4];
};

static char names[MOST_OBJECTS][NAME];
static int count;

static herr_t note(hid_t file, const char *name, const H5L_info_t *info, void *data)
{
    (void)file, (void)info, (void)data;
    if (count < MOST_OBJECTS && strlen(name) < NAME)
        strcpy(names[count++], name);
    return 0;
}

static hid_t some_type(uint8_t kind)
{
    hid_t type = kind % 4 == 3 ? H5Tcopy(H5T_C_S1) : -1;
    switch (kind % 12) {
    case 0:
        return H5Tcopy(H5T_IEEE_F64LE);
    case 1:
        return H5Tcopy(H5T_IEEE_F32BE);
    case 2:
        return H5Tcopy(H5T_STD_I64LE);
    case 3:
        H5Tset_size(type, 1 + kind);
        return type;
    case 4:
        return H5Tcopy(H5T_STD_U32LE);
    case 5:
        return H5Tcopy(H5T_STD_I8BE);
    case 6:
        return H5Tcopy(H5T_STD_REF_OBJ);
    case 7:
        H5Tset_size(type, H5T_VARIABLE);
        return type;
    case 8:
        return H5Tcreate(H5T_OPAQUE, 1 + kind / 12);
    case 9:
        return H5Tvlen_create(H5T_IEEE_F64LE);
    case 10:
        return H5Tarray_create2(H5T_IEEE_F64LE, 1, (const hsize_t[]){1 + kind / 12u});
    default:
        H5Tset_size(type, 60000);
        return type;
    }
}

static hid_t some_space(uint8_t kind, const uint8_t value[4])
{
    hsize_t dims[3] = {value[0], value[1], value[2]};
    if (kind & 4)
        dims[0] <<= value[3] % 48;
    if (kind % 4 == 0)
        return H5Screate(kind & 8 ? H5S_NULL : H5S_SCALAR);
    return H5Screate_simple(kind & 8 ? 1 : kind % 4, dims, NULL);
}

/* In at most 2^16 chunks: HDF5 walks over all of them when the next change takes the dataset away. */
static hid_t some_storage(uint8_t kind, int rank, hssize_t points)
{
    static const hsize_t chunks[4][3] = {{1, 1, 1}, {7, 7, 7}, {1 << 12, 1, 1}, {1 << 28, 2, 1}};
    hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    if (rank > 0 && kind & 1 && points >= 0 && (hsize_t)points / chunks[kind >> 6][0] < 1 << 16)
        H5Pset_chunk(storage, rank, chunks[kind >> 6]);
    if (kind & 2)
        H5Pset_deflate(storage, 1);
    if (kind & 4)
        H5Pset_fletcher32(storage);
    if (kind & 8)
        H5Pset_shuffle(storage);
    if ((kind & 17) == 16)
        H5Pset_external(storage, "/etc/hostname", 0, H5F_UNLIMITED);
    return storage;
}

/* A dataset that holds zeros, or nothing at all yet. */
static void put_dataset(hid_t file, const char *name, const struct change *change)
{
    hid_t type = some_type(change->a), space = some_space(change->b, change->value);
    hid_t storage =
        some_storage(change->value[3], H5Sget_simple_extent_ndims(space), H5Sget_simple_extent_npoints(space));
    hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, storage, H5P_DEFAULT);
    hssize_t points = H5Sget_simple_extent_npoints(space);
    int small = !(change->value[3] & 1) || change->value[3] >> 6 < 3; /* HDF5 writes whole chunks */
    if (data >= 0 && change->b & 16 && small && points > 0 && points < 4096 && H5Tis_variable_str(type) <= 0) {
        static char zeros[4096 * 64];
        if (H5Tget_size(type) <= 64 && H5Tget_class(type) != H5T_VLEN)
            H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros);
    }
    H5Dclose(data), H5Pclose(storage), H5Sclose(space), H5Tclose(type);
}

static void put_attribute(hid_t file, const char *name, const struct change *change)
{
    static const char zeros[65536];
    char attribute[NAME];
    hid_t object = H5Oopen(file, change->a & 128 ? "." : name, H5P_DEFAULT);
    H5O_info_t info;
    if (object < 0 || H5Oget_info(object, &info) < 0 || info.num_attrs == 0) {
        H5Oclose(object);
        return;
    }
    H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, change->b % info.num_attrs, attribute, NAME,
                       H5P_DEFAULT);
    H5Adelete(object, attribute);
    if (change->a & 64) {
        hid_t type = some_type(change->a & 63), space = some_space(change->value[3], change->value);
        hssize_t points = H5Sget_simple_extent_npoints(space);
        int small = points >= 0 && (size_t)points <= sizeof zeros / H5Tget_size(type); /* its bytes stand in the file */
        hid_t made = small ? H5Acreate2(object, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT) : -1;
        if (made >= 0 && points > 0 && H5Tget_class(type) != H5T_VLEN)
            H5Awrite(made, type, zeros);
        H5Aclose(made), H5Sclose(space), H5Tclose(type);
    }
    H5Oclose(object);
}

/* HDF5 writes whole chunks: one number into one of 2^28 rows takes minutes, which are this target's own. */
static int chunks_are_small(hid_t data)
{
    hid_t storage = H5Dget_create_plist(data);
    hsize_t chunk[3] = {1, 1, 1};
    int rank = storage >= 0 && H5Pget_layout(storage) == H5D_CHUNKED ? H5Pget_chunk(storage, 3, chunk) : 0;
    H5Pclose(storage);
    return rank >= 0 && rank <= 3 && chunk[0] <= 1 << 16;
}

/* One number of a column becomes another: small, huge, negative, not finite. */
static void put_number(hid_t file, const char *name, const struct change *change)
{
    static const double numbers[] = {0, -1, 1, 0.5, 1e-300, 1e308, -1e308, 0x1p31, 0x1p53, -0x1p63, 1e9, 3};
    double value = change->a & 128 ? 0.0 / 0.0 : numbers[change->a % 12];
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
    hid_t space = H5Dget_space(data), one = H5Screate(H5S_SCALAR);
    hssize_t points = H5Sget_simple_extent_npoints(space);
    if (data >= 0 && points > 0 && H5Sget_simple_extent_ndims(space) == 1 && chunks_are_small(data)) {
        hsize_t at = (change->b | (hsize_t)change->value[0] << 8) % (hsize_t)points;
        H5Sselect_elements(space, H5S_SELECT_SET, 1, &at);
        H5Dwrite(data, H5T_NATIVE_DOUBLE, one, space, H5P_DEFAULT, &value);
    }
    H5Sclose(one), H5Sclose(space), H5Dclose(data);
}

static void apply(hid_t file, const struct change *change)
{
    char name[NAME], other[NAME], root[NAME + 1];
    strcpy(name, names[change->object % count]);
    strcpy(other, names[change->b % count]);
    snprintf(root, sizeof root, "/%s", change->a & 1 ? other : name);
    int what = change->what % 9;
    if (what < 6)
        H5Ldelete(file, name, H5P_DEFAULT);
    switch (what) {
    case 0:
        return;
    case 1:
        H5Lcreate_soft(root, file, name, H5P_DEFAULT, H5P_DEFAULT);
        return;
    case 2:
        H5Lcreate_external("other.hdf", root, file, name, H5P_DEFAULT, H5P_DEFAULT);
        return;
    case 3:
        H5Lcreate_hard(file, change->a & 2 ? "." : other, file, name, H5P_DEFAULT, H5P_DEFAULT);
        return;
    case 4:
        H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        return;
    case 5:
        put_dataset(file, name, change);
        return;
    case 6:
        put_attribute(file, name, change);
        return;
    case 7:
        put_number(file, name, change);
        return;
    default:
        H5Lmove(file, name, file, other, H5P_DEFAULT, H5P_DEFAULT);
        return;
    }
}

static uint8_t *whole_packing(size_t *size)
{
    FILE *file = fopen(FILM_SOURCE_DIR "/tests/fuzz/corpus/state/packing.hdf", "rb");
    uint8_t *bytes = malloc(1 << 20);
    if (!file || !bytes || (*size = fread(bytes, 1, 1 << 20, file)) == 0)
        abort();
    fclose(file);
    return bytes;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t *whole, image[1 << 22];
    static size_t length;
    if (!whole)
        whole = whole_packing(&length);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(access, 1 << 16, 0);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    H5Pset_file_image(access, whole, length);
    hid_t file = H5Fopen("fuzz.hdf", H5F_ACC_RDWR, access);
    if (file < 0)
        abort();
    count = 0;
    H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, note, NULL);
    for (size_t k = 0; count > 0 && k < MOST_CHANGES && (k + 1) * sizeof(struct change) <= size; k++) {
        struct change change;
        memcpy(&change, data + k * sizeof change, sizeof change);
        apply(file, &change);
    }
    H5Fflush(file, H5F_SCOPE_LOCAL);
    ssize_t bytes = H5Fget_file_image(file, image, sizeof image);
    H5Fclose(file), H5Pclose(access);
    if (bytes > 0)
        read_state_file(fuzz_named_file(image, (size_t)bytes));
    return 0;
}
