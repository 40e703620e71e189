/* How a tree of lights lies in device memory (kernels/lib/light_tree.h reads it, runtime/scene/light_tree.h builds it).
 *
 * It is complete: each node has four children, a path from the root takes TRAIT_LIGHT_TREE of them and ends at a leaf,
 * a few lights. So nodes need no references, and a leaf's number in base 4 is the path to it. Children that hold no
 * light have no intensity. One leaf more, the last, holds the lights at infinity, to which no path leads. */
#ifndef GRADUS_SHARED_LIGHT_TREE_H
#define GRADUS_SHARED_LIGHT_TREE_H
#include "kernels/shared/compat.h"

#define light_tree_children 4u

/* light_nodes: level by level, sixteen words a node, one line of the cache. Of each child in turn (bits from the
 * lowest):
 *   0  its centre's x and y, 16 bits each, in units of the box of all lights
 *   1  z, and the radius of the sphere that holds it
 *   2  the axis of the cone of its normals times the cosine of the cone's half angle, three signed bytes; the sine
 *   3  float: what it sends into the direction that gets most, over that of the brightest child of the node */
#define light_child_words 4u
#define light_node_words (light_tree_children * light_child_words)

/* light_slots: three words for each light of a leaf, an alias table: the light, its alias, and below which of 2^24
 * draws the light is kept. light_leaves: by leaf, its first slot; one more ends the last leaf. light_leaf: by light,
 * its leaf; one more for the black light. */
#define light_slot_words 3u

/* Path tables keep a vertex's geometric normal as three numbers of 10 bits. */
#define light_normal_steps R(511)

#endif
