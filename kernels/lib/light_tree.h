/* Choosing among many lights by what they may send to a place: a tree of lights (Conty Estevez and Kulla 2018). At each
 * node a child is drawn by an estimate of its light: its intensity over the squared distance, times bounds of the
 * cosines at the lights and at the receiver. Estimates are never 0, so every light can be drawn from everywhere; any
 * estimate is unbiased, a better one has less noise.
 *
 * Rows walk down in step: all paths have as many nodes, children are chosen by arithmetic, and loads depend on nothing
 * but the path so far. The probability of a given light is that of the children on the way to it, told by its leaf's
 * number. Who makes a choice and who weighs it evaluate the same function of the same vertex.
 *
 * Lights at infinity are chosen apart, with a fixed probability that light_probability holds already. */
#ifndef GRADUS_LIB_LIGHT_TREE_H
#define GRADUS_LIB_LIGHT_TREE_H
//! traits: TRAIT_LIGHT_TREE
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/light_tree.h"

/* What a probability is asked with, and what a choice asks beside that. */
#define LIGHT_PROBABILITY_PARAMETERS_NOW                                                                               \
    , GRADUS_GLOBAL const uint *light_nodes, GRADUS_GLOBAL const uint *light_leaf, real light_tree_x,                  \
        real light_tree_y, real light_tree_z, real light_tree_scale
#define LIGHT_CHOICE_PARAMETERS_NOW                                                                                    \
    LIGHT_PROBABILITY_PARAMETERS_NOW, GRADUS_GLOBAL const uint *light_leaves, GRADUS_GLOBAL const uint *light_slots,   \
        real light_share_at_infinity
#if TRAIT_LIGHT_TREE
#define LIGHT_PROBABILITY_PARAMETERS LIGHT_PROBABILITY_PARAMETERS_NOW
#define LIGHT_CHOICE_PARAMETERS LIGHT_CHOICE_PARAMETERS_NOW
#else
#define LIGHT_PROBABILITY_PARAMETERS
#define LIGHT_CHOICE_PARAMETERS
#endif

#if TRAIT_LIGHT_TREE || !defined(__OPENCL_VERSION__)

/* A kernel is compiled for one number of levels, so that its loops are unrolled. */
#ifdef __OPENCL_VERSION__
#define LIGHT_TREE_LEVELS(levels) TRAIT_LIGHT_TREE
#define LIGHT_TREE_UNROLL _Pragma("unroll")
#else
#define LIGHT_TREE_LEVELS(levels) (levels)
#define LIGHT_TREE_UNROLL
#endif

/* The least that a bound of a cosine counts as. */
#define LIGHT_LEAST_COSINE R(0.01)

GRADUS_LIB_BEGIN

/* Where light arrives. */
typedef struct {
    vec3 position; /* in the tree's units */
    vec3 normal;   /* geometric, of unit length but for rounding; its sign does not matter */
    GRADUS_NOT_IN_REGISTERS
} light_receiver;

/* A normal in a word. */
GRADUS_FN uint light_normal_bits(vec3 n) {
    const uint x = (uint)(int)(n.x * light_normal_steps + light_normal_steps + R(0.5));
    const uint y = (uint)(int)(r_after(n.y, n.x) * light_normal_steps + light_normal_steps + R(0.5));
    const uint z = (uint)(int)(r_after(n.z, n.y) * light_normal_steps + light_normal_steps + R(0.5));
    return x | y << 10 | z << 20;
}

GRADUS_FN real light_normal_component(uint bits) {
    return ((real)(int)(bits & 1023u) - light_normal_steps) * (R(1) / light_normal_steps);
}

/* position: of the vertex, or where its ray starts. normal_bits: light_normal_bits() there. `after`: computed after
 * that, a finite number. */
GRADUS_FN light_receiver light_receiver_at(vec3 position, uint normal_bits, real after, real x, real y, real z,
                                           real scale) {
    light_receiver receiver;
    /* One after the other (kernels/lib/ordered.h). */
    receiver.position.x = (r_after(position.x, after) - x) * scale;
    receiver.position.y = (r_after(position.y, receiver.position.x) - y) * scale;
    receiver.position.z = (r_after(position.z, receiver.position.y) - z) * scale;
    receiver.normal.x = light_normal_component(uint_after(normal_bits, receiver.position.z));
    receiver.normal.y = light_normal_component(uint_after(normal_bits >> 10, receiver.normal.x));
    receiver.normal.z = light_normal_component(uint_after(normal_bits >> 20, receiver.normal.y));
    return receiver;
}
#define LIGHT_RECEIVER(position, normal_bits, after)                                                                   \
    light_receiver_at(position, normal_bits, after, light_tree_x, light_tree_y, light_tree_z, light_tree_scale)

typedef struct {
    vec3 center, axis; /* the axis times the cosine of the cone */
    real radius, sine, intensity;
    real spread; /* what its size adds to squared distances */
    uint last;   /* for what is to be computed after it */
    GRADUS_NOT_IN_REGISTERS
} light_cluster;

/* A child of `node`, the number of a record. `after`: a word that its own are computed after, one after the other, or
 * LLVM would pack them (kernels/lib/ordered.h); as whole numbers, since rows wait for nothing as long as for this. */
GRADUS_FN light_cluster light_cluster_of(GRADUS_GLOBAL const uint *nodes, uint unit, uint node, uint child,
                                         uint after) {
#define CLUSTER_WORD(word) (nodes + (child * light_child_words + (word)) * (size_t)unit)[(int)(node * light_node_words)]
    const uint none = unit - 1u; /* 0, which the compiler does not know */
    light_cluster c;
    const uint xy = CLUSTER_WORD(0u) | (after & none);
    const uint x = xy & 0xFFFFu, y = (xy | (x & none)) >> 16;
    const uint zr = CLUSTER_WORD(1u) | (y & none);
    const uint z = zr & 0xFFFFu, radius = (zr | (z & none)) >> 16;
    const uint cone = CLUSTER_WORD(2u) | (radius & none);
    const int axis_x = (int)(cone << 24) >> 24;
    const int axis_y = (int)((cone | ((uint)axis_x & none)) << 16) >> 24;
    const int axis_z = (int)((cone | ((uint)axis_y & none)) << 8) >> 24;
    const uint sine = (cone | ((uint)axis_z & none)) >> 24;
    c.center.x = (real)(int)x;
    c.center.y = (real)(int)y;
    c.center.z = (real)(int)z;
    c.radius = (real)(int)radius;
    c.spread = R(0.25) * (c.radius * c.radius);
    c.axis.x = (real)axis_x * R(1.0 / 127);
    c.axis.y = (real)axis_y * R(1.0 / 127);
    c.axis.z = (real)axis_z * R(1.0 / 127);
    c.sine = (real)(int)sine * R(1.0 / 255);
    c.last = sine;
    c.intensity = (real)as_float(CLUSTER_WORD(3u));
#undef CLUSTER_WORD
    return c;
}

/* What a cluster of lights may send to a receiver, in units of which only ratios count; 0 if it holds no light.
 *
 * With d from receiver to centre and a radius r, its points are taken as sqrt(d^2 + r^2 / 4) away: the mean square of
 * points in a box about its centre is a third of r^2, and less than that had the least variance. A plane through the
 * receiver has all points of the sphere at most n . d + r above it, which bounds the cosine at the receiver, and with
 * a light's normal in place of n that at the light. Of a cone of normals about the axis a with half angle t the
 * largest is at most cos t (a . d) + sin t. */
GRADUS_FN real light_cluster_importance(light_cluster c, light_receiver receiver) {
    const vec3 d = v3_sub(c.center, receiver.position);
    const real inverse_squared = R(1) / (v3_dot(d, d) + c.spread + R(1));
    const real inverse = r_sqrt(inverse_squared);
    const real leaving = (c.radius - v3_dot(c.axis, d)) * inverse + c.sine;
    const real arriving = (c.radius + r_abs(v3_dot(receiver.normal, v3_after(d, leaving)))) * inverse;
    return c.intensity * inverse_squared * r_clamp(leaving, LIGHT_LEAST_COSINE, R(1)) *
           r_clamp(arriving, LIGHT_LEAST_COSINE, R(1));
}

/* A node's children, and what each may send. No arrays: PoCL's compiler would leave them in memory. */
typedef struct {
    light_cluster of_0, of_1, of_2, of_3;
} light_clusters;
typedef struct {
    real of_0, of_1, of_2, of_3;
    GRADUS_NOT_IN_REGISTERS
} light_estimates;

/* `after`: as light_cluster_of() has it. */
GRADUS_FN light_clusters light_clusters_of(GRADUS_GLOBAL const uint *nodes, uint unit, uint node, uint after) {
    light_clusters c;
    c.of_0 = light_cluster_of(nodes, unit, node, 0u, after);
    c.of_1 = light_cluster_of(nodes, unit, node, 1u, c.of_0.last);
    c.of_2 = light_cluster_of(nodes, unit, node, 2u, c.of_1.last);
    c.of_3 = light_cluster_of(nodes, unit, node, 3u, c.of_2.last);
    return c;
}

/* One after the other (kernels/lib/ordered.h), and after `after`, a finite number. */
GRADUS_FN light_estimates light_estimates_at(light_clusters c, light_receiver receiver, real after) {
    light_estimates w;
    receiver.position = v3_after(receiver.position, after);
    w.of_0 = light_cluster_importance(c.of_0, receiver);
    receiver.position = v3_after(receiver.position, w.of_0);
    w.of_1 = light_cluster_importance(c.of_1, receiver);
    receiver.position = v3_after(receiver.position, w.of_1);
    w.of_2 = light_cluster_importance(c.of_2, receiver);
    receiver.position = v3_after(receiver.position, w.of_2);
    w.of_3 = light_cluster_importance(c.of_3, receiver);
    return w;
}

typedef struct {
    uint light;
    real path; /* probability of the way to its leaf */
    GRADUS_NOT_IN_REGISTERS
} light_picked;

/* u: what is left of a uniform number where those in [low, low + width) were taken, as one in [0, 1) again. */
GRADUS_FN real light_rest_of(real u, real low, real width) {
    return r_clamp((u - low) / width, R(0), R(1) - R(1.0 / 16777216));
}

/* A light, by two uniform numbers. Each leads through one half of the way, and what is left of the second to the light
 * in its leaf: 24 bits would not reach them all. */
GRADUS_FN light_picked light_tree_pick(GRADUS_GLOBAL const uint *nodes, GRADUS_GLOBAL const uint *leaves,
                                       GRADUS_GLOBAL const uint *slots, uint levels, uint unit, real share_at_infinity,
                                       light_receiver receiver, real a, real b) {
    (void)levels;
    const int is_far = a < share_at_infinity;
    real u = light_rest_of(a, is_far ? R(0) : share_at_infinity, is_far ? share_at_infinity : R(1) - share_at_infinity);
    uint place = 0u, first = 0u; /* of its level, and its first node */
    real path = R(1), last = R(0);
    LIGHT_TREE_UNROLL
    for (uint level = 0; level < LIGHT_TREE_LEVELS(levels); ++level) {
        const uint node = first + place;
        const light_estimates w = light_estimates_at(light_clusters_of(nodes, unit, node, 0u), receiver, last);
        last = w.of_2;
        const real sum_1 = w.of_0 + w.of_1, sum_2 = sum_1 + w.of_2, sum = sum_2 + w.of_3;
        /* Rounding may take u past the last: one that is never drawn is never taken. */
        const real drawn = u * sum;
        const int takes_1 = (w.of_1 > R(0)) & (drawn >= w.of_0), takes_2 = (w.of_2 > R(0)) & (drawn >= sum_1),
                  takes_3 = (w.of_3 > R(0)) & (drawn >= sum_2);
        real low = takes_1 ? w.of_0 : R(0), taken = takes_1 ? w.of_1 : w.of_0;
        low = takes_2 ? sum_1 : low;
        taken = takes_2 ? w.of_2 : taken;
        low = takes_3 ? sum_2 : low;
        taken = takes_3 ? w.of_3 : taken;
        const uint child = max(max((uint)takes_1, 2u * (uint)takes_2), 3u * (uint)takes_3);
        path *= taken / sum;
        u = light_rest_of(drawn, low, taken);
        if (level == (LIGHT_TREE_LEVELS(levels) - 1u) / 2u)
            u = b;
        place = light_tree_children * place + child;
        first = light_tree_children * first + 1u;
    }
    const uint leaf = is_far ? 3u * first + 1u : place;
    const uint begin = leaves[(int)leaf], end = (leaves + (size_t)unit)[(int)leaf];
    const real column = (is_far ? b : u) * (real)(int)(end - begin);
    const uint number = min((uint)(int)column, end - begin - 1u);
    const uint keeps = (uint)(int)((column - (real)(int)number) * R(16777216));
    const uint slot = (begin + number) * light_slot_words;
    const uint own = slots[(int)slot], other = (slots + 1 * (size_t)unit)[(int)slot];
    light_picked picked;
    picked.light = keeps < (slots + 2 * (size_t)unit)[(int)slot] ? own : other;
    picked.path = is_far ? R(1) : path;
    return picked;
}

/* With which probability a receiver is led to `child`. */
GRADUS_FN real light_child_share(light_clusters clusters, uint child, light_receiver receiver, real after) {
    const light_estimates w = light_estimates_at(clusters, receiver, after);
    real taken = child == 1u ? w.of_1 : w.of_0;
    taken = child == 2u ? w.of_2 : taken;
    taken = child == 3u ? w.of_3 : taken;
    return taken / (((w.of_0 + w.of_1) + w.of_2) + w.of_3);
}

/* A base path's vertex and those of its offset paths, 0 to 3, who are asked for the same light. */
typedef struct {
    light_receiver base, offset_0, offset_1, offset_2, offset_3;
} light_receivers;

/* With which probability a way from the root leads to a leaf. */
typedef struct {
    real base;
    real offset_0, offset_1, offset_2, offset_3; /* over the base path's */
} light_paths;

/* Of one of the four; j is a constant once loops are unrolled. */
#define LIGHT_PATH_OF(paths, j)                                                                                        \
    ((j) == 0u ? (paths).offset_0 : (j) == 1u ? (paths).offset_1 : (j) == 2u ? (paths).offset_2 : (paths).offset_3)

/* A number that is finite, whatever x is. */
GRADUS_FN real light_finite(real x) { return r_clamp(x, R(0), R(1e30)); }

/* with_base: the base path's is asked for; else it is `base`. with_offsets: those of offset paths are. */
GRADUS_FN light_paths light_tree_paths(GRADUS_GLOBAL const uint *nodes, uint levels, uint unit, uint leaf,
                                       light_receivers r, int with_base, real base, int with_offsets) {
    (void)levels;
    const uint leaf_count = 1u << (2u * LIGHT_TREE_LEVELS(levels));
    /* Of the leaf of lights at infinity another's way, which is not counted. */
    const uint present = leaf & (leaf_count - 1u);
    const int is_near = leaf == present;
    light_paths p;
    p.base = p.offset_0 = p.offset_1 = p.offset_2 = p.offset_3 = R(1);
    uint first = 0u;
    /* One after the other (kernels/lib/ordered.h), and after what is finite even where an offset path has no vertex. */
    real last = R(0);
    uint word = 0u;
    LIGHT_TREE_UNROLL
    for (uint level = 0; level < LIGHT_TREE_LEVELS(levels); ++level) {
        const uint below = 2u * (LIGHT_TREE_LEVELS(levels) - level);
        const uint node = first + (present >> below);
        const uint child = (present >> (below - 2u)) & 3u;
        first = light_tree_children * first + 1u;
        const light_clusters clusters = light_clusters_of(nodes, unit, node, word);
        word = clusters.of_3.last;
        if (with_base) {
            p.base *= light_child_share(clusters, child, r.base, last);
            last = light_finite(p.base);
        }
        if (with_offsets) {
            p.offset_0 *= light_child_share(clusters, child, r.offset_0, last);
            last = light_finite(p.offset_0);
            p.offset_1 *= light_child_share(clusters, child, r.offset_1, last);
            last = light_finite(p.offset_1);
            p.offset_2 *= light_child_share(clusters, child, r.offset_2, last);
            last = light_finite(p.offset_2);
            p.offset_3 *= light_child_share(clusters, child, r.offset_3, last);
            last = light_finite(p.offset_3);
        }
    }
    p.base = with_base ? (is_near ? p.base : R(1)) : base;
    p.offset_0 = is_near ? p.offset_0 / p.base : R(1);
    p.offset_1 = is_near ? r_after(p.offset_1, light_finite(p.offset_0)) / p.base : R(1);
    p.offset_2 = is_near ? r_after(p.offset_2, light_finite(p.offset_1)) / p.base : R(1);
    p.offset_3 = is_near ? r_after(p.offset_3, light_finite(p.offset_2)) / p.base : R(1);
    return p;
}

/* The same for one receiver. */
GRADUS_FN real light_tree_path(GRADUS_GLOBAL const uint *nodes, uint levels, uint unit, uint leaf,
                               light_receiver receiver) {
    light_receivers r;
    r.base = r.offset_0 = r.offset_1 = r.offset_2 = r.offset_3 = receiver;
    return light_tree_paths(nodes, levels, unit, leaf, r, 1, R(1), 0).base;
}

GRADUS_LIB_END
#endif
#endif
