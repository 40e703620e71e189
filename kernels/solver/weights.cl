/* The weights of the equations: from what is missing, from variances, and from the residuals (for the L1 norm). */
#include "kernels/lib/ordered.h"
#include "kernels/solver/grid.h"

/* A variance below zero, or one that is missing, tells nothing: its equation is left out. */
GRADUS_FN real by_variance(real variance, real scale, real largest) {
    return variance < R(0) ? R(0) : scale > R(0) ? scale / (variance + scale / largest) : R(1);
}

GRADUS_FN real together(real sum, real variance) { return sum < R(0) || variance < R(0) ? R(-1) : sum + variance; }

/* The base weights: 0 for what is missing, else 1 or by inverse variance. `variance_plane`: from a channel's variances
 * to the next; 0 where all share one. */
SOLVE base_weights(GRID, uint weight_plane, uint variance_plane, uint by_variances, real gradient_variance_scale,
                   real primal_variance_scale, real largest_weight, __global const real *valid_primal,
                   __global const real *valid_dx, __global const real *valid_dy, __global const real *primal_variance,
                   __global const real *dx_variance, __global const real *dy_variance, __global real *base_x,
                   __global real *base_y, __global real *base_data) {
    SOLVER_PLACE
    const size_t at = GRID_AT(0, x, y), to = channel * weight_plane + at;
    real wx = R(1), wy = R(1), wd = R(1);
    if (by_variances) {
        /* One weight for all channels goes by the mean of their variances. */
        const size_t first = SOLVER_WEIGHT_PLANES > 1 ? channel : 0, count = SOLVER_CHANNELS / SOLVER_WEIGHT_PLANES;
        const real share = R(1) / count;
        real vx = R(0), vy = R(0), vd = R(0);
        for (size_t c = first; c < first + count; ++c) {
            vx = together(vx, share * dx_variance[c * variance_plane + at]);
            vy = together(vy, share * dy_variance[c * variance_plane + at]);
            vd = together(vd, share * primal_variance[c * variance_plane + at]);
        }
        wx = by_variance(vx, gradient_variance_scale, largest_weight);
        wy = by_variance(vy, gradient_variance_scale, largest_weight);
        wd = by_variance(vd, primal_variance_scale, largest_weight);
    }
    base_x[to] = valid_dx[at] * wx;
    base_y[to] = valid_dy[at] * wy;
    base_data[to] = valid_primal[at] * wd;
}

/* The weights of the L2 norm: those of the data term times alpha^2. */
SOLVE least_squares_weights(GRID, uint weight_plane, real alpha, __global const real *base_x,
                            __global const real *base_y, __global const real *base_data, __global real *weight_x,
                            __global real *weight_y, __global real *weight_data) {
    SOLVER_PLACE
    const size_t at = channel * weight_plane + GRID_AT(0, x, y);
    weight_x[at] = base_x[at];
    weight_y[at] = base_y[at];
    weight_data[at] = alpha * alpha * base_data[at];
}

/* |Gx - Dx I|, |Gy - Dy I| and |I - I0| over the channels that share a weight. */
typedef struct {
    real x, y, data;
    GRADUS_NOT_IN_REGISTERS
} residual_norms;

/* Zero, computed after a norm: three alike sums side by side would be joined into short vectors
 * (kernels/lib/ordered.h).
 */
#define AFTER(norm) r_after(R(0), r_min(norm, R(1)))
GRADUS_FN residual_norms norms_at(__global const real *gradient_x, __global const real *gradient_y,
                                  __global const real *u, size_t at, uint row, size_t plane) {
    residual_norms n;
    real sum = R(0);
#pragma unroll
    for (uint c = 0; c < CHANNELS_TOGETHER; ++c) {
        const size_t i = at + c * plane;
        const real e = gradient_x[i] - (u[i + 1] - u[i]);
        sum += e * e;
    }
    n.x = r_sqrt(sum);
    sum = AFTER(n.x);
#pragma unroll
    for (uint c = 0; c < CHANNELS_TOGETHER; ++c) {
        const size_t i = at + c * plane;
        const real e = gradient_y[i] - (u[i + row] - u[i]);
        sum += e * e;
    }
    n.y = r_sqrt(sum);
    sum = AFTER(n.y);
#pragma unroll
    for (uint c = 0; c < CHANNELS_TOGETHER; ++c)
        sum += u[at + c * plane] * u[at + c * plane];
    n.data = r_sqrt(sum);
    return n;
}

/* The parts of the sums over the edges of |residual|^(1/4), and of the base weights. */
SOLVE residual_scale(GRID, uint weight_plane, uint partials, __global const real *gradient_x,
                     __global const real *gradient_y, __global const real *u, __global const real *base_x,
                     __global const real *base_y, __global real *partial) {
    SOLVER_PLACE
    const size_t w = channel * weight_plane + GRID_AT(0, x, y);
    const residual_norms n = norms_at(gradient_x, gradient_y, u, GRID_AT(FIRST_CHANNEL, x, y), row, plane);
    const size_t part = channel * partials + tile * SOLVER_TILE + item;
    partial[part] = base_x[w] * r_sqrt(r_sqrt(n.x)) + base_y[w] * r_sqrt(r_sqrt(n.y));
    partial[SOLVER_WEIGHT_PLANES * partials + part] = base_x[w] + base_y[w];
}

/* Weights with which a least-squares step minimises the L1 norm: base scale / (|residual| + regularisation)
 * (iteratively reweighted least squares; Daubechies et al. 2010). Also the parts of two sums: the norm, and the norm
 * with each term cut at `cut`. */
SOLVE reweight(GRID, uint weight_plane, uint partials, real alpha, real scale, real regularisation, real cut,
               __global const real *gradient_x, __global const real *gradient_y, __global const real *u,
               __global const real *base_x, __global const real *base_y, __global const real *base_data,
               __global real *weight_x, __global real *weight_y, __global real *weight_data, __global real *partial) {
    SOLVER_PLACE
    const size_t w = channel * weight_plane + GRID_AT(0, x, y);
    const residual_norms n = norms_at(gradient_x, gradient_y, u, GRID_AT(FIRST_CHANNEL, x, y), row, plane);
    weight_x[w] = base_x[w] * scale / (n.x + regularisation);
    weight_y[w] = base_y[w] * scale / (n.y + regularisation);
    weight_data[w] = alpha * base_data[w] * scale / (n.data + regularisation);
    const size_t part = channel * partials + tile * SOLVER_TILE + item;
    partial[part] = (base_x[w] * n.x + base_y[w] * n.y) + alpha * base_data[w] * n.data;
    partial[SOLVER_WEIGHT_PLANES * partials + part] =
        (base_x[w] * r_min(n.x, cut) + base_y[w] * r_min(n.y, cut)) + alpha * base_data[w] * r_min(n.data, cut);
}

/* The parts of the squared norm that the current weights give. */
SOLVE squared_norm(GRID, WEIGHTS_OF_DIAGONAL, uint partials, __global const real *gradient_x,
                   __global const real *gradient_y, __global const real *u, __global real *partial) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const cell_weights c = CELL(x, y);
    const real here = u[at];
    const real ex = gradient_x[at] - (u[at + 1] - here), ey = gradient_y[at] - (u[at + row] - here);
    partial[SOLVER_PARTIAL(0)] = (c.right * ex * ex + c.down * ey * ey) + c.data * here * here;
}

/* u += factor (u - previous), and previous = what u was. */
SOLVE extrapolate(GRID, real factor, __global real *u, __global real *previous) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const real now = u[at];
    u[at] = now + factor * (now - previous[at]);
    previous[at] = now;
}

/* valid = 1 where an equation is left that holds the pixel. That of its own data does even where alpha is 0, which
 * leaves nothing of it on the diagonal. */
SOLVE mark_held(GRID, uint weight_plane, uint partials, __global const real *inverse_diagonal,
                __global const real *base_data, __global real *valid, __global real *partial) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    bool held = true;
    for (size_t c = 0; c < SOLVER_WEIGHT_PLANES; ++c)
        held = held && inverse_diagonal[c * weight_plane + at] + base_data[c * weight_plane + at] > R(0);
    valid[at] = held ? R(1) : R(0);
    partial[tile * SOLVER_TILE + item] = x < width && y < height && !held ? R(1) : R(0);
}
