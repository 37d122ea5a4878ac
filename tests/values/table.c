/* tests/values/table.c - the value model's table of colours.
 *
 * docs/model.md, the value model, point 5. */
#include "values/value_model.h"

#include <math.h>
#include <stdlib.h>

void value_look(const value_plan *plan, double v, double rgba[4]) {
    const reference_scene *scene = &plan->scene->base;
    double x = plan->low + v * (plan->high - plan->low) / VALUE_MOST;
    reference_classify(scene, scene->log ? pow(10, x) : x, rgba);
    double threshold = scene->settings.threshold;
    if (threshold > 0 && 255 * rgba[3] <= threshold + 0.0001)
        rgba[3] = 0;
}

/* How much the look of a slab of one value changes from V - 1 to V. */
static double change(const value_plan *plan, int v, double exponent) {
    double look[2][4], sum = 0;
    for (int n = 0; n < 2; n++) {
        value_look(plan, v - 1 + n, look[n]);
        look[n][3] = 1 - pow(1 - look[n][3], exponent);
        for (int c = 0; c < 3; c++)
            look[n][c] *= look[n][3];
    }
    for (int c = 0; c < 4; c++)
        sum += (c == 3 ? 3 : 1) * fabs(look[1][c] - look[0][c]);
    return sum;
}

/* Half of the nodes evenly, half where the look changes; no value has more of
 * this than one node. */
static void measure_nodes(const value_plan *plan, value_table *table) {
    double *until = calloc(VALUE_MOST + 1, sizeof *until), total = 0;
    double exponent = plan->path / reference_opacity_length(&plan->scene->base);
    for (int v = 1; v <= VALUE_MOST; v++)
        total += until[v] = change(plan, v, exponent);
    for (int v = 1; v <= VALUE_MOST; v++) {
        double part = total > 0 ? until[v] / total : 1.0 / VALUE_MOST;
        part = fmin(0.5 / VALUE_MOST + 0.5 * part, 1.0 / (table->nodes - 1));
        until[v] = until[v - 1] + part;
    }
    for (int node = 0, v = 0; node < table->nodes; node++) {
        while (v < VALUE_MOST &&
               until[v] < until[VALUE_MOST] * node / (table->nodes - 1))
            v++;
        table->at[node] = v;
    }
    free(until);
}

/* The last value before a step between two others, or -1. */
static int find_step(const value_plan *plan, int from, int to) {
    double first[4], last[4], near[2][4];
    value_look(plan, from, first);
    value_look(plan, to, last);
    for (int v = from; v < to; v++) {
        value_look(plan, v, near[0]);
        value_look(plan, v + 1, near[1]);
        if (2 * fabs(near[1][3] - near[0][3]) > fabs(last[3] - first[3]))
            return v;
    }
    return -1;
}

static bool has_step(const value_plan *plan) {
    const reference_scene *scene = &plan->scene->base;
    for (size_t n = 0; n + 1 < scene->opacity_count; n++)
        if (scene->opacities[n].value == scene->opacities[n + 1].value &&
            scene->opacities[n].opacity != scene->opacities[n + 1].opacity)
            return true;
    return scene->settings.threshold > 0;
}

/* Pairs of nodes about a step have it midway; looks are 1/128 node apart. */
static void move_to_steps(const value_plan *plan, value_table *table) {
    const double apart = VALUE_MOST / (128.0 * (table->nodes - 1));
    for (int node = 0; node + 1 < table->nodes; node++) {
        double *at = table->at + node;
        int from = (int)ceil(at[0]), to = (int)floor(at[1]);
        int step = from < to ? find_step(plan, from, to) : -1;
        if (step < 0)
            continue;
        double by = rint((step + 0.5 - (at[0] + at[1]) / 2) / apart) * apart;
        at[0] += by;
        at[1] += by;
        node++;
    }
}

static void place_nodes(const value_plan *plan, value_table *table) {
    const bool moved = !plan->measured && table->nodes == 256 && has_step(plan);
    for (int node = 0; node < table->nodes; node++)
        table->at[node] = table->nodes == 129
                              ? 128 * node
                              : (double)VALUE_MOST * node / (table->nodes - 1);
    if (plan->measured)
        measure_nodes(plan, table);
    if (moved)
        move_to_steps(plan, table);
    for (int v = 0, node = 0; v <= VALUE_MOST; v++) {
        while (node + 1 < table->nodes &&
               table->at[node + 1] - v <= v - table->at[node])
            node++;
        table->index[v] = (uint8_t)node;
    }
    if (plan->measured || moved)
        return;
    for (int v = 0; v <= VALUE_MOST; v++)
        if (table->nodes == 129)
            table->index[v] = (uint8_t)((v + 64) >> 7);
        else if (table->nodes == 256)
            table->index[v] = (uint8_t)((510 * v + 16384) >> 15);
}

/* Equal steps of the value from the front to the back, composited. */
static value_entry enter(const value_plan *plan, double front, double back,
                         double unit, double *most) {
    double length = reference_opacity_length(&plan->scene->base);
    double exponent = plan->path / (plan->steps * length);
    double through = 1, color[3] = {0}, places = 0, weights = 0;
    for (int n = 0; n < plan->steps; n++) {
        double t = (n + 0.5) / plan->steps, look[4];
        value_look(plan, front + t * (back - front), look);
        double alpha = look[3] >= 1 ? 1 : 1 - pow(1 - look[3], exponent);
        for (int c = 0; c < 3; c++)
            color[c] += through * alpha * look[c];
        places += through * alpha * t;
        weights += through * alpha;
        through *= 1 - alpha;
    }
    *most = fmax(*most, 1 - through);
    value_entry entry = {.alpha = (int)rint((1 - through) / unit),
                         .place =
                             weights > 0 ? (int)(16 * places / weights) : 8};
    for (int c = 0; c < 3; c++)
        entry.color[c] = (int)rint(color[c] / unit);
    return entry;
}

/* Returns the largest alpha. */
static double fill(const value_plan *plan, value_table *table) {
    size_t nodes = (size_t)table->nodes;
    double most = 0;
    for (size_t f = 0; f < nodes; f++)
        for (size_t b = 0; b < nodes; b++)
            table->entries[f * nodes + b] =
                enter(plan, table->at[f], table->at[b], table->unit, &most);
    return most;
}

void value_table_make(const value_plan *plan, value_table *table) {
    *table = (value_table){.nodes = plan->nodes};
    size_t nodes = (size_t)plan->nodes;
    table->at = calloc(nodes, sizeof *table->at);
    table->entries = calloc(nodes * nodes, sizeof *table->entries);
    place_nodes(plan, table);
    table->unit = 1 / 32767.0;
    double most = fill(plan, table);
    if (!(most > 0) || most >= 0.004)
        return;
    for (; most <= 0.0625; most *= 2)
        table->unit /= 2;
    fill(plan, table);
}

void value_table_free(value_table *table) {
    free(table->at);
    free(table->entries);
}
