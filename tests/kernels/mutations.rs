//! Mutation tests: shaders with one mistake each, which the comparison with the reference or the check against the Rust
//! side must find.

use std::ops::ControlFlow;

use viewsphere::gpu::reflect;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::{
    ALL, affine_columns, binomial, block_mean, block_sum, brightness_equations, carry, cast, cell_confidence,
    cell_evidence, cell_mean, cells, compare, confidence, corner_response, correct, cubic_warp,
    downsample_flow, expansion_x, expansion_y, expected_slope, fit_weight, gradient_equations,
    keep_expansion, links, local_maxima, looming, luma, misfit, nonlocal, normal_equations,
    normalized_expansion_x, normalized_expansion_y, older_equations, patches, premultiply, pyr_down, remap,
    resample_x, resample_y, residual, robust_equations, rotational_flow, row_maximum, sectors, sensor, shade,
    slope_weights, smoothness, solve, solve_affine, solve_increment, spherical_flow, steadiness,
    structure_tensor, surroundings, sweep, track_points, transport, undistort_map, unweight, upsample, warp,
    weighted_normal_equations, weighted_robust_equations, window_y,
};

use crate::need;
use crate::sides::{Compared, compare_sides};

/// The kernel with one piece of its shader replaced. The piece must occur exactly once.
fn mutant(kernel: &Kernel, from: &str, to: &str) -> Kernel {
    let found = kernel.source.matches(from).count();
    assert_eq!(found, 1, "{}: {from:?} stands in the shader so many times", kernel.name);
    // A kernel's text is static; the texts of a few mutants may live as long.
    Kernel { source: kernel.source.replacen(from, to, 1).leak(), ..*kernel }
}

/// Mistakes that leave a shader valid, so that only its results show them.
#[rustfmt::skip]
const WRONG_RESULTS: &[(&Kernel, &str, &str)] = &[
    (&luma::KERNEL, "19235u", "19236u"),
    (&luma::KERNEL, " + 16384u", ""),
    (&luma::KERNEL, "1.0 / 257.0", "1.0 / 256.0"),
    (&luma::KERNEL, "vec4u(0u, 8u, 16u, 24u)", "vec4u(24u, 16u, 8u, 0u)"),
    (&binomial::KERNEL, "reflect_101(x - 1, n)", "u32(max(x - 1, 0))"),
    (&binomial::KERNEL, "row(x0, i32(y0) - 1)", "row(x0, i32(y0))"),
    (&binomial::KERNEL, "let y = y0 + i;", "let y = y0 + i; if y == 4u { continue; }"),
    (&resample_y::KERNEL, "min(j, params.taps)", "min(j, params.taps - 1u)"),
    (&resample_y::KERNEL, "vec4f(before, w.xyz)", "vec4f(0.0, w.xyz)"),
    (&resample_y::KERNEL, "select(rest, rest - period, rest >= period)", "rest + 1"),
    (&resample_y::KERNEL, "i32(params.taps / 2u)", "i32(params.taps / 2u) + 1"),
    (&resample_x::KERNEL, "min(j, params.taps)", "min(j, params.taps - 1u)"),
    (&resample_x::KERNEL, "vec4f(before, w.xyz)", "vec4f(0.0, w.xyz)"),
    (&resample_x::KERNEL, "id.x >= stride", "id.x >= params.width"),
    (&expansion_y::KERNEL, "w.z * f5 + w.w * f6", "w.z * f5 + w.w * f5"),
    (&expansion_y::KERNEL, "clamp_index(y, params.height)", "reflect_101(y, i32(params.height))"),
    (&expansion_x::KERNEL, "params.inv_xx * m.m_yy", "params.inv_xx * m.m_xx"),
    (&expansion_x::KERNEL, "last >= 1u", "true"),
    (&expansion_x::KERNEL, "params.inv_xy * m.m_xy", "2.0 * params.inv_xy * m.m_xy"),
    (&upsample::KERNEL, "min(left + 1u, vec4u(params.in_width - 1u - 4u * first))", "left"),
    (&upsample::KERNEL, "number >= vec4u(4u)", "number >= vec4u(5u)"),
    (&upsample::KERNEL, "params.scale * mixed", "mixed"),
    (&downsample_flow::KERNEL, "cover.w, i + 1u", "1.0, i + 1u"),
    (&downsample_flow::KERNEL, "all(abs(d) <= vec2f(1e9))", "true"),
    (&normal_equations::KERNEL, "0.14, distance", "0.15, distance"),
    (&normal_equations::KERNEL, "0.4472, distance", "0.45, distance"),
    (&normal_equations::KERNEL, "let far = n - 1u - i", "let far = n - i"),
    (&normal_equations::KERNEL, "whole < vec2f(f32(params.width)", "whole <= vec2f(f32(params.width)"),
    (&normal_equations::KERNEL, "0.5 * (first.quad.w + other.quad.w)", "first.quad.w"),
    (&normal_equations::KERNEL, "place - whole", "place"),
    (&normal_equations::KERNEL, "params.carried * d", "d"),
    (&normal_equations::KERNEL, "select(params.outside, 1.0, second.inside)", "1.0"),
    (&window_y::KERNEL, "i32(params.height - 1u) * row", "i32(max(params.height, 2u) - 2u) * row"),
    (&window_y::KERNEL, "clamp(at, first, last)", "max(at, 0)"),
    (&window_y::KERNEL, "(2u * params.radius + 4u) / 4u", "(2u * params.radius) / 4u"),
    (&window_y::KERNEL, "at <= end", "at < end"),
    (&solve::KERNEL, "known((g_xx * h_y", "((g_xx * h_y"),
    (&solve::KERNEL, " + regular", ""),
    (&solve::KERNEL, "1e-3", "1.01e-3"),
    (&solve::KERNEL, "1e-3", "1.0002e-3"),
    (&solve::KERNEL, "g_xx * g_yy - g_xy * g_xy", "g_xx * g_yy - 0.9999 * g_xy * g_xy"),
    (&solve::KERNEL, "g_yy * h_x - g_xy * h_y", "g_yy * h_x - 1.0001 * g_xy * h_y"),
    (&solve::KERNEL, "let last = i32(stride) - 1", "let last = i32(stride) - 2"),
    (&solve::KERNEL, "repeat_last(d.u, 4u * four, params.width)", "d.u"),
    (&solve_increment::KERNEL, "so_far[row] + d.u", "d.u"),
    (&solve_increment::KERNEL, "so_far[row + stride]", "so_far[row]"),
    (&solve_increment::KERNEL, "2u * min(y, params.height - 1u) * stride", "min(y, params.height - 1u) * stride"),
    (&solve_increment::KERNEL, "params.regular", "1e-3"),
    (&normalized_expansion_y::KERNEL, "vec4f(params.outside)", "vec4f(1.0)"),
    (&normalized_expansion_x::KERNEL, "columns < vec4i(i32(params.width))", "columns < vec4i(i32(params.width + 3u) / 4 * 4)"),
    (&affine_columns::KERNEL, "let w_yy = w_y * t", "let w_yy = w_y * abs(t)"),
    (&affine_columns::KERNEL, "y >= 0 && ", ""),
    (&affine_columns::KERNEL, "first[3] += w_y * q_x", "first[3] += w_1 * q_x"),
    (&solve_affine::KERNEL, "column < i32(params.width);", "column <= i32(params.width);"),
    (&solve_affine::KERNEL, "g_xy += w_x * first", "g_xy += w_1 * first"),
    (&solve_affine::KERNEL, "r_2.b.x / r_3.b.x", "r_2.b.x / r_2.b.x"),
    (&solve_affine::KERNEL, "r_1.q - r_1.a.x * u", "r_1.q"),
    (&solve_affine::KERNEL, "g_1.x + r", "g_1.x"),
    (&solve_affine::KERNEL, "params.added * so_far[at + stride + x]", "so_far[at + stride + x]"),
    (&upsample::KERNEL, "params.channels * id.y", "2u * id.y"),
    (&robust_equations::KERNEL, "kappa * vec2f", "1.01 * kappa * vec2f"),
    (&robust_equations::KERNEL, "(a.y + b.y) * f.y", "(a.y + b.y) * f.x"),
    (&robust_equations::KERNEL, "dot(h.yz, h.yz)", "dot(h.xy, h.yz)"),
    (&robust_equations::KERNEL, "s + params.robust", "s + 1.01 * params.robust"),
    (&robust_equations::KERNEL, "select(params.outside, 1.0, second.inside)", "1.0"),
    (&weighted_robust_equations::KERNEL, "f - vec2f(0.0, 1.0)", "f"),
    (&weighted_robust_equations::KERNEL, "certainty * outside", "outside"),
    (&weighted_robust_equations::KERNEL, "certainty > 1e-6", "certainty > 1e-2"),
    (&older_equations::KERNEL, "m.a = params.time * m.a", "m.a = abs(params.time) * m.a"),
    (&older_equations::KERNEL, "params.weight * certainty", "params.weight"),
    (&older_equations::KERNEL, "there.second.inside && certainty", "certainty"),
    (&older_equations::KERNEL, "+ params.time * d", "- d"),
    (&older_equations::KERNEL, "q + own.q", "own.q"),
    (&keep_expansion::KERNEL, "i + stride * params.height]", "i + stride * (params.height - 1u)]"),
    (&carry::KERNEL, "params.sense * d", "d"),
    (&carry::KERNEL, "previous[(3u * y + 2u) * stride + x] > 0.0 && ", ""),
    (&carry::KERNEL, "1.0 + far * params.inverse", "1.0 + 1.1 * far * params.inverse"),
    (&carry::KERNEL, "min(first + 1u, last)", "first"),
    (&slope_weights::KERNEL, "g - expected(x, y)", "g + expected(x, y)"),
    (&slope_weights::KERNEL, "right - left == 2u", "right - left >= 1u"),
    (&expected_slope::KERNEL, "vec4f(-0.5)", "vec4f(-0.49)"),
    (&expected_slope::KERNEL, "means.d * inverse", "means.d"),
    (&smoothness::KERNEL, "(1.0 - params.beta)", "1.0"),
    (&smoothness::KERNEL, "dot(off, off) + params.robust", "dot(off, off) + 1.02 * params.robust"),
    (&links::KERNEL, "x + 1u < params.width", "true"),
    (&links::KERNEL, "+ 0.5 * (horizontal + vertical)", "- 0.5 * (horizontal + vertical)"),
    (&links::KERNEL, "-g.y * inverse", "g.y * inverse"),
    (&cubic_warp::KERNEL, "min(i + 2u, last)", "min(i + 1u, last)"),
    (&cubic_warp::KERNEL, "1.5 * f - 2.5", "1.5 * f - 2.4"),
    (&cubic_warp::KERNEL, "f.x);\n    let below", "f.y);\n    let below"),
    (&cubic_warp::KERNEL, "all(place <= last)", "all(place < last)"),
    (&cubic_warp::KERNEL, "select(own, sampled, inside)", "sampled"),
    (&brightness_equations::KERNEL, "8.0 * near", "7.0 * near"),
    (&brightness_equations::KERNEL, "select(1.0, 0.5, i > 0u && i + 1u < n)", "0.5"),
    (&brightness_equations::KERNEL, "i > 1u && i + 2u < n", "i > 0u && i + 2u < n"),
    (&brightness_equations::KERNEL, ", share[own])", ", 1.0)"),
    (&brightness_equations::KERNEL, "i_t * i_t * params.robust", "i_t * params.robust"),
    (&brightness_equations::KERNEL, "g.y * i_y + params.prior", "g.y * i_y"),
    (&transport::KERNEL, "params.sense * d", "d"),
    (&transport::KERNEL, "0.75 - f * f", "0.75 - 0.9 * f * f"),
    (&transport::KERNEL, "min(i + 1u, n - 1u)", "i"),
    (&correct::KERNEL, "max(magnitude - params.threshold, 0.0)", "(magnitude - params.threshold)"),
    (&correct::KERNEL, "min(left + 1u, params.in_width - 1u)", "left"),
    (&correct::KERNEL, "params.scale * max", "max"),
    (&sweep::KERNEL, "sweep < 2", "sweep < 1"),
    (&sweep::KERNEL, "p.links.w * tile", "p.links.z * tile"),
    (&sweep::KERNEL, "- RIM;", "- RIM + 1;"),
    (&sweep::KERNEL, "i < 4u", "i < 2u"),
    (&misfit::KERNEL, "select(9.0, e.s, e.s < 9.0)", "e.s"),
    (&misfit::KERNEL, "0.5 * min(sqrt(s), 2.0)", "0.5 * sqrt(s)"),
    (&steadiness::KERNEL, "100.0 * dot", "99.0 * dot"),
    (&steadiness::KERNEL, "right - left == 2u", "right - left >= 1u"),
    (&steadiness::KERNEL, "sideways + upright", "sideways - upright"),
    (&block_mean::KERNEL, "select(0.0, sum / 16.0, inside)", "sum / 16.0"),
    (&block_mean::KERNEL, "4u * (row - RING) + j", "4u * row + j"),
    (&block_mean::KERNEL, "i < 4u", "i < 3u"),
    (&surroundings::KERNEL, "RING - 3u;", "RING - 4u;"),
    (&surroundings::KERNEL, "2u * RING + 3u", "2u * RING + 2u"),
    (&surroundings::KERNEL, "in_stride + 1u", "1u"),
    (&fit_weight::KERNEL, "-5.8885516", "-5.889"),
    (&fit_weight::KERNEL, "+ 1e-3", "+ 1.1e-3"),
    (&fit_weight::KERNEL, "0.25 * column(next, y)", "0.25 * column(x, y)"),
    (&nonlocal::KERNEL, "select(0.0, w, inside)", "w"),
    (&nonlocal::KERNEL, "i == 0 && j == 0", "false"),
    (&nonlocal::KERNEL, "along_y * distance.y", "along_y * distance.x"),
    (&residual::KERNEL, "select(0.0, certainty[i], second.inside)", "certainty[i]"),
    (&residual::KERNEL, "second, vec2f());", "second, d);"),
    (&confidence::KERNEL, "(g_xx + g_yy) - sqrt", "(g_xx + g_yy) + sqrt"),
    (&premultiply::KERNEL, "min(c, vec4f(1.0))", "c"),
    (&premultiply::KERNEL, "(c > vec4f())", "(c >= vec4f(-1.0))"),
    (&normalized_expansion_y::KERNEL, "c4 += c * (yyg * y * y)", "c4 += c * (yyg * y)"),
    (&normalized_expansion_x::KERNEL, "params.min_share, params.least_certainty", "0.0, params.least_certainty"),
    (&weighted_normal_equations::KERNEL, "select(certainty, sum, inside)", "sum"),
    (&weighted_normal_equations::KERNEL, "params.carried * d", "d"),
    (&weighted_normal_equations::KERNEL, "select(params.outside, 1.0, inside)", "1.0"),
    (&rotational_flow::KERNEL, " - current.xy * moved.z", ""),
    (&spherical_flow::KERNEL, "-shift - (previous - unturned)", "-shift"),
    (&spherical_flow::KERNEL, "r.y * motion[1].xyz", "r.y * motion[2].xyz"),
    (&spherical_flow::KERNEL, "1.0 / 6.0", "1.0 / 3.0"),
    (&cell_evidence::KERNEL, "select(0.0, 1.0, all(pixel < size))", "1.0"),
    (&cell_evidence::KERNEL, "let b = share * m.delta_b", "let b = m.delta_b"),
    (&cell_confidence::KERNEL, "* params.pitch) - v.xy", "* params.pitch) + v.xy"),
    (&cell_confidence::KERNEL, "away * params.focal), every)", "away.yx * params.focal), every)"),
    (&cell_confidence::KERNEL, "confidence[out + stride] = every", "confidence[out + stride] = along"),
    (&cells::KERNEL, "(2u * cell.y + 1u)", "(2u * cell.y)"),
    (&sectors::KERNEL, "every >= params.least_both", "every >= 0.0"),
    (&sectors::KERNEL, "w * min(every / max(cells[at.x], 1e-6), 1.0)", "w"),
    (&warp::KERNEL, "place <= last", "place < last"),
    (&warp::KERNEL, "select(0.0, share, inside)", "share"),
    (&gradient_equations::KERNEL, "0.125 * ((above.i.z", "0.25 * ((above.i.z"),
    (&gradient_equations::KERNEL, "vec2f(t * t, share)", "vec2f(t, share)"),
    (&gradient_equations::KERNEL, "dot(g, so_far) - t", "dot(g, so_far) + t"),
    (&gradient_equations::KERNEL, "max(y, 1u) - 1u", "y"),
    (&unweight::KERNEL, "select(0.0, value, share >= 1e-3)", "value"),
    (&cell_mean::KERNEL, "select(0.0, 1.0, there)", "1.0"),
    (&cell_mean::KERNEL, "* certainty[here]", "+ certainty[here]"),
    (&cells::KERNEL, " - m.xy / z * seen.flow.z", ""),
    (&cells::KERNEL, "known && m.z > 0.01", "m.z > 0.01"),
    (&looming::KERNEL, "- 3.0 * dot(origin, here)", "- 2.0 * dot(origin, here)"),
    (&looming::KERNEL, "0.5 * max(left, 0.0)", "0.0"),
    (&looming::KERNEL, "confidence >= params.least_confidence", "true"),
    (&looming::KERNEL, "i <= params.radius + params.inner", "i <= params.radius"),
    (&sectors::KERNEL, "max(looming[at.y + at.z], 0.0)", "looming[at.y + at.z]"),
    (&sectors::KERNEL, "below > ranks", "below >= ranks"),
    (&sectors::KERNEL, "before & vec4<bool>(other.known)", "before"),
    (&sectors::KERNEL, "normal.xxy * normal.yzz", "normal.xxy * normal.yyz"),
    (&undistort_map::KERNEL, "s * b.w", "s * a.w"),
    (&undistort_map::KERNEL, "a.z * (s + 2.0 * y * y)", "a.z * (s + 2.0 * x * x)"),
    (&undistort_map::KERNEL, "ray.z > 0.0", "ray.z > -1e9"),
    (&undistort_map::KERNEL, "across < params.limit.x * ray.z * ray.z", "true"),
    (&undistort_map::KERNEL, "* params.limit.y", "* 1e9"),
    (&undistort_map::KERNEL, "covered.x * covered.y", "covered.x"),
    (&undistort_map::KERNEL, "(params.margin + 1.0)", "(0.5 * params.margin + 1.0)"),
    (&undistort_map::KERNEL, "most > 1.0", "most > 2.0"),
    (&undistort_map::KERNEL, "min(value, 1.0)", "value"),
    (&undistort_map::KERNEL, "(pixel - params.out_centre)", "(pixel + 0.5 - params.out_centre)"),
    (&undistort_map::KERNEL, "dot(motion[0].xyz, r)", "dot(vec3f(motion[0].x, motion[1].x, motion[2].x), r)"),
    (&remap::KERNEL, "clamped - whole", "place - whole"),
    (&remap::KERNEL, "min(at.x + 1u, params.in_width - 1u)", "at.x"),
    (&remap::KERNEL, "min(place, last)", "min(place, last + 1.0)"),
    (&remap::KERNEL, "min(id.x, params.width - 1u)", "id.x"),
    (&cast::KERNEL, "select(lid, vec4f(), mantle)", "lid"),
    (&cast::KERNEL, "half.z == 0.0", "false"),
    (&cast::KERNEL, "slope.z * OFFSET_X", "slope.y * OFFSET_X"),
    (&cast::KERNEL, "size.x * size.x * a - w * w", "size.x * size.x * a - b * b"),
    (&cast::KERNEL, "first_cylinder + i", "first_box + i"),
    (&cast::KERNEL, "x / TILE.x", "x / TILE.y"),
    (&cast::KERNEL, "(lz > vec4f()) != outside", "lz > vec4f()"),
    (&shade::KERNEL, "left -= same", "left = vec4f()"),
    (&shade::KERNEL, "params.share * ", ""),
    (&shade::KERNEL, "select(0.0, sum, shown)", "sum"),
    (&shade::KERNEL, "0.25 - octant", "octant"),
    (&shade::KERNEL, "select(1.0, -1.0, facing > 0.0)", "1.0"),
    (&shade::KERNEL, "share * share * (3.0 - 2.0 * share)", "share"),
    (&shade::KERNEL, "select(per_metre, points, around)", "per_metre"),
    (&shade::KERNEL, "wrapped = steps - points *", "wrapped = steps - 0.0 *"),
    (&shade::KERNEL, "cells << vec2u(octave)", "cells"),
    (&shade::KERNEL, "select(-root, root, inside)", "-root"),
    (&shade::KERNEL, "one > 0.0 && middle.within", "one > 0.0"),
    (&sensor::KERNEL, "params.noise * f32", "1.1 * params.noise * f32"),
    (&sensor::KERNEL, "floor(level + 0.5)", "floor(level)"),
    (&sensor::KERNEL, "seed[1] ^ ", ""),
    (&sensor::KERNEL, "0.0, 255.0", "0.0, 256.0"),
    (&confidence::KERNEL, "clamp(coverage, vec4f(), vec4f(1.0)) * ", ""),
    (&structure_tensor::KERNEL, "2.0 * (here.z - here.x)", "1.0 * (here.z - here.x)"),
    (&structure_tensor::KERNEL, "reflect_101(x - 1, n)", "u32(max(x - 1, 0))"),
    (&block_sum::KERNEL, "params.block / 2u", "(params.block - 1u) / 2u"),
    (&block_sum::KERNEL, "reflect_101(first + i32(k), i32(params.height))", "clamp_index(first + i32(k), params.height)"),
    (&corner_response::KERNEL, "params.block / 2u", "(params.block - 1u) / 2u"),
    (&corner_response::KERNEL, "params.k * trace", "trace"),
    (&corner_response::KERNEL, " + sum.y * sum.y", ""),
    (&local_maxima::KERNEL, "max(max(above, below), here)", "max(above, here)"),
    (&local_maxima::KERNEL, " && mask[y * stride + x] > 0.0", " && mask[y * stride + x] >= 0.0"),
    (&local_maxima::KERNEL, "x > 0u && ", ""),
    (&row_maximum::KERNEL, "x < min(params.width, MAX_SIDE)", "x < min(params.width - 1u, MAX_SIDE)"),
    (&row_maximum::KERNEL, "mask[start + x] > 0.0", "mask[start + x] >= 0.0"),
    (&row_maximum::KERNEL, "other < (64u >> k)", "other < (32u >> k)"),
    (&pyr_down::KERNEL, "+ 4.0 * d", "+ 4.001 * d"),
    (&pyr_down::KERNEL, "reflect_101(x + 2, n)", "reflect_101(x + 1, n)"),
    (&pyr_down::KERNEL, "first - 2", "first - 1"),
    (&pyr_down::KERNEL, "floor(value + 0.5)", "floor(value)"),
    (&patches::KERNEL, "(ys >= vec2i())", "(ys >= vec2i(-1))"),
    (&patches::KERNEL, "0.5 * (window - 1.0)", "0.5 * window"),
    (&patches::KERNEL, "whole >= -window", "whole > -window"),
    (&patches::KERNEL, "10.0 * upper.yz", "10.01 * upper.yz"),
    (&patches::KERNEL, "k < area);", "k <= area);"),
    (&patches::KERNEL, "i < 8u; i++) {\n            sum += eighths", "i < 7u; i++) {\n            sum += eighths"),
    (&track_points::KERNEL, "tensor.y * b.x - tensor.x * b.y", "tensor.y * b.x - 1.001 * tensor.x * b.y"),
    (&track_points::KERNEL, "found -= 0.5 * shift", "found -= 0.51 * shift"),
    (&track_points::KERNEL, "<= params.epsilon", "< 0.0"),
    (&track_points::KERNEL, "&& smaller >= params.min_eigenvalue", ""),
    (&track_points::KERNEL, "clear && meets(end)", "clear"),
    (&track_points::KERNEL, "reflect_101(pixel.x + 1, n.x)", "reflect_101(pixel.x, n.x)"),
    (&track_points::KERNEL, "before = shift", "before = -shift"),
    (&track_points::KERNEL, "abs(d), 0.0", "d, 0.0"),
    (&track_points::KERNEL, "found / params.scale", "found"),
];

#[test]
fn the_comparison_finds_every_mistake() {
    let Some(gpu) = need::gpu() else { return };
    let mut survivors = Vec::new();
    for (kernel, from, to) in WRONG_RESULTS {
        let mut found = None;
        compare_sides(&gpu, &mutant(kernel, from, to), |compared| match compared.difference.breaches {
            0 => ControlFlow::Continue(()),
            _ => {
                found = Some(compared.what);
                ControlFlow::Break(())
            }
        })
        .unwrap_or_else(|error| panic!("{from:?} as {to:?}: {error}"));
        match found {
            Some(what) => println!("{}: {from:?} as {to:?} found at {what}", kernel.name),
            None => survivors.push(format!("{}: {from:?} as {to:?}", kernel.name)),
        }
    }
    assert!(survivors.is_empty(), "not found:\n{}", survivors.join("\n"));
}

#[test]
fn every_kernel_has_a_mistake_to_find() {
    for kernel in ALL {
        let mistakes = WRONG_RESULTS.iter().filter(|(of, _, _)| of.name == kernel.name).count();
        assert!(mistakes > 0, "{} has none", kernel.name);
    }
}

/// A row that is never stored keeps the poison, whatever the right values are.
#[test]
fn a_row_never_stored_is_found_as_poison() {
    let Some(gpu) = need::gpu() else { return };
    let skips = mutant(&window_y::KERNEL, "at <= end", "at < end");
    compare_sides(&gpu, &skips, |Compared { what, difference, .. }| {
        let worst = difference.worst.unwrap_or_else(|| panic!("{what}: nothing found"));
        assert_eq!(worst.found.to_bits(), compare::POISON.to_bits(), "{what}: {worst:?}");
        ControlFlow::Continue(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
}

#[track_caller]
fn refused(kernel: &Kernel, replacements: &[(&str, &str)], reason: &str) {
    let wrong = replacements.iter().fold(*kernel, |kernel, (from, to)| mutant(&kernel, from, to));
    match reflect(&wrong) {
        Ok(shape) => panic!("{replacements:?} was taken: {shape:?}"),
        Err(error) => assert!(error.to_string().contains(reason), "{error}, expected {reason:?}"),
    }
}

#[test]
fn a_layout_that_differs_from_rust_is_refused() {
    let fields =
        [("inv_1_xx: f32, // (1, x²)", "inv_xx: f32,"), ("inv_xx: f32,   // (x², x²)", "inv_1_xx: f32,")];
    refused(&expansion_x::KERNEL, &fields, "in WGSL and");
    refused(
        &solve::KERNEL,
        &[("    width: u32,\n    height: u32,", "    height: u32,\n    width: u32,")],
        "in WGSL and",
    );
    refused(&upsample::KERNEL, &[("in_height: u32,", "in_height: u32, unused: u32,")], "params has");
    refused(&luma::KERNEL, &[("    format: u32, ", "    format: u32, end: vec2f, ")], "params has");
}

#[test]
fn bindings_that_differ_from_rust_are_refused() {
    let renamed = [("uniform> window:", "uniform> weights:"), ("= window[k]", "= weights[k]")];
    refused(&solve::KERNEL, &renamed, "is weights");
    refused(&solve::KERNEL, &[("= window[k]", "= vec4f(f32(k))")], "window is never used");
    refused(&solve::KERNEL, &[("array<vec4f, 1024>", "array<vec4f, 1023>")], "is window");
    refused(&binomial::KERNEL, &[("<storage, read> gray", "<storage, read_write> gray")], "binding");
    refused(&binomial::KERNEL, &[("@binding(2)", "@binding(3)")], "expected smooth_gray at 2");
    refused(
        &binomial::KERNEL,
        &[
            ("@binding(1)", "@binding(2)"),
            ("@binding(2) var<storage, read_write>", "@binding(1) var<storage, read_write>"),
        ],
        "expected gray at 1",
    );
}

#[test]
fn workgroups_and_loops_without_a_bound_are_refused() {
    refused(
        &expansion_x::KERNEL,
        &[("@workgroup_size(16, 1)", "@workgroup_size(16, 32)")],
        "workgroup is 16×32×1",
    );
    refused(
        &binomial::KERNEL,
        &[("@workgroup_size(64, 1)", "@workgroup_size(16, 2, 2)")],
        "workgroup is 16×2×2",
    );
    let open = [("min(steps, MAX_STEPS)", "steps")];
    refused(&window_y::KERNEL, &open, "no stated bound");
    refused(
        &binomial::KERNEL,
        &[("var above", "loop { if x0 == y0 { break; } } var above")],
        "no stated bound",
    );
    refused(&downsample_flow::KERNEL, &[("min(u32(x.y), MAX_COVER)", "u32(x.y)")], "no stated bound");
}

#[test]
fn a_shader_without_its_entry_or_its_span_is_refused() {
    refused(&binomial::KERNEL, &[("fn main(", "fn start(")], "entry point is start");
    refused(&upsample::KERNEL, &[("const SPAN = vec2u(4u, 1u);", "")], "SPAN is missing");
    refused(&upsample::KERNEL, &[("x4], y.y);", "x4], y.y;")], "upsample");
}
