use super::*;
use nalgebra::Vector3;

const SIZE: (u32, u32) = (640, 480);

fn controls() -> Controls {
    let eye = Point3::new(3.0, 1.0, 1.5);
    let target = Point3::new(0.0, 0.0, 0.9);
    let camera = Camera::look_at("left", SIZE, 0.8, eye, target, Vector3::z()).unwrap();
    let home = Orbit { target, azimuth: 0.3, elevation: 0.2, distance: 3.0, field_of_view: 0.9 };
    Controls::new(vec![camera], home, SIZE, Method::Blend, true)
}

fn press(controls: &mut Controls, key: char) -> Option<Action> {
    let action = controls.take(Input::Press(Key::Char(key)));
    controls.take(Input::Release(Key::Char(key)));
    action
}

/// The place in the picture's middle at the distance of the target, and the eye.
fn view(controls: &Controls) -> (Point3<f64>, Point3<f64>) {
    let Viewpoint::Free(orbit) = controls.request().viewpoint else { panic!("a real camera") };
    (orbit.target, orbit.eye())
}

#[test]
fn each_toggle_changes_one_mark_and_changes_it_back() {
    let before = controls().request();
    for key in ['c', 'p', 'k', 'x', 'v', 'i', '?', 'f', 'h', 'm'] {
        let mut controls = controls();
        assert_eq!(press(&mut controls, key), None);
        assert_ne!(controls.request(), before, "{key}");
        press(&mut controls, key);
        assert_eq!(controls.request(), before, "{key}");
    }
}

#[test]
fn a_click_throws_through_the_pixel_and_a_drag_turns_around_the_target() {
    let mut controls = controls();
    let (target, eye) = view(&controls);
    controls.take(Input::Move(320.0, 240.0));
    controls.take(Input::ButtonDown(Button::Left));
    let action = controls.take(Input::ButtonUp(Button::Left));
    let Some(Action::Command(Command::Throw(ray))) = action else { panic!("{action:?}") };
    // The mouse is in the middle of the picture to half a pixel.
    assert!((ray.origin - eye).norm() < 1e-9 && ray.direction.angle(&(target - eye)) < 0.002);

    controls.take(Input::ButtonDown(Button::Left));
    controls.take(Input::Move(420.0, 260.0));
    assert_eq!(controls.request().coarseness, 2);
    assert_eq!(controls.take(Input::ButtonUp(Button::Left)), None);
    assert_eq!(controls.request().coarseness, 1);
    let (same, turned) = view(&controls);
    assert!((same - target).norm() < 1e-9 && (turned - eye).norm() > 0.5);
    assert!(((turned - same).norm() - 3.0).abs() < 1e-9);
}

#[test]
fn what_is_under_the_mouse_follows_it_when_the_view_is_moved() {
    let mut controls = controls();
    let place = view(&controls).0;
    controls.take(Input::Move(320.0, 240.0));
    assert!(matches!(
        controls.take(Input::ButtonDown(Button::Right)),
        Some(Action::Command(Command::Grab(_)))
    ));
    controls.take(Input::Move(400.0, 200.0));
    assert_eq!(controls.take(Input::ButtonUp(Button::Right)), Some(Action::Command(Command::Release)));
    let camera = controls.request().camera(|_| unreachable!()).unwrap();
    let pixel = camera.project(&place).unwrap();
    assert!((pixel.u - 400.0).abs() < 1.0 && (pixel.v - 200.0).abs() < 1.0, "{pixel:?}");
}

#[test]
fn a_body_that_is_held_moves_instead_of_the_view() {
    let mut controls = controls();
    let before = view(&controls);
    controls.take(Input::Move(320.0, 240.0));
    controls.take(Input::ButtonDown(Button::Right));
    controls.holds_body(true);
    let action = controls.take(Input::Move(350.0, 240.0));
    assert!(matches!(action, Some(Action::Command(Command::Drag(_)))), "{action:?}");
    assert_eq!(view(&controls), before);
    // A window that loses the focus lets go.
    assert_eq!(controls.take(Input::FocusLost), Some(Action::Command(Command::Release)));
}

#[test]
fn flying_from_a_real_camera_starts_at_its_place() {
    let mut controls = controls();
    press(&mut controls, '1');
    assert_eq!(controls.request().viewpoint, Viewpoint::Camera(0));
    press(&mut controls, '2');
    assert_eq!(controls.request().viewpoint, Viewpoint::Camera(0), "there is one camera");
    controls.take(Input::Press(Key::Char('w')));
    controls.advance(0.01);
    let (target, eye) = view(&controls);
    assert!((eye - Point3::new(3.0, 1.0, 1.5)).norm() < 0.03, "{eye}");
    assert!((target - eye).angle(&(Point3::new(0.0, 0.0, 0.9) - eye)) < 0.01);
    controls.take(Input::Release(Key::Char('w')));
    assert!(!controls.is_moving());
}
