/* sizes.c - implements sizes.h. */
#include "net/sizes.h"

static int find(const page_size *sizes, int count, const page_size *size) {
    int i = 0;
    while (i < count &&
           (sizes[i].width != size->width || sizes[i].height != size->height))
        i++;
    return i;
}

void sizes_collect(client *pages, viewer_state *s) {
    page_size sizes[STATE_SIZES_MOST];
    int count = 0;
    for (client *c = pages; c; c = c->next) {
        const int at = find(sizes, count, &c->size);
        c->served = c->size.width && at < STATE_SIZES_MOST;
        if (!c->served || at < count)
            continue;
        sizes[count++] = c->size;
    }
    state_set_sizes(s, sizes, count);
}

static json_t *size_of(const client *c) {
    return json_pack("[I,I]", (json_int_t)c->size.width,
                     (json_int_t)c->size.height);
}

json_t *sizes_take(client *pages, client *c, viewer_state *s,
                   const json_t *changes) {
    json_t *made = json_copy((json_t *)changes);
    const json_t *size = json_object_get(changes, "size");
    if (size) {
        c->size.width = json_integer_value(json_array_get(size, 0));
        c->size.height = json_integer_value(json_array_get(size, 1));
        sizes_collect(pages, s);
    }
    if (pages->next && json_object_size(made) == 1 && size)
        json_object_del(made, "size");
    else if (pages->next && !size && c->size.width)
        json_object_set_new(made, "size", size_of(c));
    return made;
}

void sizes_serve(client *c, viewer_state *s, outbox *box) {
    outgoing *p = outbox_newest(box, MESSAGE_PICTURE);
    json_t *again = json_pack("{s:o}", "size", size_of(c));
    if (p && p->shape == client_shape(c) && p->revision == state_revision(s))
        client_queue(c, box, p);
    else
        state_note_rest(s, again, 0);
    if (p)
        outgoing_release(box, p);
    json_decref(again);
}

json_t *sizes_ask(const client *c, const json_t *question) {
    json_t *made = json_deep_copy(question);
    if (c->size.width && !json_object_get(made, "size"))
        json_object_set_new(made, "size", size_of(c));
    return made;
}
