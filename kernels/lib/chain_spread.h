/* What the derivative of a chain y_b ... y_s is used for: the next step of a walk, the generalised geometry term and
 * the Jacobians of shifts (Jakob and Marschner 2012; Hua et al. 2017, eqs. 7 to 10).
 *
 * With all half vectors held, the spread is |d y_s / d omega_b|, area at y_s for a solid angle at y_b. Then
 *     G(y_b ... y_s) = |cos theta_b| / spread,   |d y_b+1 / d y_s| = G(y_b ... y_s) / G(y_b, y_b+1)    (Hua's eq. 8).
 *
 * Chains with glossy vertices. A path is given by u = (omega_b, omega_k of each glossy vertex k): directions at
 * specular ones follow. A shift keeps v = (o_k of each glossy k, y_s) but for the known |d y_s' / d y_s|. D, the
 * derivative of (o of all vertices, y_s) with all positions, is block triangular but for the first column, with blocks
 * C_k = d o_k / d y_k+1 beside the diagonal, so |det D| = |d y_s / d y_b+1| prod |C_k|. With o of the specular vertices
 * held, du / dv is the minor of D^-1 that Hua's section 4.2 describes; by Jacobi's theorem it is the complementary
 * minor of D over det D, and that is block triangular, prod |C_k| over specular k. So |dv / du| = |d y_s / d y_b+1|
 * prod over glossy k of |C_k| by areas, and by solid angles, for which each C_k becomes d o_k / d omega_k = cos(m_k,
 * n_k) / turn_k, |dv / du| = spread prod over glossy k of cos(m_k, n_k) / turn_k,    turn = |d omega_o / d m|, wi held.
 * Shifts keep the half vectors, so the cosines are the same before and after. */
#ifndef GRADUS_LIB_CHAIN_SPREAD_H
#define GRADUS_LIB_CHAIN_SPREAD_H
#include "kernels/lib/ray_differential.h"

GRADUS_LIB_BEGIN

/* |d y_s / d omega_b| on a surface of that normal, from the changes of the point where the ray in `direction` meets
 * any plane: what crosses the ray is the same for all planes. */
GRADUS_FN real chain_spread(vec3 step_s, vec3 step_t, vec3 direction, vec3 normal) {
    return r_abs(v3_dot(v3_cross(step_s, step_t), direction)) / r_max(r_abs(v3_dot(normal, direction)), R(1e-9));
}

/* G(y_b ... y_s); |cos theta_b| against the normal at y_b. */
GRADUS_FN real generalized_geometry_term(real spread, real cosine) { return cosine / r_max(spread, R(1e-30)); }

/* |d (omega_b', omega' of glossy vertices) / d (omega_b, omega of glossy vertices)| over |d y_s' / d y_s| for a shift
 * that holds half vectors; turns are products over the glossy vertices. 0 where a value is 0 or not known. */
GRADUS_FN real chain_jacobian(real base_spread, real base_turn, real spread, real turn) {
    const int is_valid = (base_spread > R(0)) & (base_turn > R(0)) & (spread > R(0)) & (turn > R(0));
    const real jacobian = base_spread / (is_valid ? spread : R(1)) * (turn / (is_valid ? base_turn : R(1)));
    return is_valid ? jacobian : R(0);
}

/* Of the first vertex, so that by the derivative the end moves by `wanted`: both ends are within the plane of that
 * normal, first_s and first_t are the first vertex's changes, end_s and end_t the end's. */
typedef struct {
    vec3 step;
    int is_valid;
    GRADUS_NOT_IN_REGISTERS
} chain_step;

GRADUS_FN chain_step chain_step_for(vec3 wanted, vec3 end_s, vec3 end_t, vec3 plane, vec3 first_s, vec3 first_t) {
    const real determinant = v3_dot(v3_cross(end_s, end_t), plane);
    /* Relative to what it is a difference of: below that it is rounding, at a caustic. */
    const real scale = v3_dot(end_s, end_s) + v3_dot(end_t, end_t);
    chain_step s;
    s.is_valid = r_abs(determinant) > R(1e-6) * scale;
    const real inverse = R(1) / (s.is_valid ? determinant : R(1));
    const real along_s = v3_dot(v3_cross(wanted, end_t), plane) * inverse;
    const real along_t = r_after(v3_dot(v3_cross(end_s, wanted), plane), along_s) * inverse;
    s.step = v3_mad(v3_scale(first_s, along_s), along_t, first_t);
    return s;
}

/* The unit normal of the plane through `end` and `target` in which a walk's end moves, the same for the walk back up to
 * its sign: that of both surfaces together, less its part along the way. Ways much shorter than `floor`, what rounding
 * does to positions, have no direction. Zero where there is none. */
GRADUS_FN vec3 walk_plane(vec3 end, vec3 end_normal, vec3 target, vec3 target_normal, real floor) {
    const vec3 way = v3_sub(target, end);
    const real way_squared = v3_dot(way, way);
    const real alike = r_copysign1(v3_dot(end_normal, target_normal));
    const vec3 sum = v3_mad(end_normal, alike, target_normal);
    const real along = v3_dot(sum, way) / r_max(way_squared + floor * floor, R(1e-36));
    const vec3 plane = v3_mad(sum, -along, way);
    const real squared = v3_dot(plane, plane);
    const real scale = squared > R(1e-4) ? R(1) / r_sqrt(squared > R(0) ? squared : R(1)) : R(0);
    return v3_scale(plane, scale);
}

GRADUS_LIB_END
#endif
