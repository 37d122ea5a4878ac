/* catalyst/mesh.h - the uniform meshes of a Conduit node, by the conventions of
 * Conduit's Mesh Blueprint, as ParaView's Catalyst takes them. */
#ifndef CATALYST_MESH_H
#define CATALYST_MESH_H

#include <catalyst.h>
#include <snowglass/insitu.h>

#define MESH_WRONG 256

/* One domain's field: a brick of voxels in the world. */
typedef struct mesh_brick {
    snow_world_brick place;
    snow_type type;
    const void *voxels; /* of the brick's first voxel, behind its halo */
    int64_t stride[3];
} mesh_brick;

/* Reads one domain.  `field` names the field; "" is the first one.  False where
 * the mesh is none that can be shown: `wrong` then says what it is, as the end
 * of a sentence about it. */
bool mesh_read(const conduit_node *domain, const char *field, mesh_brick *out,
               double spacing[3], char wrong[MESH_WRONG]);

/* A number of any type at a path, as a double; `otherwise` where there is none.
 */
double mesh_number(const conduit_node *node, const char *path,
                   double otherwise);

/* The text at a path, NULL where there is none; owned by the node. */
const char *mesh_text(const conduit_node *node, const char *path);

#endif
