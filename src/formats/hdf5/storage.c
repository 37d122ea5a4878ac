/* formats/hdf5/storage.c - whether the values of a data set can be read. */
#include "formats/hdf5/filters.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

/* Filters that are usual (the HDF Group's list of registered ones). */
static const char *filter_name(int filter) {
    static const struct {
        int filter;
        const char *name;
    } names[] = {{32001, " (Blosc)"},      {32004, " (LZ4)"},
                 {32008, " (Bitshuffle)"}, {32013, " (ZFP)"},
                 {32015, " (Zstandard)"},  {32026, " (Blosc2)"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].filter == filter)
            return names[i].name;
    return "";
}

/* Data in other files would be missing, or could be read from anywhere; data
 * with a filter that is not installed cannot be read. */
snow_status snow_hdf5_check_storage(snow_context *context, hid_t set) {
    hid_t plan = H5Dget_create_plist(set);
    if (plan < 0)
        return snow_hdf5_fail(context, "its storage is not described");
    bool elsewhere =
        H5Pget_layout(plan) == H5D_VIRTUAL || H5Pget_external_count(plan) > 0;
    hdf5_filters filters;
    int missing = 0;
    if (snow_hdf5_read_filters(plan, &filters))
        for (int i = 0; i < filters.count && !missing; i++) {
            const int id = filters.all[i].id;
            if (!snow_hdf5_undoes(id) && H5Zfilter_avail(id) <= 0)
                missing = id;
        }
    H5Pclose(plan);
    if (elsewhere)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its voxels are in other files; copy them into one "
                         "with h5repack");
    if (missing)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its voxels are compressed by filter %d%s, which libhdf5 lacks; "
            "install its plugin, or write them again with gzip by a program "
            "that has the filter, such as h5py",
            missing, filter_name(missing));
    return SNOW_STATUS_OK;
}

#endif
