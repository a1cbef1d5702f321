//! The angle of a point, without a branch and without the processor's or a driver's own function: WGSL's `atan2` may
//! have an error of 4096 ulps, and libm's takes one number at a time.

/// atan z = z + z³ (c₀ + c₁z² + … + c₆z¹²) for z in [0, 1], with an error of at most 5·10⁻⁸ in exact arithmetic (the
/// minimax polynomial of this degree, by the Remez algorithm). The shader has the same numbers.
const ARC_TANGENT: [f32; 7] = [
    -0.333_316_6,
    0.199_627_04,
    -0.139_765_84,
    0.097_942_4,
    -0.057_773_657,
    0.023_040_181,
    -0.004_355_417_7,
];

/// Returns the angle of (a, b) in [−π, π], with an error of at most 4·10⁻⁷; 0 for (0, 0). `ratio` is the smaller of |a|
/// and |b| over the larger.
#[inline(always)]
pub(super) fn angle(a: f32, b: f32, ratio: f32) -> f32 {
    let square = ratio * ratio;
    let mut sum = ARC_TANGENT[6];
    for coefficient in ARC_TANGENT[..6].iter().rev() {
        sum = sum * square + coefficient;
    }
    let first = ratio + ratio * (square * sum);
    let quarter = std::f32::consts::FRAC_PI_2;
    let acute = if b.abs() > a.abs() {
        quarter - first
    } else {
        first
    };
    let half = if a < 0.0 {
        std::f32::consts::PI - acute
    } else {
        acute
    };
    if b < 0.0 { -half } else { half }
}

/// Returns the larger of |a| and |b|, and the smaller over the larger; 0 for (0, 0).
#[inline(always)]
pub(super) fn larger_and_ratio(a: f32, b: f32) -> (f32, f32) {
    let (a, b) = (a.abs(), b.abs());
    let larger = if a > b { a } else { b };
    let smaller = if a > b { b } else { a };
    let divisor = if larger > 0.0 { larger } else { 1.0 };
    (larger, smaller / divisor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_library_to_four_ten_millionths() {
        let mut worst = 0.0_f64;
        for n in -40_000..=40_000 {
            let t = f64::from(n) / 40_000.0 * std::f64::consts::PI;
            for size in [1e-30, 1e-3, 1.0, 1e20] {
                let (a, b) = ((size * t.cos()) as f32, (size * t.sin()) as f32);
                let found = angle(a, b, larger_and_ratio(a, b).1);
                let off = f64::from(found) - f64::from(b).atan2(f64::from(a));
                // Behind the origin zero has two signs, and the angle two values.
                let turns = (off / std::f64::consts::TAU).round();
                worst = worst.max((off - std::f64::consts::TAU * turns).abs());
            }
        }
        assert!(worst < 4e-7, "{worst}");
        assert_eq!(angle(0.0, 0.0, larger_and_ratio(0.0, 0.0).1), 0.0);
    }
}
