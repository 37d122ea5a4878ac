/* machine.c - in the place of what a page has not: threads kept on processors,
 * signals, movies (of base/affinity.c, run/free_memory.c, run/interrupt.c),
 * methods other than shear-warp (of render/footprint/, render/raycast/), and
 * levels of refinement (of formats/amr/). */
#include "base/affinity.h"
#include "formats/amr/amr.h"
#include "formats/format.h"
#include "formats/vtk/vtk.h"
#include "render/picture.h"

#include "movie/movie_encoder.h"
#include "run/free_memory.h"
#include "run/interrupt.h"

/* What a page may take; the engine's limit is lower (engine.c). */
uint64_t free_memory(void) {
    return UINT64_MAX;
}

void snow_affinity_end(snow_affinity *affinity) {
    (void)affinity;
}

bool snow_affinity_begin(snow_affinity *affinity) {
    (void)affinity;
    return false;
}

bool snow_affinity_keep(const snow_affinity *affinity, pthread_t helper,
                        int nth) {
    (void)affinity;
    (void)helper;
    (void)nth;
    return false;
}

bool snow_affinity_release(const snow_affinity *affinity) {
    (void)affinity;
    return false;
}

bool interrupt_asked(void *unused) {
    (void)unused;
    return false;
}

void interrupt_mute(void) {
}

/* No output of a page is a movie. */
const movie_format *movie_format_of(const char *path) {
    (void)path;
    return NULL;
}

static snow_status refuse(snow_picture *picture, snow_job *job) {
    (void)job;
    return snow_fail(picture->frame->context, SNOW_STATUS_BAD_USAGE,
                     "a page without a server draws by shear-warp alone; use "
                     "snowglass serve for other methods and kernels");
}

const snow_render_method snow_method_footprint = {.encode = refuse};
const snow_render_method snow_method_groups = {.encode = refuse};
const snow_render_method snow_method_raycast = {.encode = refuse};

void snow_footprint_buffers_free(snow_footprint_buffers *exact) {
    (void)exact;
}

/* Before VTI, which takes all other XML of VTK. */
static bool is_vth(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "vtkOverlappingAMR") ||
           snow_vtk_probe_xml(bytes, size, "vtkHierarchicalBoxDataSet");
}

static bool is_no_level(const unsigned char *bytes, size_t size) {
    (void)bytes;
    (void)size;
    return false;
}

static snow_status refuse_levels(snow_source *source,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    (void)options;
    (void)info;
    (void)out;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "a page without a server reads no levels of refinement; "
                     "snowglass serve shows them, and snowglass export makes a "
                     "page of them");
}

/* Plotfiles are folders, which nothing here takes for one. */
snow_status snow_plotfile_header(snow_context *context, const char *path,
                                 char **out) {
    (void)context;
    (void)path;
    *out = NULL;
    return SNOW_STATUS_OK;
}

const snow_format snow_format_amrex = {
    .name = "amrex", .probe = is_no_level, .read = refuse_levels};
const snow_format snow_format_vth = {.name = "vth",
                                     .suffixes = {".vth", ".vthb"},
                                     .probe = is_vth,
                                     .read = refuse_levels};
