/* classify/gradient.tmpl.h - central differences of native values in index
 * space, for one scalar type.  Define before including:
 *
 *   GRADIENT_TYPE  C type of a voxel
 *   GRADIENT_NAME  name of the function
 *
 * Both are undefined at the end.  Beside the border, and beside a value that
 * is not finite, the difference is one-sided; with neither neighbour it is 0.
 */

static void GRADIENT_NAME(const void *voxels, const int64_t dims[3],
                          const int64_t at[3], double gradient[3]) {
    const int64_t strides[3] = {1, dims[0], dims[0] * dims[1]};
    const GRADIENT_TYPE *here = (const GRADIENT_TYPE *)voxels + at[0] +
                                at[1] * strides[1] + at[2] * strides[2];
    for (int axis = 0; axis < 3; axis++) {
        double below = at[axis] > 0 ? (double)here[-strides[axis]] : NAN;
        double above =
            at[axis] + 1 < dims[axis] ? (double)here[strides[axis]] : NAN;
        gradient[axis] = difference((double)*here, below, above);
    }
}

#undef GRADIENT_TYPE
#undef GRADIENT_NAME
