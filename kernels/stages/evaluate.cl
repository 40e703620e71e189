/* evaluate: the BSDF service. Answers the requests of `shift` that concern vertices of one BSDF kind, or of all Dirac
 * kinds: base paths in rows `first` on, plane by plane the lines of `evaluation` from `first_line` on: 0 to 3 light
 * connections of offset paths, 4 to 7 their steps. Requests at vertices of other kinds are left alone. All rows are
 * computed, also those without a request: their answers go nowhere.
 *
 * What has no value asks the tracer nothing. */
#include "kernels/lib/bsdf_evaluate.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/textured_material.h"

STAGE evaluate(uint count, uint unit, uint first, uint first_line, uint stride, uint capacity, uint slots,
               __global const real *path, OWN_VERTEX, STRIP_PLACE, __global const real *offset,
               __global real *evaluation, __global real *link, __global const real *materials
#if TRAIT_APART
               ,
               __global real *offset_ray
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = (size_t)first + i;
    const uint line = first_line + (uint)get_global_id(2), j = line & 3u;
    const int slot = AT_ROW(path, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
    const own_vertex_state own = OWN_STATE(j, row, slot, pixel);
    const uint kind = AT_UINT(own_vertex, kind, own.row);
#if BSDF_IS_DIRAC
    const int is_asked = own.is_own & ((kind & kind_is_dirac) != 0u); /* whichever of them it is */
#else
    const int is_asked = own.is_own & (kind_number(kind) == PASTE(bsdf_kind_, BSDF));
#endif
    const material m = VERTEX_MATERIAL(own_vertex, own.row);
    const vec3 towards = AT_V3(own_vertex, wi, own.row);
    const bsdf_frame place = BSDF_FRAME(own_vertex, own.row, m, towards);
    const frame axes = place.axes;
    const size_t at = (size_t)line * capacity + row;
    const vec3 wo = v3(AT(evaluation, value_r, at), AT(evaluation, value_g, at), AT(evaluation, value_b, at));
    int asks_dirac = 0;
#if BSDF_IS_MIXED
    /* The step takes the lobe that the base path has sampled. */
    asks_dirac = (line >= 4u) & (AT(path, pdf, row) == R(0));
#endif
    const vec3 wo_local = frame_to_local(axes, wo);
    const bsdf_value v =
        MAPPED_VALUE(place, bsdf_evaluate(m, frame_to_local(axes, towards), wo_local, asks_dirac), wo_local);
    /* A light that is not scattered may still be found by BSDF sampling. */
    const int is_nothing = !(v.pdf > R(0)) & (line >= 4u || !(rgb_max(v.value) > R(0)));
    /* What is not asked here is stored as it was: a store behind a condition costs several of these. */
    const rgb value = rgb_select(is_asked, v.value, rgb3(wo.x, wo.y, wo.z));
    SET_RGB(evaluation, value, at, value);
    AT(evaluation, pdf, at) = is_asked ? v.pdf : AT(evaluation, pdf, at);
    const size_t segment = (size_t)line * stride + row;
    AT_UINT(link, open, segment) = is_asked && is_nothing ? 0u : AT_UINT(link, open, segment);
}
