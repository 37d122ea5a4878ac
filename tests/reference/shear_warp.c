/* tests/reference/shear_warp.c - the sheared model: slices' samples on a
 * lattice, over, and one resampling (Lacroute and Levoy 1994; Keys 1981). */
#include "reference/shear_warp.h"

#include <math.h>

#include "classify/shading/normals.h"

/* The taps that a lattice pixel may have along one axis. */
#define TAPS_MOST 30

/* What counts as on a kernel's edge, in voxels. */
#define EDGE 1e-5

/* One axis of the lattice. */
typedef struct lattice_axis {
    int axis;       /* of the volume */
    int64_t voxels; /* along it */
    double width;   /* by how much the kernel is widened */
    double pitch;   /* voxels a pixel */
    double drift;   /* voxels that a ray moves from slice to slice */
    int64_t first;  /* pixel of the plane's first */
    int64_t count;
    double *weights; /* of one pixel and slice */
} lattice_axis;

/* One picture in the making. */
typedef struct sheared_job {
    const reference_scene *scene;
    const sheared_options *options;
    reference_camera camera;
    snow_kernel kernel;
    int support;
    bool draft, between;
    int axis;             /* of the slices; below 0: not chosen yet */
    int64_t first, count; /* slices of the slab */
    int64_t sheets;       /* with those between */
    lattice_axis u, v;
    double *samples; /* of the sheets: [sheet][v][u][4] */
    double *plane;   /* [v.count][u.count][4] */
} sheared_job;

/* A draft asks for no more than the tent of two voxels. */
static void choose_kernel(const snow_settings *settings, snow_kernel *kernel,
                          int *support) {
    snow_settings known = *settings;
    if (known.quality == SNOW_QUALITY_DRAFT && known.footprint == 0 &&
        known.kernel == SNOW_KERNEL_BSPLINE)
        known.kernel = SNOW_KERNEL_TENT;
    *kernel = known.kernel;
    *support = reference_support(&known);
}

/* --- geometry ------------------------------------------------------------- */

/* Where the ray through an image point meets the plane of slice 0. */
static double meet(const sheared_job *job, int axis, double x, double y) {
    reference_ray ray = reference_ray_at(job->scene, &job->camera, x, y);
    double t = -ray.start[job->axis] / ray.step[job->axis];
    return ray.start[axis] + t * ray.step[axis];
}

static void place_axis(sheared_job *job, int axis, lattice_axis *out) {
    reference_ray ray = reference_ray_at(job->scene, &job->camera, 0, 0);
    double here = meet(job, axis, 0, 0);
    double rho =
        hypot(meet(job, axis, 1, 0) - here, meet(job, axis, 0, 1) - here);
    out->axis = axis;
    out->voxels = job->scene->info.dims[axis];
    out->width = reference_widening(job->kernel, job->support, rho);
    double fine = job->options ? job->options->fine[axis] : 0;
    if (fine > 0) /* rho is 1 or more here */
        out->width = sqrt(fmax(1, fine * fine + out->width * out->width - 1));
    out->drift = ray.step[axis] / ray.step[job->axis];
    /* Two pixels a voxel for kernels that are hardly widened, one in two for
     * those that are far wider. */
    bool twice = !job->draft && out->width < 1.2;
    bool coarse = out->width >= (job->draft ? 2 : 2.5);
    out->pitch = twice ? 0.5 : coarse ? 2 : 1;
}

static void begin_job(sheared_job *job) {
    const snow_settings *settings = &job->scene->settings;
    reference_camera_of(job->scene, &job->camera);
    choose_kernel(settings, &job->kernel, &job->support);
    job->draft = settings->quality == SNOW_QUALITY_DRAFT;
    job->between = settings->quality == SNOW_QUALITY_HIGH;
    if (job->axis < 0)
        job->axis = reference_slice_axis(job->scene, &job->camera);
    place_axis(job, job->axis == 0 ? 1 : 0, &job->u);
    place_axis(job, job->axis == 2 ? 1 : 2, &job->v);
}

static bool axis_fits(const sheared_job *job, const lattice_axis *a) {
    double half = a->width * job->support / 2;
    if (job->kernel == SNOW_KERNEL_BOX || job->kernel == SNOW_KERNEL_GAUSS)
        half += 2 * EDGE; /* they jump at their ends */
    return 2 * ceil(half) <= TAPS_MOST;
}

static bool fits_along(const reference_scene *scene,
                       const sheared_options *options, int axis) {
    sheared_job job = {.scene = scene, .options = options, .axis = axis};
    begin_job(&job);
    return axis_fits(&job, &job.u) && axis_fits(&job, &job.v);
}

/* What share the pictures along the three axes have: the best axis' own, and in
 * high quality those of others whose turn is less than 5 degrees away, falling
 * off linearly, but for axes with too many voxels in reach.  Parts of a picture
 * come along one axis.  Returns the best axis. */
static int share_axes(const reference_scene *scene, int parts,
                      double shares[3]) {
    reference_camera camera;
    double inverse[3][3], cosine[3], sum = 0;
    reference_camera_of(scene, &camera);
    reference_inverse(scene->info.matrix, inverse);
    int best = reference_slice_axis(scene, &camera);
    bool blended = scene->settings.quality == SNOW_QUALITY_HIGH && parts < 2;
    for (int n = 0; n < 3; n++) {
        double *row = inverse[n], along = 0, square = 0;
        for (int c = 0; c < 3; c++) {
            along += row[c] * camera.back[c];
            square += row[c] * row[c];
        }
        cosine[n] = fabs(along) / sqrt(square);
    }
    for (int n = 0; n < 3; n++) {
        double away = (cosine[best] - cosine[n]) / sqrt(2);
        double share = 1 - away / sin(acos(-1.0) / 36);
        bool counts = blended && share > 0 && fits_along(scene, NULL, n);
        shares[n] = n == best ? 1 : counts ? share : 0;
        sum += shares[n];
    }
    for (int n = 0; n < 3; n++)
        shares[n] /= sum;
    return best;
}

bool sheared_fits(const reference_scene *scene,
                  const sheared_options *options) {
    return fits_along(scene, options, -1);
}

/* The pixels that the picture looks up, but for those without a voxel in
 * reach of any slice. */
static void bound_axis(const sheared_job *job, lattice_axis *a) {
    double low = INFINITY, high = -INFINITY;
    const snow_view *view = &job->scene->view;
    for (int corner = 0; corner < 4; corner++) {
        double at = meet(job, a->axis, corner & 1 ? view->width : 0,
                         corner & 2 ? view->height : 0);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    double last = (double)(job->scene->info.dims[job->axis] - 1);
    double shift = last * a->drift; /* slice k holds voxel i at i - k drift */
    double reach = a->width * job->support / 2 + 1;
    low = fmax(low - 4 * a->pitch, fmin(0, -shift) - reach);
    high = fmin(high + 4 * a->pitch,
                fmax(0, -shift) + (double)a->voxels - 1 + reach);
    a->first = (int64_t)floor(low / a->pitch);
    a->count = low <= high ? (int64_t)ceil(high / a->pitch) - a->first + 1 : 0;
}

/* --- samples -------------------------------------------------------------- */

/* Voxel (u, v) of a slice of the volume. */
static void index_of(const sheared_job *job, int64_t slice, int64_t u,
                     int64_t v, int64_t at[3]) {
    at[job->axis] = slice;
    at[job->u.axis] = u;
    at[job->v.axis] = v;
}

static double native_at(const sheared_job *job, const int64_t at[3]) {
    return reference_native(job->scene, at[0], at[1], at[2]);
}

/* The native value of a voxel of a sheet: those between two slices are means,
 * of whole numbers with halves rounded up. */
static double native_of_sheet(const sheared_job *job, int64_t sheet, int64_t u,
                              int64_t v) {
    int64_t at[3], slice = job->first + (job->between ? sheet / 2 : sheet);
    index_of(job, slice, u, v, at);
    double here = native_at(job, at);
    if (!job->between || sheet % 2 == 0)
        return here;
    at[job->axis]++;
    double mean = here / 2 + native_at(job, at) / 2;
    snow_type type = job->scene->info.type;
    return type == SNOW_TYPE_FLOAT32 || type == SNOW_TYPE_FLOAT64 ? mean
                                                                  : ceil(mean);
}

/* The slope along one axis: of both neighbours, or of the one that counts. */
static double slope_at(const sheared_job *job, const int64_t at[3], int axis) {
    int64_t low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
    low[axis]--;
    high[axis]++;
    double before = native_at(job, low), after = native_at(job, high);
    double here = native_at(job, at);
    if (isfinite(before) && isfinite(after))
        return (after - before) / 2;
    if (!isfinite(here))
        return 0;
    if (isfinite(after))
        return after - here;
    return isfinite(before) ? here - before : 0;
}

static void gradient_of_sheet(const sheared_job *job, int64_t sheet, int64_t u,
                              int64_t v, double gradient[3]) {
    int64_t at[3], slice = job->first + (job->between ? sheet / 2 : sheet);
    bool is_between = job->between && sheet % 2;
    index_of(job, slice, u, v, at);
    for (int n = 0; n < 3; n++)
        gradient[n] = slope_at(job, at, n);
    if (!is_between)
        return;
    at[job->axis]++;
    for (int n = 0; n < 3; n++)
        gradient[n] = (gradient[n] + slope_at(job, at, n)) / 2;
}

/* Replaces a gradient by one whose normal is the stored one of its own. */
static void quantise(const sheared_job *job, double gradient[3]) {
    double inverse[3][3], world[3], normal[3];
    const double(*matrix)[4] = job->scene->info.matrix;
    reference_inverse(matrix, inverse);
    double size = 0;
    for (int c = 0; c < 3; c++) {
        world[c] = inverse[0][c] * gradient[0] + inverse[1][c] * gradient[1] +
                   inverse[2][c] * gradient[2];
        size += fabs(world[c]);
    }
    if (!(size > 0))
        return;
    snow_normal_of(snow_normal_code(world), normal);
    for (int n = 0; n < 3; n++)
        gradient[n] = matrix[0][n] * normal[0] + matrix[1][n] * normal[1] +
                      matrix[2][n] * normal[2];
}

/* The control values of both kinds, rising, each once; returns how many. */
static size_t control_values(const reference_scene *scene, double *values) {
    size_t count = 0, color = 0, opacity = 0;
    double last = -INFINITY;
    while (color < scene->color_count || opacity < scene->opacity_count) {
        double a = color < scene->color_count ? scene->colors[color].value
                                              : (double)INFINITY;
        double b = opacity < scene->opacity_count
                       ? scene->opacities[opacity].value
                       : (double)INFINITY;
        double next = fmin(a, b);
        color += a <= b;
        opacity += b <= a;
        if (next > last)
            values[count++] = last = next;
    }
    return count;
}

/* What a data value of a wider type is stored as: the middle of one of equal
 * parts of the stretch that it lies in. */
static double coded(const reference_scene *scene, double value) {
    double stops[64];
    assert_true(scene->color_count + scene->opacity_count <= 64);
    size_t count = control_values(scene, stops), above = 0;
    while (above < count && stops[above] <= value)
        above++;
    if (above == 0 || above == count)
        return value; /* constant there */
    double parts = floor(65534.0 / (double)(count - 1));
    double a = stops[above - 1], b = stops[above];
    if (scene->log) {
        double steps = floor(log10(value / a) / log10(b / a) * parts);
        return a * pow(b / a, (fmin(steps, parts - 1) + 0.5) / parts);
    }
    double place = fmin(floor((value - a) / (b - a) * parts), parts - 1);
    return a + (b - a) * (place + 0.5) / parts;
}

static double path_exponent(const sheared_job *job) {
    const reference_scene *scene = job->scene;
    double length = scene->settings.opacity_length;
    if (length == 0)
        length = fmin(scene->info.spacing[0],
                      fmin(scene->info.spacing[1], scene->info.spacing[2]));
    double step = reference_slice_step(scene, &job->camera, job->axis,
                                       (const double[]){0, 0, 0});
    return step / length / (job->between ? 2 : 1);
}

static void make_sample(const sheared_job *job, double exponent, int64_t sheet,
                        int64_t u, int64_t v, double sample[4]) {
    const reference_scene *scene = job->scene;
    double value = scene->info.slope * native_of_sheet(job, sheet, u, v) +
                   scene->info.intercept;
    double rgba[4], gradient[3], threshold = scene->settings.threshold;
    gradient_of_sheet(job, sheet, u, v, gradient);
    double fade = reference_fade(scene, gradient);
    reference_classify(scene, value, rgba);
    rgba[3] *= fade;
    if (!(rgba[3] > 0) || (threshold > 0 && 255 * rgba[3] <= threshold + 1e-4))
        return;
    if (snow_type_size(scene->info.type) > 2 && !job->options->exact_values) {
        reference_classify(scene, coded(scene, value), rgba);
        rgba[3] *= fade;
    }
    if (scene->settings.shade == SNOW_SHADE_PHONG) {
        if (!job->options->exact_normals)
            quantise(job, gradient);
        reference_shade(scene, &job->camera, gradient, rgba);
    }
    sample[3] = 1 - pow(1 - rgba[3], exponent);
    for (int c = 0; c < 3; c++)
        sample[c] = rgba[c] * sample[3];
}

static void make_samples(sheared_job *job) {
    size_t count = (size_t)(job->sheets * job->u.voxels * job->v.voxels);
    job->samples = calloc(count * 4 + 1, sizeof(double));
    assert_non_null(job->samples);
    double exponent = path_exponent(job), *sample = job->samples;
    for (int64_t sheet = 0; sheet < job->sheets; sheet++)
        for (int64_t v = 0; v < job->v.voxels; v++)
            for (int64_t u = 0; u < job->u.voxels; u++, sample += 4)
                make_sample(job, exponent, sheet, u, v, sample);
}

/* --- the lattice ---------------------------------------------------------- */

/* Weights of the voxels along an axis for a lattice pixel and a slice, which
 * may lie between two. */
static void weigh(const sheared_job *job, lattice_axis *a, int64_t pixel,
                  double slice, int64_t *low, int64_t *high) {
    double at = (double)(a->first + pixel) * a->pitch + slice * a->drift;
    reference_weights(job->kernel, job->support, a->width, at, a->voxels,
                      a->weights, low, high);
}

/* Lays a row of pixels of one sheet behind the plane. */
static void lay_row(sheared_job *job, int64_t sheet, double slice, int64_t row,
                    double *filtered) {
    lattice_axis *u = &job->u, *v = &job->v;
    int64_t low, high;
    weigh(job, v, row, slice, &low, &high);
    if (low > high)
        return;
    memset(filtered, 0, (size_t)u->voxels * 4 * sizeof *filtered);
    for (int64_t j = low; j <= high; j++)
        for (int64_t n = 0; n < 4 * u->voxels; n++)
            filtered[n] +=
                v->weights[j] *
                job->samples[4 * (sheet * v->voxels + j) * u->voxels + n];
    for (int64_t x = 0; x < u->count; x++) {
        double *pixel = job->plane + 4 * (row * u->count + x), sum[4] = {0};
        weigh(job, u, x, slice, &low, &high);
        for (int64_t i = low; i <= high; i++)
            for (int c = 0; c < 4; c++)
                sum[c] += u->weights[i] * filtered[4 * i + c];
        double through = 1 - pixel[3];
        for (int c = 0; c < 4; c++)
            pixel[c] += through * sum[c];
    }
}

static void fill_plane(sheared_job *job) {
    lattice_axis *u = &job->u, *v = &job->v;
    job->plane = calloc((size_t)(u->count * v->count) * 4 + 1, sizeof(double));
    u->weights = calloc((size_t)u->voxels, sizeof(double));
    v->weights = calloc((size_t)v->voxels, sizeof(double));
    double *filtered = calloc((size_t)u->voxels * 4, sizeof *filtered);
    assert_true(job->plane && u->weights && v->weights && filtered);
    reference_ray ray = reference_ray_at(job->scene, &job->camera, 0, 0);
    bool rising = ray.step[job->axis] > 0;
    for (int64_t n = 0; n < job->sheets; n++) {
        int64_t sheet = rising ? n : job->sheets - 1 - n;
        double slice =
            (double)job->first + (double)sheet / (job->between ? 2 : 1);
        for (int64_t row = 0; row < v->count; row++)
            lay_row(job, sheet, slice, row, filtered);
    }
    free(u->weights);
    free(v->weights);
    free(filtered);
}

/* --- the picture ---------------------------------------------------------- */

/* Weights of the pixels -1, 0, 1 and 2 from the one below. */
static void resample_weights(bool bilinear, double f, double weights[4]) {
    for (int n = -1; n <= 2; n++) {
        double t = fabs(f - n), w;
        if (bilinear)
            w = fmax(0, 1 - t);
        else if (t < 1)
            w = 1 - 2.5 * t * t + 1.5 * t * t * t;
        else if (t < 2)
            w = 2 - 4 * t + 2.5 * t * t - 0.5 * t * t * t;
        else
            w = 0;
        weights[n + 1] = w;
    }
}

static void look_up(const sheared_job *job, double u, double v,
                    double pixel[4]) {
    double x = u / job->u.pitch, y = v / job->v.pitch, wx[4], wy[4];
    resample_weights(job->draft, x - floor(x), wx);
    resample_weights(job->draft, y - floor(y), wy);
    for (int m = 0; m < 4; m++)
        for (int n = 0; n < 4; n++) {
            double column = floor(x) - 1 + n - (double)job->u.first;
            double row = floor(y) - 1 + m - (double)job->v.first;
            if (column < 0 || row < 0 || column >= (double)job->u.count ||
                row >= (double)job->v.count)
                continue;
            const double *at = job->plane + 4 * ((int64_t)row * job->u.count +
                                                 (int64_t)column);
            for (int c = 0; c < 4; c++)
                pixel[c] += wx[n] * wy[m] * at[c];
        }
    for (int c = 3; c >= 0; c--)
        pixel[c] = fmax(0, fmin(pixel[c], c == 3 ? 1 : pixel[3]));
}

static void place_slab(sheared_job *job) {
    int64_t slices = job->scene->info.dims[job->axis];
    int parts = job->options->parts ? job->options->parts : 1;
    job->first = 0;
    for (int n = 0; n <= job->options->part; n++) {
        job->first += job->count;
        job->count = slices / parts + (n < slices % parts);
    }
    job->sheets = job->count;
    /* The sheet behind the slab's last slice is its own, but for the volume's.
     */
    if (job->between && job->count)
        job->sheets = 2 * job->count - (job->first + job->count == slices);
}

static void tell(const sheared_job *job, sheared_facts *facts) {
    const double pitch[2] = {job->u.pitch, job->v.pitch};
    for (int n = 0; n < 2; n++) {
        facts->phases[n] = pitch[n] < 1 ? 2 : 1;
        facts->stride[n] = pitch[n] > 1 ? 2 : 1;
    }
    for (int64_t n = 0; n < job->u.count * job->v.count; n++)
        facts->strongest = fmax(facts->strongest, job->plane[4 * n + 3]);
}

/* Adds the share of the picture along one axis. */
static void render_along(const reference_scene *scene,
                         const sheared_options *options, int axis, double share,
                         double *pixels, sheared_facts *facts) {
    sheared_job job = {.scene = scene, .options = options, .axis = axis};
    int width = scene->view.width, height = scene->view.height;
    begin_job(&job);
    place_slab(&job);
    bound_axis(&job, &job.u);
    bound_axis(&job, &job.v);
    make_samples(&job);
    fill_plane(&job);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, pixels += 4) {
            double pixel[4] = {0};
            look_up(&job, meet(&job, job.u.axis, x + 0.5, y + 0.5),
                    meet(&job, job.v.axis, x + 0.5, y + 0.5), pixel);
            for (int c = 0; c < 4; c++)
                pixels[c] += share * pixel[c];
        }
    tell(&job, facts);
    free(job.plane);
    free(job.samples);
}

double *sheared_render(const reference_scene *scene,
                       const sheared_options *options, sheared_facts *facts) {
    double shares[3];
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height;
    double *pixels = calloc(count * 4, sizeof(double));
    assert_non_null(pixels);
    *facts = (sheared_facts){0};
    facts->axis = share_axes(scene, options->parts, shares);
    for (int n = 0; n < 3; n++)
        if (shares[n] > 0) {
            render_along(scene, options, n, shares[n], pixels, facts);
            facts->axes++;
        }
    return pixels;
}
