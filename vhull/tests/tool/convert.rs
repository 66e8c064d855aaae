use super::{studio, vhull};
use ode_visual_hull::rig::Rig;

#[test]
fn a_rig_is_converted_and_nothing_replaced_unasked() {
    let folder = studio("convert", "ball");
    let run = vhull(&folder, &["convert", "studio/rig.toml", "copy.toml", "--unit", "0.5"]);
    assert_eq!(run.code, 0, "{}", run.error);
    let rig = |path: &str| Rig::load(folder.join(path)).unwrap();
    for (a, b) in rig("studio/rig.toml").cameras().iter().zip(rig("copy.toml").cameras()) {
        assert!((a.centre() * 0.5 - b.centre()).norm() < 1e-9);
    }
    let again = vhull(&folder, &["convert", "studio/rig.toml", "copy.toml"]);
    assert!(again.code == 1 && again.error.contains("--force"), "{}", again.error);
    assert_eq!(vhull(&folder, &["convert", "studio/rig.toml", "copy.toml", "--force"]).code, 0);
    let other = vhull(&folder, &["convert", "studio/rig.toml", "copy.yml"]);
    assert!(other.code == 1 && other.error.contains("ends in .toml"), "{}", other.error);
}
