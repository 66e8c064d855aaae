//! Bodies on the hull of a box move as they do on the box.

#[path = "trajectories/scenes.rs"]
mod scenes;

use scenes::compare::rms_px;
use scenes::reference::Reference;
use scenes::stage::{Support, run, run_for};

#[test]
fn explore() {
    for scene in scenes::all() {
        if let Ok(only) = std::env::var("ONLY")
            && !scene.name.contains(&only)
        {
            continue;
        }
        let native = run(&scene, Support::Native);
        let reference = Reference::of(&scene, &native);
        let hull = run_for(&scene, Support::Hull, native.last);
        let worst = reference
            .rows
            .iter()
            .map(|(k, p)| {
                (0..p.len())
                    .map(|b| (hull[*k][b].pose.translation.vector - p[b].translation.vector).norm())
                    .fold(0.0, f64::max)
            })
            .fold(0.0, f64::max);
        let end = hull[native.last]
            .iter()
            .zip(&native.states[native.last])
            .map(|(a, b)| {
                (a.pose.translation.vector - b.pose.translation.vector).data.0[0]
                    .map(|x| (x * 1e5).round() / 100.0)
            })
            .collect::<Vec<_>>();
        let ratio = hull[native.last][0].velocity.norm() / native.states[native.last][0].velocity.norm();
        println!(
            "{:24} px {:.2} mm  rms {:6.2} px  max {:6.2} px  end mm {:?}  v ratio {:.3} {:.3}..{:.3} {}",
            scene.name,
            scene.rig.pixel() * 1e3,
            rms_px(&reference, &hull),
            worst / scene.rig.pixel(),
            end,
            ratio,
            native.first as f64 * 0.005,
            native.last as f64 * 0.005,
            native.ending
        );
    }
}

#[test]
fn spread() {
    use nalgebra::*;
    let n: u32 = std::env::var("N").map_or(12, |n| n.parse().unwrap());
    let mut state = 12345u64;
    let mut rnd = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for mut scene in scenes::all() {
        if let Ok(only) = std::env::var("ONLY")
            && !scene.name.contains(&only)
        {
            continue;
        }
        let base = scene.bodies.clone();
        let mut found = Vec::new();
        let mut two = Vec::new();
        let mut floor = Vec::new();
        let mut ratios = Vec::new();
        for _ in 0..n {
            let (dx, dy, yaw, dz) = (0.06 * (rnd() - 0.5), 0.06 * (rnd() - 0.5), rnd() * 6.28, 0.01 * rnd());
            let rolls = scene.name.contains("rolls") || scene.name.contains("slides");
            for (b, start) in scene.bodies.iter_mut().zip(&base) {
                let w = scene.rig.world_from_box;
                let local = w.inverse() * start.pose;
                let c = local.translation.vector;
                let pose = if scene.joint.is_some() {
                    Isometry3::translation(0.0, dy, 0.0) * start.pose
                } else if rolls {
                    w * Isometry3::translation(dx, dy, 0.0) * local
                } else {
                    w * Isometry3::translation(c.x + dx, c.y + dy, c.z + dz)
                        * UnitQuaternion::from_euler_angles(0.0, 0.0, yaw)
                        * local.rotation
                };
                b.pose = pose;
            }
            let saved = scene.joint;
            if let Some(
                ode_visual_hull::ode::JointKind::Ball { anchor }
                | ode_visual_hull::ode::JointKind::Hinge { anchor, .. },
            ) = &mut scene.joint
            {
                anchor.y += dy;
            }
            let native = run(&scene, Support::Native);
            let reference = Reference::of(&scene, &native);
            let hull = run_for(&scene, Support::Hull, native.last.max(native.first + 400));
            scene.joint = saved;
            found.push(rms_px(&reference, &hull));
            let limit: f64 = std::env::var("LIMIT").map_or(1e9, |n| n.parse().unwrap());
            if rms_px(&reference, &hull) > limit {
                println!(
                    "bad {:?} {:?} native {:?} .. {:?} {} {} hull {:?}",
                    scene.name,
                    scene.bodies,
                    native.states[native.first][0].pose,
                    native.states[native.last][0].pose,
                    native.first,
                    native.last,
                    hull[native.last][0].pose
                );
            }
            ratios.push(hull[native.last][0].velocity.norm() / native.states[native.last][0].velocity.norm());
            let still = &native.states[native.last];
            if native.ending == "at rest" {
                let off: f64 = (native.first..native.first + 400)
                    .map(|k| {
                        let now = if k < native.last { &native.states[k] } else { still };
                        (hull[k][0].pose.translation.vector - now[0].pose.translation.vector).norm_squared()
                    })
                    .sum::<f64>()
                    / 400.0;
                let mut up = scene.clone_for();
                for b in &mut up.bodies {
                    b.pose.translation.vector.z += 0.16e-3;
                }
                let shifted = run_for(&up, Support::Native, native.last);
                floor.push(rms_px(&reference, &shifted));
                two.push(off.sqrt() / scene.rig.pixel());
            }
        }
        let show = |v: &mut Vec<f64>| {
            v.sort_by(f64::total_cmp);
            if v.is_empty() {
                return "-".to_string();
            }
            format!("{:.2} {:.2} {:.2}", v[0], v[v.len() / 2], v[v.len() - 1])
        };
        println!(
            "{:24} rms min med max {}   2s {}  floor {} ratio {}",
            scene.name,
            show(&mut found),
            show(&mut two),
            show(&mut floor),
            show(&mut ratios)
        );
    }
}

#[test]
fn first_contacts() {
    use scenes::stage::Stage;
    let only = std::env::var("ONLY").unwrap_or("box_edge_first".into());
    let shown: usize = std::env::var("STEPS").map_or(6, |n| n.parse().unwrap());
    for scene in scenes::all() {
        if scene.name != only {
            continue;
        }
        for support in [Support::Native, Support::Hull] {
            println!("{} {support:?}", scene.name);
            let mut stage = Stage::new(&scene, support);
            let geoms: Vec<_> = stage.bodies.iter().flat_map(|&b| stage.world.geoms_of(b)).collect();
            let mut seen = 0;
            for k in 1..400 {
                let s = stage.support;
                for &g in &geoms {
                    let c = stage.world.collide_geoms(s, g, 8).unwrap();
                    if !c.is_empty() && seen < shown {
                        for c in &c {
                            println!(
                                "   {k} pos {:.4} {:.4} {:.4} n {:.4} {:.4} {:.4} depth {:.3} mm",
                                c.position.x,
                                c.position.y,
                                c.position.z,
                                c.normal.x,
                                c.normal.y,
                                c.normal.z,
                                c.depth * 1e3
                            );
                        }
                    }
                    if !c.is_empty() || seen > 0 {
                        seen += 1;
                    }
                }
                stage.step();
                if seen > 0 && seen <= shown {
                    let s = stage.states()[0];
                    println!(
                        "  after {k}: v {:.4} {:.4} {:.4} spin {:.4} {:.4} {:.4}",
                        s.velocity.x, s.velocity.y, s.velocity.z, s.spin.x, s.spin.y, s.spin.z
                    );
                }
            }
        }
    }
}

#[test]
fn timeline() {
    use scenes::stage::Stage;
    let only = std::env::var("ONLY").unwrap_or("box_edge_first".into());
    for scene in scenes::all() {
        if scene.name != only {
            continue;
        }
        let mut lines: Vec<String> = vec![String::new(); 120];
        for support in [Support::Native, Support::Hull] {
            let mut stage = Stage::new(&scene, support);
            let g = stage.world.geoms_of(stage.bodies[0])[0];
            for k in 1..120 {
                let s = stage.support;
                let c = stage.world.collide_geoms(s, g, 8).unwrap();
                let deep = c.iter().map(|c| c.depth * 1e3).fold(0.0, f64::max);
                stage.step();
                let s = stage.states()[0];
                let p = s.pose.translation.vector * 1e3;
                lines[k] += &format!(
                    " | {} {deep:5.2} p {:6.2} {:6.2} {:6.2} v {:6.3} {:6.3} {:6.3} w {:6.3} {:6.3} {:6.3}",
                    c.len(),
                    p.x,
                    p.y,
                    p.z,
                    s.velocity.x,
                    s.velocity.y,
                    s.velocity.z,
                    s.spin.x,
                    s.spin.y,
                    s.spin.z
                );
            }
        }
        for (k, l) in lines.iter().enumerate().skip(28).take(80) {
            println!("{k}{l}");
        }
    }
}
