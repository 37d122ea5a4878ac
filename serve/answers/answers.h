/* answers.h - what pages get to know of the volume and its look, as JSON. */
#ifndef ANSWERS_H
#define ANSWERS_H

#include "draw/drawing.h"
#include "movies/order.h"
#include "net/outbox.h"
#include "state.h"

/* --- description.c ---
 *
 * For all pages, also those that come later: the volume, its views, the names
 * that a recipe may hold; the transfer function, and for the state what would
 * make it anew; figures of the last picture. */
void answer_info(drawing *d, outbox *box);
void answer_look(drawing *d, outbox *box);
void answer_kept(drawing *d, viewer_state *s, uint32_t revision);

/* What a recipe needs for the look to stay as it is (kept_look.h); NULL: keys
 * cannot say it, as those of labels, of channels, and of projections, whose
 * values are spread anew. */
json_t *answer_look_keys(const drawing *d);

/* The name of the map whose colours a look has, a new reference; or NULL. */
json_t *answer_colormap(const snow_look *look);
void answer_figures(drawing *d, double hidden, outbox *box);

/* Says once that the file was replaced: `told` keeps the identity that was
 * said last. */
void answer_replaced(const drawing *d, char told[IDENTITY_BYTES], outbox *box);

/* The step that a simulation has drawn. */
void answer_step(outbox *box, int64_t step);

/* --- measuring.c ---
 *
 * Of questions: the voxel `at`; x and y, whether they are shares of the
 * picture's sides; the size of the page's picture, as far as that is known. */
void answer_read_voxel(const json_t *tree, int64_t index[3]);
bool answer_read_spot(const json_t *tree, double *x, double *y);
void answer_read_size(const json_t *tree, double size[2]);

/* What is measured; what is at a place, or that nothing is. */
int answer_measures(drawing *d, outbox *box, uint64_t client,
                    const json_t *tree);
int answer_probe(drawing *d, outbox *box, uint64_t client, const json_t *tree);
void answer_no_probe(outbox *box, uint64_t client, const json_t *tree);

/* --- thumbnails.c ---
 *
 * A preset or a colour map on the volume, as a small picture. */
void answer_thumbnail(drawing *d, viewer_state *s, outbox *box, uint64_t client,
                      json_t *tree);

/* --- answers.c ---
 *
 * Sends a tree, which it frees. */
void answer_put(outbox *box, uint64_t client, message_topic about,
                json_t *tree);

/* A recipe, as a text; or what one has of a look alone. */
void answer_recipe_text(outbox *box, uint64_t client, const json_t *tree,
                        bool look);

/* Answers one page.  SNOW_STATUS_NO_MEMORY: had no room, and has answered
 * nothing. */
int answer_question(drawing *d, viewer_state *s, outbox *box,
                    const viewer_question *question);

/* The command of a movie that a page orders of the newest state, to be freed,
 * and the name of its file; NULL: the page has heard why not. */
char *answer_movie(drawing *d, viewer_state *s, outbox *box,
                   const viewer_question *question, movie_order *order,
                   char name[100]);

/* Of slices and values, which a page waits for: that there is none. */
void answer_none(outbox *box, uint64_t client, const json_t *tree);

/* Sends a line that is shown as it is: to a page, or to all (0). */
void answer_said(outbox *box, uint64_t client, const char *line);

#endif
