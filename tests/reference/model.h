/* tests/reference/model.h - the stage that the model's rules are tested on:
 * small asymmetric volumes of every type, and pictures of them by the library.
 */
#ifndef SNOW_TEST_MODEL_H
#define SNOW_TEST_MODEL_H

#include "reference/reference.h"
#include "render/tested.h"
#include "support/support.h"

/* Fails unless two numbers are finite and differ by no more than `bound`. */
#define assert_near(actual, expected, bound) \
    model_near(actual, expected, bound, #actual, __FILE__, __LINE__)
void model_near(double actual, double expected, double bound, const char *what,
                const char *file, int line);

/* One frame for all pictures of a test, so that what a picture leaves behind
 * in its buffers meets the next; and what model_check found. */
typedef struct model_stage {
    snow_context *context;
    snow_frame *frame;
    int pictures;
    double largest; /* difference of a picture and its reference */
    double opacity; /* strongest of each picture, summed up */
} model_stage;

model_stage model_open(void);

/* Frees the stage; the test fails when an object of it is still alive, or when
 * the pictures that were checked showed next to nothing. */
void model_close(model_stage *stage);

/* A test whose *state is a stage. */
#define MODEL_TEST(name) \
    cmocka_unit_test_setup_teardown(name, model_setup, model_teardown)
int model_setup(void **state);
int model_teardown(void **state);

/* How indices lie in the world. */
typedef enum model_matrix {
    MODEL_PLAIN,       /* identity */
    MODEL_ANISOTROPIC, /* 0.7 x 1.1 x 2 */
    MODEL_OBLIQUE,     /* turned about all axes, anisotropic, moved */
    MODEL_SHEARED,     /* columns not at right angles */
    MODEL_MIRRORED,    /* left-handed */
    MODEL_MATRICES
} model_matrix;

/* A scene of `dims` voxels: smooth structure with noise, data values about 0
 * to 100 whatever the native type, slope and intercept; view +z of 64x48
 * pixels, default settings, colours that differ (or greys), opacity a ramp
 * with a step and an empty part.  Free with model_free, which frees voxels. */
reference_scene model_scene(const int64_t dims[3], snow_type type, bool grey,
                            model_matrix matrix, uint64_t seed);

/* A scene of a phantom, whose voxels are the volume's, seen from +z: without
 * colours, opacities and a size of the picture. */
reference_scene model_phantom(snow_context *context, const char *name,
                              const int64_t dims[3], snow_volume **volume);

/* Gives a scene from model_scene a gradient opacity that takes away some of its
 * voxels, and with a step. */
void model_fade(reference_scene *scene);

/* A scene of float32 voxels that the caller fills; opacity 0 below data value
 * 0.5 and `opacity` from there, white. */
reference_scene model_blank(const int64_t dims[3], double opacity);
void model_free(reference_scene *scene);

/* The voxels of a scene from model_blank. */
float *model_voxels(const reference_scene *scene);

/* Points the camera of a scene. */
void model_look(reference_scene *scene, const double back[3],
                const double up[3]);
void model_turn(reference_scene *scene, double azimuth, double elevation,
                double roll, double zoom);

/* Points it from stand `n`, of straight and oblique ones in turn. */
#define MODEL_STANDS 15
void model_stand_at(reference_scene *scene, size_t n, double zoom);

/* Types and kernels in turn, and a number below `count`. */
#define MODEL_TYPES 10
#define MODEL_KERNELS 4
snow_type model_type(size_t n);
snow_kernel model_kernel(size_t n);
size_t model_draw(uint64_t *random, size_t count);

/* The scene's transfer function, and its volume over its voxels; the test fails
 * unless they can be made. */
snow_transfer *model_transfer(snow_context *context,
                              const reference_scene *scene);
snow_volume *model_volume(snow_context *context, const reference_scene *scene);

/* The scene by snow_frame_render; the test fails unless that succeeds. */
snow_image *model_image(const model_stage *stage, const reference_scene *scene);

/* A picture of another volume that the scene is of, say a part of its own. */
snow_image *model_image_of(const model_stage *stage,
                           const reference_scene *scene,
                           const snow_volume *volume);

/* That of its own as width * height * 4 floats RGBA; free with free(). */
float *model_picture(const model_stage *stage, const reference_scene *scene);

/* Four channels from an image's two or four; free with free(). */
float *model_spread(snow_image *image);

/* Renders the scene both ways and fails the test, with the scene in words,
 * unless the pictures differ by less than `bound`. */
void model_check(model_stage *stage, const reference_scene *scene,
                 double bound);

/* The scene by snow_frame_render, which must refuse it as bad usage, by a
 * message of one line with `words` in it. */
void model_refused(const model_stage *stage, const reference_scene *scene,
                   const char *words);

/* The scene's settings in words; lasts until the next call. */
const char *model_words(const reference_scene *scene);

#endif
