/* classify/shading/gradient.tmpl.h - central differences of native values in
 * index space, for one scalar type (volume/each_type.h): TYPED(gradient) of one
 * voxel, TYPED(row) of voxels inside of a row.  At the border, and beside a
 * value that is not finite, the difference is one-sided; without any neighbour
 * it is 0. */

static void TYPED(gradient)(const snow_volume *volume, const int64_t at[3],
                            double gradient[3]) {
    const int64_t *dims = volume->info.dims;
    int64_t strides[3];
    snow_volume_steps(volume, strides);
    const TYPE *here = (const TYPE *)volume->voxels + at[0] +
                       at[1] * strides[1] + at[2] * strides[2];
    for (int axis = 0; axis < 3; axis++) {
        double below = at[axis] > 0 ? (double)here[-strides[axis]] : NAN;
        double above =
            at[axis] + 1 < dims[axis] ? (double)here[strides[axis]] : NAN;
        gradient[axis] = difference((double)*here, below, above);
    }
}

/* For voxels that have neighbours on all sides. */
static void TYPED(row)(const snow_gradient_row *row, const uint32_t *columns,
                       size_t count, size_t capacity, double *gradients) {
    int64_t strides[3];
    snow_volume_steps(row->volume, strides);
    int64_t at[3] = {row->at[0], row->at[1], row->at[2]};
    at[row->axis] = 0;
    const TYPE *first = (const TYPE *)row->volume->voxels + at[0] +
                        at[1] * strides[1] + at[2] * strides[2];
    const int64_t step = strides[row->axis];
    for (size_t n = 0; n < count; n++) {
        const TYPE *here = first + columns[n] * step;
        double x = ((double)here[1] - (double)here[-1]) / 2;
        double y = ((double)here[strides[1]] - (double)here[-strides[1]]) / 2;
        double z = ((double)here[strides[2]] - (double)here[-strides[2]]) / 2;
        gradients[n] = x;
        gradients[capacity + n] = y;
        gradients[2 * capacity + n] = z;
        if (isfinite(x + y + z)) /* always true for integers */
            continue;
        double careful[3];
        at[row->axis] = columns[n];
        TYPED(gradient)(row->volume, at, careful);
        for (size_t i = 0; i < 3; i++)
            gradients[i * capacity + n] = careful[i];
    }
}

#undef TYPE
#undef TYPED
#undef LOWEST
