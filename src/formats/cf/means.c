/* formats/cf/means.c - variables that lie between the mass points of a model
 * (Arakawa's grid C) on these points: means of two neighbours. */
#include "formats/cf/model.h"
#include "volume/mask.h"

/* Makes a row of means of those around it: of two rows, four or one. */
static void make_row(const cf_model *model, const snow_volume *from, int64_t y,
                     int64_t z, int64_t width, double *row, double *out) {
    const int64_t *dims = from->info.dims;
    const int across = model->staggered[0];
    double share = 1.0 / (1 + across);
    for (int64_t x = 0; x < width; x++)
        out[x] = 0;
    for (int i = 1; i < 3; i++)
        share /= 1 + model->staggered[i];
    for (int k = 0; k <= model->staggered[2]; k++)
        for (int j = 0; j <= model->staggered[1]; j++) {
            snow_volume_stored(from, ((z + k) * dims[1] + y + j) * dims[0],
                               (size_t)dims[0], row);
            for (int64_t x = 0; x < width; x++)
                out[x] += share * (row[x] + (across ? row[x + 1] : 0));
        }
}

static snow_status make_means(const cf_model *model, const snow_volume *from,
                              snow_volume *to) {
    const int64_t *dims = to->info.dims;
    const size_t row_bytes = (size_t)dims[0] * snow_type_size(to->info.type);
    unsigned char *at = to->owned;
    double *rows = snow_allocate_array(
        to->context, 2 * (uint64_t)from->info.dims[0], sizeof *rows);
    if (!rows)
        return SNOW_STATUS_NO_MEMORY;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++, at += row_bytes) {
            double *out = rows + from->info.dims[0];
            make_row(model, from, y, z, dims[0], rows, out);
            snow_type_store(to->info.type, out, (size_t)dims[0], at);
        }
    snow_release(to->context, rows);
    return SNOW_STATUS_OK;
}

snow_status snow_model_means(void *user, const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    const cf_reading *r = user;
    snow_volume_options own = *options;
    snow_volume_info native = *info;
    snow_volume *from = NULL, *to = NULL;
    snow_region box;
    SNOW_TRY(snow_region_lay_out(r->context, options, info, &box));
    for (int i = 0; i < 3; i++) { /* one more along staggered axes */
        own.crop[i][0] = box.first[i];
        own.crop[i][1] = box.first[i] + box.count[i] + r->model->staggered[i];
        native.dims[i] += r->model->staggered[i];
    }
    SNOW_TRY(r->read(r->user, &own, &native, out ? &from : NULL));
    info->type = snow_masked_type(native.type);
    info->slope = native.slope;
    info->intercept = native.intercept;
    if (!out)
        return SNOW_STATUS_OK;
    snow_status status = snow_volume_new(r->context, info, &to);
    if (status == SNOW_STATUS_OK)
        status = make_means(r->model, from, to);
    snow_volume_close(from);
    return snow_volume_give(status, to, out);
}
