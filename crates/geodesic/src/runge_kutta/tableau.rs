//! Coefficients of the embedded Runge–Kutta pairs, for autonomous systems (no nodes needed).
//!
//! Dormand and Prince 5(4): J. Comput. Appl. Math. 6 (1980), pages 19–26, table 2; also Hairer, Nørsett, Wanner,
//! *Solving Ordinary Differential Equations I: Nonstiff Problems*, 2nd edition, Springer 1993, section II.5. DOP853: the
//! same book, section II.10, with its two error estimates of orders 5 and 3; the coefficients are those of its authors'
//! program of that name. The classical method: the same book, section II.1. The tests check the order conditions.

/// An explicit embedded pair.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Row i contains the weights of stages 0..=i in stage i+1.
    pub(crate) stages: &'static [&'static [f64]],
    /// The weights of the solution.
    pub(crate) weights: &'static [f64],
    /// The weights of the error estimate; over one more stage (the derivative at the end) if the pair reuses it as the
    /// first stage of the next step.
    pub(crate) error: &'static [f64],
    /// The weights of a second estimate of low order that tempers the first; empty without one.
    pub(crate) low_error: &'static [f64],
    /// The error of a step is proportional to this power of its length.
    pub(crate) error_order: f64,
}

/// Dormand–Prince 5(4): cheaper for short rays and loose tolerances.
pub(crate) const DOPRI5: Tableau = Tableau {
    stages: &[
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
    ],
    weights: &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    low_error: &[],
    error_order: 5.0,
};

/// The classical Runge–Kutta method (thesis, equations 4.2), without an error estimate.
pub(crate) const RK4: Tableau = Tableau {
    stages: &[&[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    weights: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    error: &[],
    low_error: &[],
    error_order: 4.0,
};

/// DOP853: for long rays and small tolerances.
pub(crate) const DOP853: Tableau = Tableau {
    stages: &[
        &[0.05260015195876773],
        &[0.0197250569845379, 0.0591751709536137],
        &[0.02958758547680685, 0.0, 0.08876275643042054],
        &[
            0.2413651341592667,
            0.0,
            -0.8845494793282861,
            0.924834003261792,
        ],
        &[
            0.037037037037037035,
            0.0,
            0.0,
            0.17082860872947386,
            0.12546768756682242,
        ],
        &[
            0.037109375,
            0.0,
            0.0,
            0.17025221101954405,
            0.06021653898045596,
            -0.017578125,
        ],
        &[
            0.03709200011850479,
            0.0,
            0.0,
            0.17038392571223998,
            0.10726203044637328,
            -0.015319437748624402,
            0.008273789163814023,
        ],
        &[
            0.6241109587160757,
            0.0,
            0.0,
            -3.3608926294469414,
            -0.868219346841726,
            27.59209969944671,
            20.154067550477894,
            -43.48988418106996,
        ],
        &[
            0.47766253643826434,
            0.0,
            0.0,
            -2.4881146199716677,
            -0.590290826836843,
            21.230051448181193,
            15.279233632882423,
            -33.28821096898486,
            -0.020331201708508627,
        ],
        &[
            -0.9371424300859873,
            0.0,
            0.0,
            5.186372428844064,
            1.0914373489967295,
            -8.149787010746927,
            -18.52006565999696,
            22.739487099350505,
            2.4936055526796523,
            -3.0467644718982196,
        ],
        &[
            2.273310147516538,
            0.0,
            0.0,
            -10.53449546673725,
            -2.0008720582248625,
            -17.9589318631188,
            27.94888452941996,
            -2.8589982771350235,
            -8.87285693353063,
            12.360567175794303,
            0.6433927460157636,
        ],
    ],
    weights: &[
        0.054293734116568765,
        0.0,
        0.0,
        0.0,
        0.0,
        4.450312892752409,
        1.8915178993145003,
        -5.801203960010585,
        0.3111643669578199,
        -0.1521609496625161,
        0.20136540080403034,
        0.04471061572777259,
    ],
    error: &[
        0.01312004499419488,
        0.0,
        0.0,
        0.0,
        0.0,
        -1.2251564463762044,
        -0.4957589496572502,
        1.6643771824549864,
        -0.35032884874997366,
        0.3341791187130175,
        0.08192320648511571,
        -0.022355307863886294,
    ],
    low_error: &[
        -0.18980075407240762,
        0.0,
        0.0,
        0.0,
        0.0,
        4.450312892752409,
        1.8915178993145003,
        -5.801203960010585,
        -0.4226823213237919,
        -0.1521609496625161,
        0.20136540080403034,
        0.02265179219836082,
    ],
    error_order: 8.0,
};

#[cfg(test)]
mod tests {
    use super::{DOP853, DOPRI5, RK4, Tableau};

    /// The quadrature conditions Σ bᵢ cᵢ^(q−1) = 1/q, and Σ bᵢ cᵢ aᵢⱼ cⱼ = 1/8, a condition on the stages.
    fn conditions(tableau: &Tableau, order: i32) {
        let mut nodes = vec![0.0];
        nodes.extend(tableau.stages.iter().map(|row| row.iter().sum::<f64>()));
        for q in 1..=order {
            let sum: f64 = (tableau.weights.iter().zip(&nodes))
                .map(|(b, c)| b * c.powi(q - 1))
                .sum();
            assert!((sum - 1.0 / f64::from(q)).abs() < 1e-12, "order {q}: {sum}");
        }
        let inner = |i: usize| -> f64 {
            let row = tableau.stages[i - 1];
            row.iter().zip(&nodes).map(|(a, c)| a * c).sum()
        };
        let sum: f64 = (1..nodes.len())
            .map(|i| tableau.weights[i] * nodes[i] * inner(i))
            .sum();
        assert!((sum - 0.125).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn weights_and_stages_fulfil_their_order_conditions() {
        conditions(&RK4, 4);
        conditions(&DOPRI5, 5);
        conditions(&DOP853, 8);
    }

    #[test]
    fn error_estimates_vanish_on_constant_slopes() {
        for weights in [DOPRI5.error, DOP853.error, DOP853.low_error] {
            assert!(weights.iter().sum::<f64>().abs() < 1e-14);
        }
    }
}
