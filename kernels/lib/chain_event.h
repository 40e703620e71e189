/* What a vertex of a chain does, so that its new place can do the same: mirror or refract at a half vector that is held
 * in the vertex's own frame (Jakob and Marschner 2012; Kaplanyan et al. 2014), and how the outgoing direction changes.
 *
 * The frame is that of kernels/lib/frame.h around the shading normal n, whatever the material. A half vector m is a
 * unit vector on n's side, and n itself at a specular vertex. Index ratios are as in kernels/lib/shift_half_vector.h,
 * whose limits hold: with m turned to wi's side, eta = (index on wo's side) / (index on wi's side) and c = wi . m, wo =
 * along m - wi / eta,  along = 2 c, or (c - root) / eta with root^2 = c^2 + (eta - 1)(eta + 1); d along = 2 dc, or
 * -along / root dc;  |d wo / d m| = along^2 / |wo . m|. Nothing is divided by a half vector's length, so a specular
 * vertex may have equal indices on both sides. */
#ifndef GRADUS_LIB_CHAIN_EVENT_H
#define GRADUS_LIB_CHAIN_EVENT_H
#include "kernels/lib/frame.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/shift_half_vector.h"

GRADUS_LIB_BEGIN

/* The half vector of a glossy vertex, in its frame. */
typedef struct {
    real x, y;
    int is_valid; /* 0: there is none on wi's side, or it is not well known */
    GRADUS_NOT_IN_REGISTERS
} half_vector;

/* wi, wo: world, unit, away from the surface. */
GRADUS_FN half_vector half_vector_of(vec3 wi, vec3 wo, vec3 n, int reflects, real ior) {
    const real side = r_copysign1(v3_dot(wi, n));
    const real eta = reflects ? R(1) : shift_eta(ior, side);
    const real contrast = (eta - R(1)) * (eta + R(1));
    const vec3 h = v3_mad(wi, eta, wo);
    const real length_squared = v3_dot(h, h);
    const real towards_n = v3_dot(h, n);
    const real scale = r_copysign1(towards_n) / r_sqrt(r_max(length_squared, R(1e-24)));
    const frame f = frame_from_normal(n);
    half_vector m;
    m.x = v3_dot(f.s, h) * scale;
    m.y = v3_dot(f.t, h) * scale;
    m.is_valid = (length_squared > R(1e-12)) & (towards_n != R(0)) &
                 (reflects | ((r_abs(contrast) > GRADUS_HALF_VECTOR_SAME_INDEX) & shift_ior_is_valid(ior)));
    return m;
}

typedef struct {
    vec3 wi, m;        /* m on wi's side */
    real side;         /* 1 where that is n's */
    real along, slope; /* slope: d along / d c */
    real inverse_eta;
    vec3 wo;   /* unit; meaningless where the event is not valid */
    real turn; /* |d omega_o / d m| with wi held */
    int is_valid;
} vertex_event;

/* half_x, half_y: m in the frame of n. Not valid where wi is on the other side of n than `behind` says (1: not n's), wo
 * would be on the wrong side of n, reflection is total, or a direction grazes m: GRADUS_HALF_VECTOR_GRAZING_*. */
GRADUS_FN vertex_event vertex_event_of(vec3 wi, vec3 n, real half_x, real half_y, int reflects, int behind, real ior) {
    vertex_event e;
    const frame f = frame_from_normal(n);
    const real half_z = r_sqrt(r_max(R(1) - half_x * half_x - half_y * half_y, R(0)));
    const vec3 m = frame_to_world(f, v3(half_x, half_y, half_z));
    e.side = behind ? R(-1) : R(1);
    e.m = v3_scale(m, e.side);
    e.wi = wi;
    const real eta = reflects ? R(1) : shift_eta(ior, e.side);
    const real contrast = (eta - R(1)) * (eta + R(1));
    e.inverse_eta = R(1) / eta;
    const real cosine = v3_dot(wi, e.m);
    const real root_squared = cosine * cosine + contrast;
    const real root = r_sqrt(r_max(root_squared, R(0)));
    const real sum = r_max(cosine + root, R(1e-3));
    e.along = reflects ? R(2) * cosine : -contrast * e.inverse_eta / sum;
    e.wo = v3_sub(v3_scale(e.m, e.along), v3_scale(wi, e.inverse_eta));
    const real cosine_out = reflects ? cosine : root * e.inverse_eta;
    e.turn = e.along * e.along / r_max(cosine_out, R(1e-6));
    /* r_after: divisions of like terms would be packed (kernels/lib/ordered.h). */
    e.slope = reflects ? R(2) : r_after(-e.along, e.turn) / r_max(root, R(1e-3));
    const real least = reflects ? GRADUS_HALF_VECTOR_GRAZING_REFLECTED : GRADUS_HALF_VECTOR_GRAZING_REFRACTED;
    const real in_side = v3_dot(wi, n) * e.side, out_side = r_after(v3_dot(e.wo, n), in_side) * e.side;
    const real smallest = r_min(cosine, cosine_out); /* one comparison: two would be packed */
    e.is_valid = (in_side > R(0)) & (reflects ? out_side > R(0) : out_side < R(0)) & (smallest > least) &
                 (reflects | shift_ior_is_valid(ior));
    return e;
}

/* The change of frame_from_normal's s, t and n times x, y and z for a change dn of the normal. */
GRADUS_FN vec3 frame_change(vec3 n, vec3 dn, real x, real y, real z) {
    const real sign = r_copysign1(n.z);
    const real a = R(-1) / (sign + n.z);
    const real da = a * a * dn.z;
    const real db = (dn.x * n.y + n.x * dn.y) * a + n.x * n.y * da;
    const vec3 ds = v3(sign * (R(2) * n.x * dn.x * a + n.x * n.x * da), sign * db, -sign * dn.x);
    const vec3 dt = v3(db, R(2) * n.y * dn.y * a + n.y * n.y * da, -dn.y);
    return v3_mad(v3_mad(v3_scale(ds, x), y, dt), z, dn);
}

/* The change of wo, with the half vector held in the frame, for changes of the direction in which light arrives (-wi)
 * and of the normal. */
GRADUS_FN vec3 vertex_event_change(vertex_event e, vec3 n, real half_x, real half_y, vec3 arriving_change, vec3 dn) {
    const real half_z = r_sqrt(r_max(R(1) - half_x * half_x - half_y * half_y, R(0)));
    const vec3 dm = v3_scale(frame_change(n, dn, half_x, half_y, half_z), e.side);
    const real dc = v3_dot(e.wi, dm) - v3_dot(arriving_change, e.m);
    return v3_mad(v3_mad(v3_scale(dm, e.along), e.slope * dc, e.m), e.inverse_eta, arriving_change);
}

GRADUS_LIB_END
#endif
