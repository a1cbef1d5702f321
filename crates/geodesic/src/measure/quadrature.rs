//! Adaptive quadrature of several functions at once. In: a function and breaks. Out: integrals with estimated errors.
//!
//! The Gauss–Kronrod rule with 7 and 15 nodes; the interval with the largest estimated error is halved next (Piessens
//! and others, *QUADPACK*, 1983, section 2.2, routine QAG, from which the error estimate is also taken).

/// Integrals of N functions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integrals<const N: usize> {
    pub(super) values: [f64; N],
    pub(super) errors: [f64; N],
}

/// The Kronrod nodes on [−1, 1]: the positive ones, and 0.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
/// The Kronrod weights of the nodes.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
/// The Gauss weights of every other node.
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Integrates over the intervals between neighbouring `breaks` until all estimated errors are within `tolerance` of the
/// integral's magnitude, or there are `most` intervals.
///
/// # Errors
/// The function's first error.
pub(super) fn integrate<const N: usize, E>(
    breaks: &[f64],
    tolerance: f64,
    most: usize,
    function: &mut dyn FnMut(f64) -> Result<[f64; N], E>,
) -> Result<Integrals<N>, E> {
    let mut pieces: Vec<(f64, f64, Integrals<N>)> = Vec::new();
    for pair in breaks.windows(2) {
        pieces.push((pair[0], pair[1], rule(pair[0], pair[1], function)?));
    }
    loop {
        let total = sum(&pieces);
        let excess = |piece: &Integrals<N>| {
            let of = |k: usize| piece.errors[k] / total.values[k].abs().max(f64::MIN_POSITIVE);
            (0..N).map(of).fold(0.0, f64::max)
        };
        if excess(&total) <= tolerance || pieces.len() >= most {
            return Ok(total);
        }
        let worst = (0..pieces.len())
            .max_by(|&a, &b| excess(&pieces[a].2).total_cmp(&excess(&pieces[b].2)));
        let Some(worst) = worst else {
            return Ok(total);
        };
        let (from, to, _) = pieces.swap_remove(worst);
        let middle = 0.5 * (from + to);
        for (from, to) in [(from, middle), (middle, to)] {
            pieces.push((from, to, rule(from, to, function)?));
        }
    }
}

fn sum<const N: usize>(pieces: &[(f64, f64, Integrals<N>)]) -> Integrals<N> {
    let mut total = Integrals {
        values: [0.0; N],
        errors: [0.0; N],
    };
    for (_, _, piece) in pieces {
        for k in 0..N {
            total.values[k] += piece.values[k];
            total.errors[k] += piece.errors[k];
        }
    }
    total
}

fn rule<const N: usize, E>(
    from: f64,
    to: f64,
    function: &mut dyn FnMut(f64) -> Result<[f64; N], E>,
) -> Result<Integrals<N>, E> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut values = [[0.0; N]; 15];
    for n in 0..15 {
        // In ascending order, for functions that continue from the previous argument.
        let node = if n < 8 { -NODES[n] } else { NODES[14 - n] };
        values[n] = function(middle + half * node)?;
    }
    let weight = |n: usize| KRONROD[n.min(14 - n)];
    let mut result = Integrals {
        values: [0.0; N],
        errors: [0.0; N],
    };
    for (k, integral) in result.values.iter_mut().enumerate() {
        let kronrod: f64 = (0..15).map(|n| weight(n) * values[n][k]).sum();
        let gauss: f64 = (0..7)
            .map(|n| GAUSS[n.min(6 - n)] * values[2 * n + 1][k])
            .sum();
        let mean = 0.5 * kronrod;
        let spread: f64 = (0..15)
            .map(|n| weight(n) * (values[n][k] - mean).abs())
            .sum();
        let size: f64 = (0..15).map(|n| weight(n) * values[n][k].abs()).sum();
        let difference = (kronrod - gauss).abs();
        let sharpened = if spread > 0.0 {
            spread * (200.0 * difference / spread).powf(1.5).min(1.0)
        } else {
            difference
        };
        *integral = half * kronrod;
        result.errors[k] = half.abs() * sharpened.max(50.0 * f64::EPSILON * size);
    }
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(breaks: &[f64], most: usize, f: fn(f64) -> f64) -> Integrals<1> {
        let mut function = |x: f64| -> Result<[f64; 1], ()> { Ok([f(x)]) };
        integrate(breaks, 1e-12, most, &mut function).expect("no errors")
    }

    #[test]
    fn smooth_kinked_and_singular_functions_are_as_exact_as_estimated() {
        type Case = (fn(f64) -> f64, f64, f64);
        let cases: [Case; 4] = [
            (f64::exp, 1.0_f64.exp() - 1.0, 1e-14),
            (|x| x.powi(22), 1.0 / 23.0, 1e-15),
            (|x| (x - 0.3).abs(), 0.5 * (0.09 + 0.49), 1e-11),
            (
                |x| (x - 0.3).abs().sqrt(),
                2.0 / 3.0 * (0.3_f64.powf(1.5) + 0.7_f64.powf(1.5)),
                1e-9,
            ),
        ];
        for (n, (f, expected, bound)) in cases.into_iter().enumerate() {
            let found = of(&[0.0, 0.5, 1.0], 60, f);
            let off = (found.values[0] - expected).abs();
            assert!(
                off <= found.errors[0] + 1e-15,
                "{n}: {off:e} against {found:?}"
            );
            assert!(off <= bound, "{n}: {off:e}");
        }
    }

    #[test]
    fn too_few_intervals_are_confessed() {
        let found = of(&[0.0, 1.0], 2, |x| if x < 0.31 { 0.0 } else { 1.0 });
        assert!(found.errors[0] > (found.values[0] - 0.69).abs());
        assert!(found.errors[0] > 1e-3);
    }

    #[test]
    fn an_error_ends_it() {
        let mut function = |x: f64| -> Result<[f64; 1], f64> { Err(x) };
        assert!(integrate(&[0.0, 1.0], 1e-9, 10, &mut function).is_err());
    }
}
