// AVX2 with fused multiply-add, in intrinsics: rows of four control points, one pass a point, no call, no check of an index.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "floor.hpp"

#ifdef __AVX2__

#include <immintrin.h>

#include <cstdint>

namespace bench {

namespace {

constexpr std::size_t BLOCK = 256;

struct Constants {
    __m256d lower, per_cell, n_cells, last_cell;
    std::size_t strides[2];
    const double *control_points;
};

// Three numbers and a 0.
__m256d three(double x, double y, double z) { return _mm256_set_pd(0, z, y, x); }

__m256d load_point(const double *p) { return _mm256_set_pd(0, p[2], p[1], p[0]); }

// Whether all coordinates are at most 1e150 in size; a NaN is not.
bool are_served(const double *points, std::size_t n) {
    const __m256d sign = _mm256_set1_pd(-0.0), largest = _mm256_set1_pd(1e150);
    __m256d wrong = _mm256_setzero_pd();
    std::size_t i = 0;
    for (; i + 4 <= 3 * n; i += 4)
        wrong = _mm256_or_pd(wrong, _mm256_cmp_pd(_mm256_andnot_pd(sign, _mm256_loadu_pd(points + i)), largest, _CMP_NLE_UQ));
    bool bad = _mm256_movemask_pd(wrong) != 0;
    for (; i < 3 * n; ++i) bad |= !(points[i] <= 1e150 && points[i] >= -1e150);
    return !bad;
}

// The four basis functions of a cell, or a derivative of theirs, at u: a polynomial in u, by Horner.
template <int ORDER> __m256d along(__m256d u) {
    const double s = 1.0 / 6.0;
    if (ORDER == 0) {
        const __m256d c3 = _mm256_set_pd(s, -0.5, 0.5, -s), c2 = _mm256_set_pd(0, 0.5, -1, 0.5);
        const __m256d c1 = _mm256_set_pd(0, 0.5, 0, -0.5), c0 = _mm256_set_pd(0, s, 4 * s, s);
        return _mm256_fmadd_pd(_mm256_fmadd_pd(_mm256_fmadd_pd(c3, u, c2), u, c1), u, c0);
    }
    if (ORDER == 1) {
        const __m256d c2 = _mm256_set_pd(0.5, -1.5, 1.5, -0.5), c1 = _mm256_set_pd(0, 1, -2, 1), c0 = _mm256_set_pd(0, 0.5, 0, -0.5);
        return _mm256_fmadd_pd(_mm256_fmadd_pd(c2, u, c1), u, c0);
    }
    return _mm256_fmadd_pd(_mm256_set_pd(1, -3, 3, -1), u, _mm256_set_pd(0, 1, -2, 1));
}

// Entry K four times.
template <int K> __m256d lane(__m256d x) { return _mm256_permute4x64_pd(x, 0x55 * K); }

// The sums of four vectors' entries.
__m256d sums(__m256d a, __m256d b, __m256d c, __m256d d) {
    const __m256d ab = _mm256_hadd_pd(a, b), cd = _mm256_hadd_pd(c, d);
    return _mm256_add_pd(_mm256_permute2f128_pd(ab, cd, 0x21), _mm256_blend_pd(ab, cd, 0xc));
}

// Derivatives, none to two, along x and y.
struct Sums {
    __m256d v, vx, vy, vxx, vxy, vyy;
};

struct LayerSums {
    __m256d r, ry, ryy;
};

template <int ORDER, int J> inline void add_row(const double *c, const __m256d (&wy)[3], LayerSums &sum) {
    const __m256d row = _mm256_loadu_pd(c);
    sum.r = _mm256_fmadd_pd(lane<J>(wy[0]), row, sum.r);
    if (ORDER >= 1) sum.ry = _mm256_fmadd_pd(lane<J>(wy[1]), row, sum.ry);
    if (ORDER >= 2) sum.ryy = _mm256_fmadd_pd(lane<J>(wy[2]), row, sum.ryy);
}

template <int ORDER, int I>
inline void add_layer(const double *c, std::size_t stride, const __m256d (&wx)[3], const __m256d (&wy)[3], Sums &sum) {
    LayerSums layer = {_mm256_setzero_pd(), _mm256_setzero_pd(), _mm256_setzero_pd()};
    add_row<ORDER, 0>(c, wy, layer);
    add_row<ORDER, 1>(c + stride, wy, layer);
    add_row<ORDER, 2>(c + 2 * stride, wy, layer);
    add_row<ORDER, 3>(c + 3 * stride, wy, layer);
    const __m256d w = lane<I>(wx[0]), dw = lane<I>(wx[1]);
    sum.v = _mm256_fmadd_pd(w, layer.r, sum.v);
    if (ORDER >= 1) {
        sum.vx = _mm256_fmadd_pd(dw, layer.r, sum.vx);
        sum.vy = _mm256_fmadd_pd(w, layer.ry, sum.vy);
    }
    if (ORDER >= 2) {
        sum.vxx = _mm256_fmadd_pd(lane<I>(wx[2]), layer.r, sum.vxx);
        sum.vxy = _mm256_fmadd_pd(dw, layer.ry, sum.vxy);
        sum.vyy = _mm256_fmadd_pd(w, layer.ryy, sum.vyy);
    }
}

template <int ORDER>
void eval_block(const Constants &k, const double *points, std::size_t n, double *values, double *gradients, double *hessians) {
    const __m256d zero = _mm256_setzero_pd();
    for (std::size_t p = 0; p < n; ++p) {
        __m256d xi = _mm256_mul_pd(_mm256_sub_pd(load_point(points + 3 * p), k.lower), k.per_cell);
        const __m256d inside = _mm256_and_pd(_mm256_cmp_pd(xi, zero, _CMP_GE_OQ), _mm256_cmp_pd(xi, k.n_cells, _CMP_LE_OQ));
        if (__builtin_expect(_mm256_movemask_pd(inside) != 0xf, 0)) xi = _mm256_min_pd(_mm256_max_pd(xi, zero), k.n_cells);
        const __m128i cell = _mm256_cvttpd_epi32(_mm256_min_pd(xi, k.last_cell));
        const __m256d u = _mm256_sub_pd(xi, _mm256_cvtepi32_pd(cell));
        const std::size_t s0 = k.strides[0], s1 = k.strides[1];
        const double *c = k.control_points + static_cast<std::uint32_t>(_mm_extract_epi32(cell, 0)) * s0 +
                          static_cast<std::uint32_t>(_mm_extract_epi32(cell, 1)) * s1 +
                          static_cast<std::uint32_t>(_mm_extract_epi32(cell, 2));
        const __m256d ux = _mm256_permute4x64_pd(u, 0x00), uy = _mm256_permute4x64_pd(u, 0x55), uz = _mm256_permute4x64_pd(u, 0xaa);
        const __m256d wx[3] = {along<0>(ux), ORDER >= 1 ? along<1>(ux) : zero, ORDER >= 2 ? along<2>(ux) : zero};
        const __m256d wy[3] = {along<0>(uy), ORDER >= 1 ? along<1>(uy) : zero, ORDER >= 2 ? along<2>(uy) : zero};
        Sums sum = {zero, zero, zero, zero, zero, zero};
        add_layer<ORDER, 0>(c, s1, wx, wy, sum);
        add_layer<ORDER, 1>(c + s0, s1, wx, wy, sum);
        add_layer<ORDER, 2>(c + 2 * s0, s1, wx, wy, sum);
        add_layer<ORDER, 3>(c + 3 * s0, s1, wx, wy, sum);
        const auto [v, vx, vy, vxx, vxy, vyy] = sum;
        const __m256d z = along<0>(uz);
        if (ORDER == 0) {
            const __m256d product = _mm256_mul_pd(v, z);
            const __m128d half = _mm_add_pd(_mm256_castpd256_pd128(product), _mm256_extractf128_pd(product, 1));
            values[p] = _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
            continue;
        }
        const __m256d dz = along<1>(uz);
        alignas(32) double first[4], per_cell[4];
        _mm256_store_pd(first, sums(_mm256_mul_pd(vx, z), _mm256_mul_pd(vy, z), _mm256_mul_pd(v, dz), _mm256_mul_pd(v, z)));
        _mm256_store_pd(per_cell, k.per_cell);
        values[p] = first[3];
        for (int a = 0; a < 3; ++a) gradients[3 * p + a] = first[a] * per_cell[a];
        if (ORDER == 1) continue;
        const __m256d ddz = along<2>(uz);
        alignas(32) double left[4], right[4];
        _mm256_store_pd(left, sums(_mm256_mul_pd(vxx, z), _mm256_mul_pd(vxy, z), _mm256_mul_pd(vx, dz), _mm256_mul_pd(vyy, z)));
        _mm256_store_pd(right, sums(_mm256_mul_pd(vy, dz), _mm256_mul_pd(v, ddz), zero, zero));
        double *h = hessians + 6 * p;
        h[0] = left[0] * (per_cell[0] * per_cell[0]);
        h[1] = left[1] * (per_cell[0] * per_cell[1]);
        h[2] = left[2] * (per_cell[0] * per_cell[2]);
        h[3] = left[3] * (per_cell[1] * per_cell[1]);
        h[4] = right[0] * (per_cell[1] * per_cell[2]);
        h[5] = right[1] * (per_cell[2] * per_cell[2]);
    }
}

}  // namespace

bool has_floor() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

std::size_t floor_eval(const FloorField &f, const double *points, std::size_t n, double *values, double *gradients,
                       double *hessians) {
    const double cells[3] = {f.counts[0] - 3.0, f.counts[1] - 3.0, f.counts[2] - 3.0};
    const Constants k = {three(f.lower[0], f.lower[1], f.lower[2]),
                         three(1 / f.cell[0], 1 / f.cell[1], 1 / f.cell[2]),
                         three(cells[0], cells[1], cells[2]),
                         three(cells[0] - 1, cells[1] - 1, cells[2] - 1),
                         {f.counts[1] * f.counts[2], f.counts[2]},
                         f.control_points};
    for (std::size_t first = 0; first < n; first += BLOCK) {
        const std::size_t m = n - first < BLOCK ? n - first : BLOCK;
        if (!are_served(points + 3 * first, m)) return first;
        const double *block = points + 3 * first;
        if (hessians)
            eval_block<2>(k, block, m, values + first, gradients + 3 * first, hessians + 6 * first);
        else if (gradients)
            eval_block<1>(k, block, m, values + first, gradients + 3 * first, nullptr);
        else
            eval_block<0>(k, block, m, values + first, nullptr, nullptr);
    }
    return n;
}

}  // namespace bench

#else

namespace bench {

bool has_floor() { return false; }

std::size_t floor_eval(const FloorField &, const double *, std::size_t, double *, double *, double *) { return 0; }

}  // namespace bench

#endif
