/* tests/catalyst/catalyst.h - a stand-in for Catalyst's header of that name,
 * with the few declarations of Catalyst 2 and of Conduit's C interface that the
 * implementation under test uses.  Their meaning is that of the public
 * documentation; conduit.c is what stands behind them here. */
#ifndef STUB_CATALYST_H
#define STUB_CATALYST_H

#include <stdint.h>

typedef void conduit_node;
typedef void conduit_datatype;
typedef int64_t conduit_index_t;

enum catalyst_status {
    catalyst_status_ok = 0,
    catalyst_status_error_no_implementation
};

/* What an implementation exports as catalyst_api_impl. */
struct catalyst_impl {
    int version;
    enum catalyst_status (*initialize)(const conduit_node *);
    enum catalyst_status (*execute)(const conduit_node *);
    enum catalyst_status (*finalize)(const conduit_node *);
    enum catalyst_status (*about)(conduit_node *);
    enum catalyst_status (*results)(conduit_node *);
};

conduit_node *conduit_node_create(void);
void conduit_node_destroy(conduit_node *node);
int conduit_node_has_path(const conduit_node *node, const char *path);
conduit_node *conduit_node_fetch(conduit_node *node, const char *path);
conduit_index_t conduit_node_number_of_children(conduit_node *node);
conduit_node *conduit_node_child(conduit_node *node, conduit_index_t index);
const conduit_datatype *conduit_node_dtype(const conduit_node *node);
void *conduit_node_element_ptr(conduit_node *node, conduit_index_t index);
char *conduit_node_as_char8_str(conduit_node *node);

void conduit_node_set_path_char8_str(conduit_node *node, const char *path,
                                     const char *value);
void conduit_node_set_path_int32(conduit_node *node, const char *path,
                                 int32_t value);
void conduit_node_set_path_int64(conduit_node *node, const char *path,
                                 int64_t value);
void conduit_node_set_path_float64(conduit_node *node, const char *path,
                                   double value);
/* Offset and stride in bytes; the data stay the caller's. */
void conduit_node_set_path_external_float64_ptr_detailed(
    conduit_node *node, const char *path, double *data, conduit_index_t count,
    conduit_index_t offset, conduit_index_t stride,
    conduit_index_t element_bytes, conduit_index_t endianness);
void conduit_node_set_path_external_uint8_ptr(conduit_node *node,
                                              const char *path, uint8_t *data,
                                              conduit_index_t count);

conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *);
conduit_index_t conduit_datatype_stride(const conduit_datatype *);
conduit_index_t conduit_datatype_element_bytes(const conduit_datatype *);
int conduit_datatype_is_object(const conduit_datatype *);
int conduit_datatype_is_char8_str(const conduit_datatype *);
int conduit_datatype_is_int8(const conduit_datatype *);
int conduit_datatype_is_int16(const conduit_datatype *);
int conduit_datatype_is_int32(const conduit_datatype *);
int conduit_datatype_is_int64(const conduit_datatype *);
int conduit_datatype_is_uint8(const conduit_datatype *);
int conduit_datatype_is_uint16(const conduit_datatype *);
int conduit_datatype_is_uint32(const conduit_datatype *);
int conduit_datatype_is_uint64(const conduit_datatype *);
int conduit_datatype_is_float32(const conduit_datatype *);
int conduit_datatype_is_float64(const conduit_datatype *);

#endif
