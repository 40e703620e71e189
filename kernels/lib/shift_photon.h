/* The shift of a photon to a neighbour's gather point (Hua et al. 2017, section 4.2).
 *
 * Base and offset gather point have discs of radius r and r' in their tangent planes, and photons near a disc count.
 * One that counts at both stays where it is. The others are mirrored: from the part of the base's disc that the
 * offset's does not cover to the part of the offset's that the base's does not. On a plane that is exact, and all
 * photons arrive. (The paper moves every photon by the difference of the gather points, its eq. 5. Then a photon that
 * two neighbours share becomes another one, whose way must be traced; here only what tells the two discs apart is.)
 *
 * The map between the planes, of vectors v from the gather point in the plane of n to v' in that of n': mirrored by
 * b = (n + n') / |n + n'|, which exchanges the planes, and by e', which lies in the plane of n' and points to the other
 * gather point, then scaled by r' / r. With n and n', and the gather points, exchanged it is its own inverse, since b
 * is the same and the mirror by b takes e to e'. Areas grow by (r' / r)^2, and the kernel 1 / (pi r^2) falls as much:
 * so a pixel keeps the radius that it has without shifts, and differences are exactly those of the primal image.
 *
 * Photons are not in the planes. Where a photon's last vertex stays, a, the ray from there through the photon y meets
 * the base's plane at p; that goes to p'; and the offset photon y' is what the ray from a through p' meets first. Back,
 * the ray through y' meets the offset's plane at p'. (In the paper's eq. 5 the photon itself is moved, and the way back
 * comes to another place where the surface is curved.) By solid angle at a, with D = p - a,
 *     d omega = |n.D| / |D|^3 dp,   so   |d omega' / d omega| = (r' / r)^2 (|n'.D'| / |D'|^3) / (|n.D| / |D|^3).
 * Where the last vertex moves with the photon, at the end of a chain, the normal of the plane takes the place of the
 * ray. Then p is the foot of y, y' is on the line through p' along n', and with the photons' normals m and m'
 *     |dy' / dy| = (r' / r)^2 |m.n| / |m'.n'|. */
#ifndef GRADUS_LIB_SHIFT_PHOTON_H
#define GRADUS_LIB_SHIFT_PHOTON_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* The shift fails where a ray meets a tangent plane at a smaller cosine, */
#define GRADUS_PHOTON_GRAZING R(1e-2)
/* or where the cosine between the normals of the gather points is not above this: the mirror is lost as they become
 * opposite. */
#define GRADUS_PHOTON_LEAST_TURN R(-0.9)
/* The least cosine between the normals of gather point and photon: walls at right angles are two surfaces, a mesh of a
 * few hundred triangles is one. */
#define GRADUS_PHOTON_LEAST_FACING R(0.1)

/* Position, geometric normal (unit, on the side that gathers) and radius, world frame and units. */
typedef struct {
    vec3 position, normal;
    real radius;
    GRADUS_NOT_IN_REGISTERS
} photon_disc;

GRADUS_FN photon_disc photon_disc_of(vec3 position, vec3 normal, real radius) {
    photon_disc disc;
    disc.position = position;
    disc.normal = normal;
    disc.radius = radius;
    return disc;
}

/* Whether a photon counts at a gather point: within the radius, and on a surface that faces the same way. */
GRADUS_FN int photon_counts(photon_disc disc, vec3 photon, vec3 photon_normal) {
    const vec3 apart = v3_sub(photon, disc.position);
    return (v3_dot(apart, apart) <= disc.radius * disc.radius) &
           (v3_dot(photon_normal, disc.normal) > GRADUS_PHOTON_LEAST_FACING);
}

/* v, in the base's plane, as a vector in the offset's. is_valid: 0 where the normals are opposite. */
GRADUS_FN vec3 photon_mirrored(vec3 v, photon_disc base, photon_disc offset, int *is_valid) {
    const real turn = v3_dot(base.normal, offset.normal);
    *is_valid = turn > GRADUS_PHOTON_LEAST_TURN;
    const vec3 sum = v3_add(base.normal, offset.normal);
    const real inverse_squared = R(1) / r_max(R(2) + R(2) * turn, R(0.1));
    const vec3 between = v3_sub(offset.position, base.position);
    /* Both by the mirror b; `along` in its plane is the same for the way back, but for its sign. */
    const vec3 crossed = v3_mad(v, R(-2) * inverse_squared * v3_dot(v, sum), sum);
    const vec3 along = v3_mad(between, -inverse_squared * v3_dot(between, sum), sum);
    const vec3 line = v3_mad(along, -v3_dot(along, offset.normal), offset.normal);
    const real line_squared = v3_dot(line, line);
    const vec3 mirrored = v3_mad(crossed, R(-2) * v3_dot(crossed, line) / r_max(line_squared, R(1e-30)), line);
    return v3_scale(mirrored, offset.radius / base.radius);
}

typedef struct {
    vec3 target;   /* p': in the offset's plane, world frame */
    real jacobian; /* by solid angle at the last vertex; 0 where the shift fails */
    int is_valid;
    GRADUS_NOT_IN_REGISTERS
} shifted_photon;

/* `from`: where the photon's last ray started; `photon`: where it landed. The offset photon is what the ray from `from`
 * towards `target` meets first, before or beyond it. Fails where a plane is met behind `from` or at a grazing angle,
 * in both directions alike. */
GRADUS_FN shifted_photon photon_shift_from(vec3 from, vec3 photon, photon_disc base, photon_disc offset) {
    const vec3 way = v3_sub(photon, from);
    const vec3 apart = v3_sub(photon, base.position);
    const real across = v3_dot(way, base.normal);
    const real length_squared = v3_dot(way, way), length = r_sqrt(length_squared);
    const real cosine = r_abs(across) / r_max(length, R(1e-30));
    const int meets = cosine > GRADUS_PHOTON_GRAZING;
    /* From the photon on: what is small is not a difference of what is large. */
    const real more = -v3_dot(apart, base.normal) / (meets ? across : R(1));
    const real share = R(1) + more; /* of the way, at p */
    const vec3 in_plane = v3_mad(apart, more, way);
    int is_turned = 0;
    const vec3 moved = photon_mirrored(in_plane, base, offset, &is_turned);
    shifted_photon shifted;
    shifted.target = v3_add(offset.position, moved);
    const vec3 way_offset = v3_sub(shifted.target, from);
    const real across_offset = r_abs(v3_dot(way_offset, offset.normal));
    const real squared_offset = v3_dot(way_offset, way_offset);
    const real length_offset = r_sqrt(squared_offset);
    const real cosine_offset = across_offset / r_max(length_offset, R(1e-30));
    const real scale = offset.radius / base.radius;
    /* |D| = share length, |D'| = length_offset; never a power of a length: it would leave float's range. */
    const real ratio = scale * share * length / r_max(length_offset, R(1e-30));
    shifted.is_valid = meets & (share > R(0)) & is_turned & (cosine_offset > GRADUS_PHOTON_GRAZING);
    const real jacobian = cosine_offset / r_max(cosine, GRADUS_PHOTON_GRAZING) * ratio * ratio;
    shifted.jacobian = shifted.is_valid ? jacobian : R(0);
    return shifted;
}

/* The same for parallel rays along `direction`, a unit vector, from a light at infinity: the Jacobian is by area across
 * them, (r' / r)^2 |n'.w| / |n.w|. */
GRADUS_FN shifted_photon photon_shift_parallel(vec3 direction, vec3 photon, photon_disc base, photon_disc offset) {
    const vec3 apart = v3_sub(photon, base.position);
    const real across = v3_dot(direction, base.normal), cosine = r_abs(across);
    const int meets = cosine > GRADUS_PHOTON_GRAZING;
    const vec3 in_plane = v3_mad(apart, -v3_dot(apart, base.normal) / (meets ? across : R(1)), direction);
    int is_turned = 0;
    const vec3 moved = photon_mirrored(in_plane, base, offset, &is_turned);
    const real cosine_offset = r_abs(v3_dot(direction, offset.normal)), scale = offset.radius / base.radius;
    shifted_photon shifted;
    shifted.target = v3_add(offset.position, moved);
    shifted.is_valid = meets & is_turned & (cosine_offset > GRADUS_PHOTON_GRAZING);
    shifted.jacobian = shifted.is_valid ? scale * scale * cosine_offset / r_max(cosine, GRADUS_PHOTON_GRAZING) : R(0);
    return shifted;
}

/* The same along the normals of the planes, for photons at the end of a chain: `target` is where the line along the
 * offset's normal crosses its plane. The Jacobian, by area on the surfaces, lacks what is only known once the offset
 * photon is: divide by |m'.n'|. `photon_normal`: m. */
GRADUS_FN shifted_photon photon_shift_along_normal(vec3 photon, vec3 photon_normal, photon_disc base,
                                                   photon_disc offset) {
    const vec3 apart = v3_sub(photon, base.position);
    const vec3 in_plane = v3_mad(apart, -v3_dot(apart, base.normal), base.normal);
    shifted_photon shifted;
    const vec3 moved = photon_mirrored(in_plane, base, offset, &shifted.is_valid);
    const real scale = offset.radius / base.radius;
    shifted.target = v3_add(offset.position, moved);
    shifted.jacobian = shifted.is_valid ? scale * scale * r_abs(v3_dot(photon_normal, base.normal)) : R(0);
    return shifted;
}

GRADUS_LIB_END
#endif
