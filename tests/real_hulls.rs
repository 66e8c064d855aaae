//! The hulls of real subjects have the volumes and extents that were measured by other means.

use nalgebra::Point3;
use ode_visual_hull::hull::{Aabb, HullData, Unseen};
use ode_visual_hull::silhouette::load_mask;
use ode_visual_hull_testing::captures::{self, BALANCING, DINO, SEATED, carve, dino_cameras, hull_of};

fn assert_near(found: &Aabb, min: [f64; 3], max: [f64; 3], tolerance: f64) {
    let off = (found.min - Point3::from(min)).amax().max((found.max - Point3::from(max)).amax());
    assert!(off <= tolerance, "found {} to {}", found.min, found.max);
}

#[test]
fn the_seated_person_is_as_large_as_measured_through_four_distorting_lenses() {
    let Some(dir) = captures::find("seated_person") else { return };
    let hull = hull_of(&dir, 0, SEATED, Unseen::Outside);
    let (volume, aabb) = carve(&hull, 0.02);
    // Measured by projecting voxels of 2 cm through the lenses. The volume has three digits, the box two decimals.
    assert!((volume - 0.233).abs() < 0.005, "{volume}");
    assert_near(&aabb, [0.04, 0.04, 0.0], [0.66, 0.90, 1.40], 0.03);
}

#[test]
fn the_balancing_person_is_as_large_as_measured() {
    let Some(dir) = captures::find("balancing_person") else { return };
    let hull = hull_of(&dir, 50, BALANCING, Unseen::Outside);
    let (volume, aabb) = carve(&hull, 0.02);
    assert!((volume - 0.122).abs() < 0.005, "{volume}");
    assert!((aabb.max.z - 1.72).abs() < 0.03, "{}", aabb.max.z);
}

#[test]
fn the_dinosaur_is_as_large_as_measured_where_views_that_miss_a_part_abstain() {
    let Some(dir) = captures::find("dino") else { return };
    let data = HullData::new();
    data.set_unseen(Unseen::ABSTAIN).unwrap();
    for (number, camera) in dino_cameras(&dir) {
        let view = data.add_view(camera).unwrap();
        data.set_mask(view, &load_mask(dir.join(format!("mask/mask_{number:04}.png"))).unwrap()).unwrap();
    }

    assert_eq!(data.view_count(), 15);
    // The known box of the dinosaur, and 8 mm around it: few views see what is farther away.
    data.set_bounds(DINO.grown(0.008)).unwrap();
    let (volume, aabb) = carve(&data.update(0.0).unwrap(), 0.001);

    assert!((volume - 1.28e-4).abs() < 0.05e-4, "{volume}");
    assert_near(&aabb, [-0.061, -0.026, -0.058], [0.012, 0.069, 0.016], 0.003);
}
