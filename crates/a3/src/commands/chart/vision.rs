//! Differences of colours, as they appear to people with each kind of colour vision.

/// Matrix from red, green and blue in linear light to the responses of the three kinds of cones
/// (Oklab, Ottosson 2020).
const CONES: Matrix = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];
/// Matrix from the cube roots of these responses to lightness, green to red, and blue to yellow.
const OKLAB: Matrix = [
    [0.210_454_255_3, 0.793_617_785, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766],
];
/// Matrices from colours in linear light to their appearance without long, middle or short cones
/// (Machado, Oliveira, Fernandes 2009).
const WITHOUT: [Matrix; 3] = [
    [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ],
    [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_82, 0.042_94, 0.968_881],
    ],
    [
        [1.255_528, -0.076_749, -0.178_779],
        [-0.078_411, 0.930_809, 0.147_602],
        [0.004_733, 0.691_367, 0.303_9],
    ],
];
/// Weight of the difference that people with all cones see: thin lines need a larger difference to
/// be told apart at a glance.
const FULL_VISION: f64 = 0.6;

type Matrix = [[f64; 3]; 3];

/// Returns the difference of two colours, each `#` and six hexadecimal digits, to the kind of
/// colour vision to which it is smallest. Black and white differ by 60.
pub fn difference(a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(linear);
    let apart = |[a, b]: [[f64; 3]; 2]| {
        let [a, b] = [a, b].map(lab);
        100.0 * (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    let without = WITHOUT.iter().map(|m| apart([times(m, a), times(m, b)]));
    without.fold(FULL_VISION * apart([a, b]), f64::min)
}

/// Returns red, green and blue of a colour in linear light, from 0 to 1.
fn linear(colour: &str) -> [f64; 3] {
    [1, 3, 5].map(|k| {
        let digits = colour.get(k..k + 2).unwrap_or_default();
        let part = f64::from(u8::from_str_radix(digits, 16).unwrap_or(0)) / 255.0;
        if part <= 0.040_45 {
            part / 12.92
        } else {
            ((part + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// Returns the Oklab coordinates of a colour in linear light.
fn lab(colour: [f64; 3]) -> [f64; 3] {
    let inside = colour.map(|part| part.clamp(0.0, 1.0));
    times(&OKLAB, times(&CONES, inside).map(f64::cbrt))
}

/// Multiplies a vector by a matrix.
fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| m[i][k] * v[k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_differences_are_found() {
        assert!((difference("#000000", "#ffffff") - 60.0).abs() < 0.01);
        // Red and green of one lightness, which many people cannot tell apart, and blue and yellow.
        assert!(difference("#997700", "#5a7f1e") < 1.0);
        assert!(difference("#0072b2", "#e69f00") > 15.0);
    }
}
