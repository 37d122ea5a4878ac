/* measuring.c - answers what lies under a page's pointer, and what is measured;
 * see answers.h. */
#include "answers/answers.h"

#include "draw/pick.h"
#include "draw/slices.h"
#include "message.h"
#include "run/log.h"

#include <math.h>

void answer_read_voxel(const json_t *tree, int64_t index[3]) {
    const json_t *at = json_object_get(tree, "at");
    for (size_t i = 0; i < 3; i++)
        index[i] = json_integer_value(json_array_get(at, i));
}

/* The size of the page's picture, as far as that is known. */
void answer_read_size(const json_t *tree, double size[2]) {
    const json_t *list = json_object_get(tree, "size");
    for (size_t i = 0; i < 2; i++) {
        const double side = json_number_value(json_array_get(list, i));
        size[i] = side >= 1 && side <= MESSAGE_SIDE ? side : size[i];
    }
}

/* Whether x and y are shares of the picture. */
bool answer_read_spot(const json_t *tree, double *x, double *y) {
    *x = json_number_value(json_object_get(tree, "x"));
    *y = json_number_value(json_object_get(tree, "y"));
    return *x >= 0 && *x <= 1 && *y >= 0 && *y <= 1;
}

/* {"what": "measures"}: what --stats lists, and the words that it is of. */
int answer_measures(drawing *d, outbox *box, uint64_t client,
                    const json_t *tree) {
    (void)tree;
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:s, s:o}", "t", "measures", "of",
                         d->opts.measure ? d->opts.measure : "", "measures",
                         measures_json(d->state.measures)));
    return CONTINUE;
}

static void put_probe(outbox *box, uint64_t client, const json_t *tree,
                      const char *what, double found) {
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:I, s:o}", "t", "probe", "n",
                         json_integer_value(json_object_get(tree, "n")), what,
                         json_number(found)));
}

void answer_no_probe(outbox *box, uint64_t client, const json_t *tree) {
    put_probe(box, client, tree, "value", NAN);
}

/* {"what": "probe", "n": 7, "at": [12, 30, 57]}: the value of that voxel; or
 * with x, y and size as above, the depth. */
int answer_probe(drawing *d, outbox *box, uint64_t client, const json_t *tree) {
    double x, y, depth = NAN;
    double size[2] = {d->state.view.width, d->state.view.height};
    int64_t at[3];
    if (json_object_get(tree, "at")) {
        answer_read_voxel(tree, at);
        put_probe(box, client, tree, "value", slices_value(d, at));
        return CONTINUE;
    }
    answer_read_size(tree, size);
    if (answer_read_spot(tree, &x, &y))
        (void)pick_depth(d, x, y, size, &depth);
    put_probe(box, client, tree, "depth", depth);
    return CONTINUE;
}
