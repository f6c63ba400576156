//! The yardstick: the same two pair sums and a search, written plainly with AVX-512 intrinsics and nothing around them.
//!
//! Single precision, 195 112 jittered lattice particles, columns instead of records, flat lists, no boundaries, no laws, one thread. What a
//! step with all its physics reaches of this loop says how much of the machine it uses.

use serde::Serialize;

/// Speed of the bare loop, one core.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BareLoop {
    /// Particles.
    pub particles: usize,
    /// Neighbours a particle has on average.
    pub mean_neighbors: f64,
    /// Nanoseconds of the search, per particle.
    pub search: f64,
    /// Nanoseconds of the velocity gradient, per particle.
    pub gradient: f64,
    /// Nanoseconds of the forces, per particle.
    pub forces: f64,
}

impl BareLoop {
    /// Particle-steps per second with a search every step.
    pub fn particle_steps_per_second(&self) -> f64 {
        1e9 / (self.search + self.gradient + self.forces)
    }

    /// Measures it; `None` where the processor lacks the instructions.
    pub fn measure() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the feature was just detected.
            return Some(unsafe { wide::measure() });
        }
        None
    }
}

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::BareLoop;
    use std::arch::x86_64::*;
    use std::hint::black_box;
    use std::time::Instant;

    const EDGE: usize = 58;
    const SUPPORT: f32 = 2.4;
    const H: f32 = 1.2;
    /// Room for the neighbours of a particle.
    const ROW: usize = 96;
    /// Of so many passes the fastest counts.
    const PASSES: usize = 4;

    /// Columns in cell order with room for one more SIMD vector: position, velocity, six stresses.
    struct Columns {
        x: [Vec<f32>; 3],
        v: [Vec<f32>; 3],
        s: [Vec<f32>; 6],
        starts: Vec<usize>,
        cells: usize,
    }

    fn columns() -> Columns {
        let mut state = 88_172_645_463_325_252_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f32 / (1 << 24) as f32 - 0.5
        };
        let mut points = Vec::with_capacity(EDGE * EDGE * EDGE);
        for i in 0..EDGE * EDGE * EDGE {
            let site = [i / (EDGE * EDGE), i / EDGE % EDGE, i % EDGE];
            points.push(site.map(|c| c as f32 + 0.2 * random()));
        }
        let cells = (EDGE as f32 / SUPPORT) as usize + 3;
        let cell = |p: &[f32; 3]| {
            let [x, y, z] = p.map(|c| ((c + 0.5) / SUPPORT) as usize + 1);
            (x * cells + y) * cells + z
        };
        points.sort_by_key(cell);
        let mut starts = vec![0; cells * cells * cells + 1];
        points.iter().for_each(|p| starts[cell(p) + 1] += 1);
        (1..starts.len()).for_each(|c| starts[c] += starts[c - 1]);
        let column = |value: &mut dyn FnMut(usize) -> f32| {
            let mut column: Vec<f32> = (0..points.len()).map(value).collect();
            column.resize(points.len() + 16, 0.0);
            column
        };
        Columns {
            x: [0, 1, 2].map(|a| column(&mut |i| points[i][a])),
            v: [0; 3].map(|_| column(&mut |_| random())),
            s: [0; 6].map(|_| column(&mut |_| random())),
            starts,
            cells,
        }
    }

    #[target_feature(enable = "avx512f")]
    fn search(c: &Columns, rows: &mut [u32], lengths: &mut [u32]) {
        let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let limit = _mm512_set1_ps(SUPPORT * SUPPORT);
        let n = c.cells;
        for cell in 0..c.starts.len() - 1 {
            if c.starts[cell] == c.starts[cell + 1] {
                continue;
            }
            let mut runs = [(0, 0); 9];
            for (k, run) in runs.iter_mut().enumerate() {
                let other = cell + k / 3 * n * n + k % 3 * n - n * n - n;
                *run = (c.starts[other - 1], c.starts[other + 2]);
            }
            for i in c.starts[cell]..c.starts[cell + 1] {
                let own = [_mm512_set1_ps(c.x[0][i]), _mm512_set1_ps(c.x[1][i]), _mm512_set1_ps(c.x[2][i])];
                let mut count = 0;
                for (first, last) in runs {
                    let mut k = first;
                    while k < last {
                        // SAFETY: columns and rows have room for a SIMD vector behind their last entry.
                        unsafe {
                            let dx = _mm512_sub_ps(own[0], _mm512_loadu_ps(c.x[0].as_ptr().add(k)));
                            let dy = _mm512_sub_ps(own[1], _mm512_loadu_ps(c.x[1].as_ptr().add(k)));
                            let dz = _mm512_sub_ps(own[2], _mm512_loadu_ps(c.x[2].as_ptr().add(k)));
                            let r2 = _mm512_fmadd_ps(dx, dx, _mm512_fmadd_ps(dy, dy, _mm512_mul_ps(dz, dz)));
                            let index = _mm512_add_epi32(_mm512_set1_epi32(k as i32), lanes);
                            let mut near = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(r2, limit)
                                & _mm512_cmpneq_epi32_mask(index, _mm512_set1_epi32(i as i32));
                            if last - k < 16 {
                                near &= (1 << (last - k)) - 1;
                            }
                            let kept = _mm512_maskz_compress_epi32(near, index);
                            _mm512_storeu_si512(rows.as_mut_ptr().add(i * ROW + count).cast(), kept);
                            count += near.count_ones() as usize;
                        }
                        k += 16;
                    }
                }
                lengths[i] = count as u32;
            }
        }
    }

    /// `(1/r) dW/dr` of the cubic spline without its constant.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn slope(r2: __m512) -> __m512 {
        let estimate = _mm512_rsqrt14_ps(_mm512_max_ps(r2, _mm512_set1_ps(1e-12)));
        let half = _mm512_mul_ps(_mm512_set1_ps(0.5), r2);
        let inverse =
            _mm512_mul_ps(estimate, _mm512_fnmadd_ps(_mm512_mul_ps(half, estimate), estimate, _mm512_set1_ps(1.5)));
        let q = _mm512_mul_ps(_mm512_mul_ps(r2, inverse), _mm512_set1_ps(1.0 / H));
        let inner = _mm512_fmadd_ps(q, _mm512_set1_ps(1.5), _mm512_set1_ps(-2.0));
        let rest = _mm512_max_ps(_mm512_sub_ps(_mm512_set1_ps(2.0), q), _mm512_setzero_ps());
        let outer = _mm512_mul_ps(_mm512_mul_ps(_mm512_set1_ps(-0.5 * H), _mm512_mul_ps(rest, rest)), inverse);
        _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(q, _mm512_set1_ps(1.0)), outer, inner)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn dot(a: [__m512; 3], b: [__m512; 3]) -> __m512 {
        _mm512_fmadd_ps(a[0], b[0], _mm512_fmadd_ps(a[1], b[1], _mm512_mul_ps(a[2], b[2])))
    }

    /// One SIMD vector of pairs: distances, kernel slopes, velocity differences, which lanes count, and the indices.
    struct Pairs {
        x: [__m512; 3],
        weight: __m512,
        v: [__m512; 3],
        index: __m512i,
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn pairs(c: &Columns, rows: &[u32], i: usize, at: usize, length: usize) -> Pairs {
        let left = length - at;
        let mask = if left >= 16 { 0xffff } else { (1u16 << left) - 1 };
        // SAFETY: rows have room for a SIMD vector; listed indices are within the columns.
        unsafe {
            let index = _mm512_maskz_loadu_epi32(mask, rows.as_ptr().add(i * ROW + at).cast());
            // Loops, not closures: those would not be compiled for the instructions in use.
            let mut x = [_mm512_setzero_ps(); 3];
            let mut v = x;
            for a in 0..3 {
                x[a] = _mm512_sub_ps(_mm512_set1_ps(c.x[a][i]), _mm512_i32gather_ps::<4>(index, c.x[a].as_ptr()));
                v[a] = _mm512_sub_ps(_mm512_i32gather_ps::<4>(index, c.v[a].as_ptr()), _mm512_set1_ps(c.v[a][i]));
            }
            let r2 = dot(x, x);
            Pairs { x, weight: _mm512_maskz_mov_ps(mask, slope(r2)), v, index }
        }
    }

    #[target_feature(enable = "avx512f")]
    fn gradient(c: &Columns, rows: &[u32], lengths: &[u32], out: &mut [[f32; 9]]) {
        for (i, out) in out.iter_mut().enumerate() {
            let mut sums = [_mm512_setzero_ps(); 9];
            for at in (0..lengths[i] as usize).step_by(16) {
                let p = pairs(c, rows, i, at, lengths[i] as usize);
                for a in 0..3 {
                    let weighted = _mm512_mul_ps(p.v[a], p.weight);
                    for b in 0..3 {
                        sums[3 * a + b] = _mm512_fmadd_ps(weighted, p.x[b], sums[3 * a + b]);
                    }
                }
            }
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = _mm512_reduce_add_ps(sum);
            }
        }
    }

    #[target_feature(enable = "avx512f")]
    fn forces(c: &Columns, rows: &[u32], lengths: &[u32], out: &mut [[f32; 9]]) {
        let zero = _mm512_setzero_ps();
        for (i, out) in out.iter_mut().enumerate() {
            let mut sums = [zero; 4];
            let mut own = [zero; 6];
            for k in 0..6 {
                own[k] = _mm512_set1_ps(c.s[k][i]);
            }
            for at in (0..lengths[i] as usize).step_by(16) {
                let p = pairs(c, rows, i, at, lengths[i] as usize);
                let [x, v] = [p.x, p.v];
                let distance2 = _mm512_add_ps(dot(x, x), _mm512_set1_ps(0.01 * H * H));
                let mu = _mm512_div_ps(_mm512_max_ps(dot(v, x), zero), distance2);
                let viscous = _mm512_fmadd_ps(mu, mu, mu);
                let mut s = own;
                for k in 0..6 {
                    // SAFETY: listed indices are within the columns.
                    s[k] = _mm512_add_ps(own[k], unsafe { _mm512_i32gather_ps::<4>(p.index, c.s[k].as_ptr()) });
                }
                for k in 0..3 {
                    s[k] = _mm512_sub_ps(s[k], viscous);
                }
                let force = [dot([s[0], s[3], s[5]], x), dot([s[3], s[1], s[4]], x), dot([s[5], s[4], s[2]], x)];
                for a in 0..3 {
                    sums[a] = _mm512_fmadd_ps(force[a], p.weight, sums[a]);
                }
                sums[3] = _mm512_fmadd_ps(dot(force, v), p.weight, sums[3]);
            }
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = _mm512_reduce_add_ps(sum);
            }
        }
    }

    #[target_feature(enable = "avx512f")]
    pub(super) fn measure() -> BareLoop {
        let c = columns();
        let n = EDGE * EDGE * EDGE;
        let (mut rows, mut lengths, mut out) = (vec![0; n * ROW + 16], vec![0; n], vec![[0.0; 9]; n]);
        let mut fastest = [f64::INFINITY; 3];
        for _ in 0..PASSES {
            let start = Instant::now();
            search(&c, &mut rows, &mut lengths);
            let searched = Instant::now();
            gradient(&c, &rows, &lengths, &mut out);
            black_box(&out);
            let swept = Instant::now();
            forces(&c, &rows, &lengths, &mut out);
            black_box(&out);
            let times = [searched - start, swept - searched, swept.elapsed()];
            for (fastest, time) in fastest.iter_mut().zip(times) {
                *fastest = fastest.min(time.as_secs_f64() * 1e9 / n as f64);
            }
        }
        let pairs: u64 = lengths.iter().map(|&l| u64::from(l)).sum();
        let [search, gradient, forces] = fastest;
        BareLoop { particles: n, mean_neighbors: pairs as f64 / n as f64, search, gradient, forces }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn the_bare_search_finds_every_pair_and_its_forces_cancel() {
            if !is_x86_feature_detected!("avx512f") {
                return;
            }
            let c = columns();
            let n = EDGE * EDGE * EDGE;
            let (mut rows, mut lengths, mut out) = (vec![0; n * ROW + 16], vec![0; n], vec![[0.0; 9]; n]);
            // SAFETY: the feature was just detected.
            unsafe {
                search(&c, &mut rows, &mut lengths);
                forces(&c, &rows, &lengths, &mut out);
            }
            for i in (0..n).step_by(20_011) {
                let near = |j: &usize| {
                    let d2: f32 = (0..3).map(|a| (c.x[a][i] - c.x[a][*j]).powi(2)).sum();
                    *j != i && d2 < SUPPORT * SUPPORT
                };
                assert_eq!((0..n).filter(near).count() as u32, lengths[i], "particle {i}");
            }
            for a in 0..3 {
                let sum: f64 = out.iter().map(|f| f64::from(f[a])).sum();
                let scale: f64 = out.iter().map(|f| f64::from(f[a].abs())).sum();
                assert!(sum.abs() < 1e-6 * scale, "{sum} of {scale}");
            }
        }
    }
}
