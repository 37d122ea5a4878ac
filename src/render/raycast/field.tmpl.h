/* render/raycast/field.tmpl.h - native values of one scalar type as doubles.
 * Define before including:
 *
 *   FIELD_TYPE   C type of a voxel
 *   FIELD_NAME   name of the function
 *
 * Both are undefined at the end. */

static void FIELD_NAME(const snow_field *field, const int64_t first[3],
                       const int count[3], double *values) {
    const FIELD_TYPE *voxels =
        (const FIELD_TYPE *)field->volume->voxels + first[0] * field->steps[0] +
        first[1] * field->steps[1] + first[2] * field->steps[2];
    for (int z = 0; z < count[2]; z++)
        for (int y = 0; y < count[1]; y++) {
            const FIELD_TYPE *row =
                voxels + y * field->steps[1] + z * field->steps[2];
            for (int x = 0; x < count[0]; x++)
                *values++ = (double)row[x];
        }
}

#undef FIELD_TYPE
#undef FIELD_NAME
