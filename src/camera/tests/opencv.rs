//! Where OpenCV itself puts points: `cv2.projectPoints` and `cv2.fisheye.projectPoints` of opencv-python-headless
//! 5.0.0, called once with `POINTS`, `rvec`, `tvec`, `K` and the coefficients below, all digits kept.

use super::*;

const POINTS: [[f64; 3]; 5] =
    [[0.3, -0.2, 1.0], [-1.1, 0.9, 1.3], [0.05, 0.7, 2.0], [2.0, 1.0, 1.5], [-0.6, -1.4, 1.1]];

const RATIONAL_AND_PRISM: [f64; 12] =
    [-0.2, 0.05, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.001, 0.012, -0.003, -0.008, 0.002];

/// That the points appear where OpenCV says, whose pixel centres are whole numbers.
fn assert_agrees(lens: impl Into<Lens>, expected: [(f64, f64); 5]) {
    let k = Matrix3::new(500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0);
    let (tvec, rvec) = (Vector3::new(0.05, -0.1, 0.4), Vector3::new(0.1, -0.05, 0.2));
    let camera = Camera::new("opencv", (640, 480), k, lens, Isometry3::new(tvec, rvec)).unwrap();
    for (point, (u, v)) in POINTS.into_iter().zip(expected) {
        let found = camera.project(&point.into()).unwrap();
        // The same formulas in another order of operations: some rounding errors of 1e-16 times 700 px.
        assert!(
            (found.u - 0.5 - u).abs() < 1e-9 && (found.v - 0.5 - v).abs() < 1e-9,
            "{found:?}, not {u}, {v}"
        );
    }
}

#[test]
fn a_fisheye_agrees_with_opencv() {
    assert_agrees(
        Fisheye::from_opencv(&[0.08, -0.02, 0.004, -0.0005]).unwrap(),
        [
            (439.45377739246516, 118.49675254523953),
            (-3.056524741654698, 351.0745723781887),
            (295.07856702794436, 318.7199236555245),
            (661.3039061196123, 461.0459634872832),
            (235.5108857910646, -245.4075704492265),
        ],
    );
}

#[test]
fn an_equidistant_fisheye_agrees_with_opencv() {
    assert_agrees(
        Fisheye::from_opencv(&[]).unwrap(),
        [
            (438.4184182217379, 119.54117002556752),
            (6.764853543622223, 347.67728849679185),
            (295.12970514031645, 318.55403833001384),
            (647.5706782662785, 452.144540355236),
            (239.8949806278696, -220.0961858018582),
        ],
    );
}

#[test]
fn a_thin_prism_agrees_with_opencv() {
    assert_agrees(
        Distortion::from_opencv(&RATIONAL_AND_PRISM).unwrap(),
        [
            (439.27567498919035, 118.93863836222563),
            (12.045774107652448, 345.078968360793),
            (295.2546424589718, 318.55131422055894),
            (644.4993020372477, 444.95518868956634),
            (246.82460744302142, -214.578255338171),
        ],
    );
}

#[test]
fn a_tilted_sensor_agrees_with_opencv() {
    assert_agrees(
        Distortion::from_opencv(&[RATIONAL_AND_PRISM.as_slice(), &[0.05, -0.03]].concat()).unwrap(),
        [
            (438.7771135859729, 119.52694840944591),
            (14.383802578559198, 343.89285043468976),
            (295.08995406657846, 319.11463545900966),
            (658.0838950026452, 454.23276449921866),
            (250.1830101757626, -194.04778271640055),
        ],
    );
}
