/* catalyst/adaptor.c - a Catalyst 2 implementation: simulations that call
 * Catalyst get pictures of this library without being compiled anew.
 *
 * It follows the conventions of ParaView's Catalyst (its "Blueprint"):
 *
 *   initialize  catalyst/mpi_comm           a communicator's Fortran handle
 *               catalyst/scripts/...        texts, or objects with `filename`;
 *                                           the one that ends in .json is the
 *                                           recipe, others are left alone
 *   execute     catalyst/state/{timestep,cycle,time}
 *               catalyst/channels/C/{type,data}
 *
 * The recipe's "input" names what is shown, as "CHANNEL/FIELD"; without it the
 * first field of the first channel is.  SNOWGLASS_RECIPE in the environment
 * names a recipe too, and counts more.  With SNOWGLASS_VERBOSE a line of
 * figures is written for each step.
 *
 * What cannot be shown is told in one line on the first rank, and left out: the
 * simulation goes on.  Catalyst has no place for an object of ours, hence the
 * one global record. */
#include "mesh.h"

#include <catalyst_impl_snowglass.h>
#include <snowglass/extend.h>
#include <snowglass/recipe.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef SNOW_CATALYST_MPI
#include <snowglass/mpi.h>
#endif

#define NAME_BYTES 256

static struct adaptor {
    snow_context *context;
    snow_comm *comm;
    snow_insitu *insitu;
    char channel[NAME_BYTES], field[NAME_BYTES]; /* "": the first */
    mesh_brick *bricks;
    snow_world_brick *places;
    int room;
} adaptor;

/* One line, on the first rank. */
static void say(const char *text) {
    if (!adaptor.comm || snow_comm_rank(adaptor.comm) == 0)
        fprintf(stderr, "snowglass: %s\n", text);
}

/* What is wrong with a recipe is wrong at each step. */
static void say_once(const char *text) {
    static char said[512];
    if (strcmp(said, text) != 0)
        say(text);
    snprintf(said, sizeof said, "%s", text);
}

static void print_warning(void *user, const char *text) {
    (void)user;
    say(text);
}

/* --- initialize ----------------------------------------------------------- */

static snow_status open_comm(const conduit_node *params) {
#ifdef SNOW_CATALYST_MPI
    int running = 0;
    MPI_Initialized(&running);
    double handle = mesh_number(params, "catalyst/mpi_comm", 0);
    if (conduit_node_has_path((conduit_node *)params, "catalyst/mpi_comm"))
        return snow_comm_new_mpi_fortran(adaptor.context, (MPI_Fint)handle,
                                         &adaptor.comm);
    if (running)
        return snow_comm_new_mpi(adaptor.context, MPI_COMM_WORLD,
                                 &adaptor.comm);
#else
    (void)params;
#endif
    return snow_comm_new_self(adaptor.context, &adaptor.comm);
}

static bool is_recipe(const char *path) {
    size_t length = path ? strlen(path) : 0;
    return length > 5 && strcmp(path + length - 5, ".json") == 0;
}

/* The recipe's path, NULL where there is none. */
static const char *find_recipe(const conduit_node *params) {
    const char *path = getenv("SNOWGLASS_RECIPE");
    conduit_node *node = (conduit_node *)params;
    if (path && *path)
        return path;
    if (!conduit_node_has_path(node, "catalyst/scripts"))
        return NULL;
    conduit_node *scripts = conduit_node_fetch(node, "catalyst/scripts");
    for (int64_t i = 0; i < conduit_node_number_of_children(scripts); i++) {
        conduit_node *script = conduit_node_child(scripts, i);
        if (conduit_datatype_is_char8_str(conduit_node_dtype(script)))
            path = conduit_node_as_char8_str(script);
        else
            path = mesh_text(script, "filename");
        if (is_recipe(path))
            return path;
    }
    return NULL;
}

/* "CHANNEL/FIELD", or a field alone. */
static void take_input(const char *input) {
    const char *slash = strchr(input, '/');
    const char *field = slash ? slash + 1 : input;
    snprintf(adaptor.channel, NAME_BYTES, "%.*s", (int)(field - input), input);
    if (slash)
        adaptor.channel[slash - input < NAME_BYTES ? slash - input : 0] = 0;
    snprintf(adaptor.field, NAME_BYTES, "%s", field);
}

/* Collective.  The first rank's path counts: others may lack its variables. */
static snow_status take_recipe(const char *path) {
    char first[4096] = "";
    snow_recipe recipe = {.size = sizeof recipe};
    const snow_insitu_settings usual = {.size = sizeof usual,
                                        .output = "snowglass_%06d.png"};
    snow_insitu_set(adaptor.insitu, &usual);
    if (path)
        snprintf(first, sizeof first, "%s", path);
    snow_status status =
        snow_comm_broadcast(adaptor.comm, first, sizeof first, 0);
    if (status != SNOW_STATUS_OK || !*first)
        return status;
    status = snow_recipe_apply_file(adaptor.insitu, first);
    if (status == SNOW_STATUS_OK)
        status = snow_recipe_load(adaptor.context, first, &recipe);
    if (status == SNOW_STATUS_OK && recipe.input)
        take_input(recipe.input);
    snow_recipe_clear(&recipe);
    return status;
}

static void close_all(void) {
    snow_insitu_free(adaptor.insitu);
    snow_comm_free(adaptor.comm);
    snow_context_free(adaptor.context);
    free(adaptor.bricks);
    free(adaptor.places);
    adaptor = (struct adaptor){0};
}

enum catalyst_status catalyst_initialize_snowglass(const conduit_node *params) {
    close_all();
    snow_status status = snow_context_new(NULL, &adaptor.context);
    if (status == SNOW_STATUS_OK)
        status = open_comm(params);
    if (status == SNOW_STATUS_OK)
        status = snow_insitu_new(adaptor.comm, &adaptor.insitu);
    if (status != SNOW_STATUS_OK) {
        say(adaptor.context ? snow_context_message(adaptor.context)
                            : snow_status_description(status));
        close_all();
        return catalyst_status_ok; /* no pictures, but a simulation */
    }
    snow_insitu_set_warning(adaptor.insitu, print_warning, NULL);
    /* Told to all ranks by the first step, with the message. */
    snow_insitu_set_recipe_status(adaptor.insitu,
                                  take_recipe(find_recipe(params)));
    return catalyst_status_ok;
}

/* --- execute -------------------------------------------------------------- */

static snow_status fail(const char *text, const char *what) {
    return snow_context_fail(adaptor.context, SNOW_STATUS_BAD_INPUT,
                             "channel '%s' %s", what, text);
}

/* The channel that is shown; NULL where there is none, as on a rank without
 * data. */
static conduit_node *find_channel(const conduit_node *params) {
    char path[NAME_BYTES + 20];
    conduit_node *node = (conduit_node *)params;
    if (!conduit_node_has_path(node, "catalyst/channels"))
        return NULL;
    conduit_node *channels = conduit_node_fetch(node, "catalyst/channels");
    if (!*adaptor.channel)
        return conduit_node_number_of_children(channels) > 0
                   ? conduit_node_child(channels, 0)
                   : NULL;
    snprintf(path, sizeof path, "catalyst/channels/%s", adaptor.channel);
    return conduit_node_has_path(node, path) ? conduit_node_fetch(node, path)
                                             : NULL;
}

static snow_status reserve(int count) {
    if (count <= adaptor.room)
        return SNOW_STATUS_OK;
    free(adaptor.bricks);
    free(adaptor.places);
    adaptor.room = 0;
    adaptor.bricks = calloc((size_t)count, sizeof *adaptor.bricks);
    adaptor.places = calloc((size_t)count, sizeof *adaptor.places);
    if (!adaptor.bricks || !adaptor.places)
        return snow_context_fail(adaptor.context, SNOW_STATUS_NO_MEMORY,
                                 "no memory for %d domains", count);
    adaptor.room = count;
    return SNOW_STATUS_OK;
}

/* Domains of a channel: one where its data are a mesh, else each child. */
static snow_status read_domains(conduit_node *channel, int *count,
                                double spacing[3]) {
    const char *type = mesh_text(channel, "type");
    bool several = type && strcmp(type, "multimesh") == 0;
    if (!conduit_node_has_path(channel, "data") || !type ||
        (!several && strcmp(type, "mesh") != 0))
        return fail("is no mesh; only mesh and multimesh are shown",
                    adaptor.channel);
    conduit_node *data = conduit_node_fetch(channel, "data");
    several = several || !conduit_node_has_path(data, "coordsets");
    int domains = several ? (int)conduit_node_number_of_children(data) : 1;
    snow_status status = reserve(domains);
    if (status != SNOW_STATUS_OK)
        return status;
    for (int n = 0; n < domains; n++) {
        char wrong[MESH_WRONG];
        conduit_node *domain = several ? conduit_node_child(data, n) : data;
        if (!mesh_read(domain, adaptor.field, &adaptor.bricks[n], spacing,
                       wrong))
            return fail(wrong, adaptor.channel);
        adaptor.places[n] = adaptor.bricks[n].place;
    }
    *count = domains;
    return SNOW_STATUS_OK;
}

/* The number of the step: ParaView's two words for it. */
static int64_t step_of(const conduit_node *params) {
    double cycle = mesh_number(params, "catalyst/state/cycle", 0);
    return (int64_t)mesh_number(params, "catalyst/state/timestep", cycle);
}

/* Collective. */
static snow_status show(const conduit_node *params) {
    int count = 0;
    double spacing[3] = {1, 1, 1};
    conduit_node *channel = find_channel(params);
    if (channel) /* a failure is told to all by place_bricks */
        snow_insitu_set_error(adaptor.insitu,
                              read_domains(channel, &count, spacing));
    snow_status status = snow_insitu_place_bricks(
        adaptor.insitu, adaptor.places, count, spacing);
    if (status != SNOW_STATUS_OK)
        return status;
    for (int n = 0; n < count; n++) {
        const mesh_brick *b = &adaptor.bricks[n];
        if (b->place.count[0] > 0)
            snow_insitu_set_voxels(adaptor.insitu, n, b->type, b->voxels,
                                   b->stride);
    }
    if (conduit_node_has_path((conduit_node *)params, "catalyst/state/time"))
        snow_insitu_set_time(adaptor.insitu,
                             mesh_number(params, "catalyst/state/time", 0), "");
    return snow_insitu_step(adaptor.insitu, step_of(params));
}

/* Collective. */
static void report_figures(int64_t step) {
    snow_insitu_stats f = {.size = sizeof f};
    const char *verbose = getenv("SNOWGLASS_VERBOSE");
    if (snow_insitu_get_stats(adaptor.insitu, &f) != SNOW_STATUS_OK ||
        !verbose || snow_comm_rank(adaptor.comm) != 0)
        return;
    fprintf(stderr,
            "snowglass: step %lld: %.3g s (update %.3g, draw %.3g, write %.3g),"
            " sent %.3g MB, held up to %.3g MB a rank\n",
            (long long)step, f.seconds_step.most, f.seconds_update.most,
            f.seconds_draw.most, f.seconds_write.most, f.bytes_sent.most / 1e6,
            f.bytes_held.most / 1e6);
}

enum catalyst_status catalyst_execute_snowglass(const conduit_node *params) {
    if (!adaptor.insitu)
        return catalyst_status_ok;
    if (show(params) != SNOW_STATUS_OK)
        say_once(snow_insitu_message(adaptor.insitu));
    report_figures(step_of(params));
    return catalyst_status_ok;
}

/* --- the others ----------------------------------------------------------- */

enum catalyst_status catalyst_finalize_snowglass(const conduit_node *params) {
    (void)params;
    close_all();
    return catalyst_status_ok;
}

enum catalyst_status catalyst_about_snowglass(conduit_node *params) {
    conduit_node_set_path_char8_str(params, "catalyst/implementation",
                                    "snowglass");
    conduit_node_set_path_char8_str(params, "catalyst/snowglass/version",
                                    snow_version());
    return catalyst_status_ok;
}

enum catalyst_status catalyst_results_snowglass(conduit_node *params) {
    (void)params; /* pictures are files */
    return catalyst_status_ok;
}
