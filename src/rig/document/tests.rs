use super::super::format::LensModel;
use super::*;
use crate::camera::Distortion;

fn message(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

fn scalar(node: &Node) -> &str {
    match &node.value {
        Value::Scalar(text) => text,
        other => panic!("no scalar: {other:?}"),
    }
}

#[test]
fn opencv_yaml_of_all_versions_keeps_its_lines() {
    for head in
        ["%YAML:1.0\n---\n", "%YAML 1.0\n---\n", "%YAML:1.0\r\n---\r\n", "%YAML:1.0\n\n", "# YAML\n---\n"]
    {
        let text = format!(
            "{head}K: !!opencv-matrix\n   rows: 1\n   cols: 2\n   dt: d\n   data: [ 1.,\n      -.Inf ]\n"
        );
        let document = parse(&text).unwrap_or_else(|e| panic!("{head:?}: {e}"));
        let matrix = document.entry("K").unwrap();
        let data = matrix.node.entry("data").unwrap();
        let Value::Sequence(items) = &data.node.value else { panic!("{data:?}") };

        assert_eq!((items[1].line, scalar(&items[1])), (8, "-.Inf"), "{head:?}");
        assert_eq!(
            matrix.numbers().unwrap_err().to_string(),
            "line 3, `K`: expected finite numbers, found -inf; calibrate again"
        );
    }
}

#[test]
fn json_is_read_with_tabs_escapes_and_lines() {
    let text = "{\n\t\"name\": \"caf\\u00e9 \\/ 1\",\n\t\"K\":[[1,2],\n\t\t[3e0,4.5]],\"empty\":{},\"none\":null\n}\n";
    let document = parse(text).unwrap();
    assert_eq!(document.entry("name").unwrap().text().unwrap(), "café / 1");
    let matrix = document.entry("K").unwrap();
    assert_eq!((matrix.node.line, matrix.matrix(2, 2).unwrap()), (3, vec![1.0, 2.0, 3.0, 4.5]));
    // Some programs write everything in one line; long keys test the parser's look-ahead.
    let long = "k".repeat(3000);
    let line = format!("{{\"{long}\":{{\"a\":[1,2,3]}},\"b\":-1}}");
    let document = parse(&line).unwrap();
    assert_eq!(document.entry(&long).unwrap().node.entry("a").unwrap().vector3().unwrap().z, 3.0);
}

#[test]
fn xml_is_read_as_maps_sequences_and_words() {
    let text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<size>\n  640 480</size>\n<names>\"a b\" c</names>\n\
                <list><_>1</_><_><x>2</x></_></list>\n<empty/></opencv_storage>\n";
    let document = parse(text).unwrap();
    assert_eq!(document.entry("size").unwrap().size().unwrap(), (640, 480));
    let Value::Sequence(names) = &document.entry("names").unwrap().node.value else { panic!() };
    assert_eq!(names.iter().map(scalar).collect::<Vec<_>>(), ["a b", "c"]);
    let Value::Sequence(list) = &document.entry("list").unwrap().node.value else { panic!() };
    assert_eq!(scalar(list[1].entry("x").unwrap().node), "2");
    assert_eq!((scalar(document.entry("empty").unwrap().node), list[0].line), ("", 6));
}

#[test]
fn an_alias_equals_its_anchored_node() {
    let document = parse("a: &x [1, 2]\nb: *x\n").unwrap();
    assert_eq!(document.entry("a").unwrap().node.value, document.entry("b").unwrap().node.value);
}

#[test]
fn invalid_documents_are_refused_with_the_line() {
    let cases = [
        ("K: [1, 2\n", "found: "),
        ("{\"K\": [1, 2", "found: "),
        ("<opencv_storage>\n<K>", "expected XML"),
        ("", "empty document"),
        ("K: 1\nL: 2\nK: 3\n", "line 3: expected each key once, found `K` again, first on line 1"),
        ("<a><K>1</K>\n<K>2</K></a>", "line 2: expected each key once"),
        ("a: &x [*x]\n", "alias"),
        ("{\"a\": 1,\n\"a\": 2}", "line 2: expected each key once, found `a` again, first on line 1"),
        ("{\"a\":\n 1} 2", "line 2: "),
        ("{\"a\":\n 1}\n{\"b\": 1}", "line 3: "),
    ];
    for (text, part) in cases {
        let message = message(text);
        assert!(message.starts_with("line ") && message.contains(part), "{text:?}: {message}");
    }
}

#[test]
fn documents_that_nest_deeply_or_expand_exponentially_are_refused() {
    let deep = 100_000;
    assert!(message(&"[".repeat(deep)).starts_with("line 1"));
    assert!(message(&"{\"a\":".repeat(deep)).starts_with("line 1"));
    let xml = format!("{}{}", "<a>".repeat(deep), "</a>".repeat(deep));
    assert!(message(&xml).contains("more than 32 deep"));

    let mut bomb = String::from("a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n");
    for i in 1..12 {
        let alias = format!("*a{}, ", i - 1).repeat(10);
        bomb += &format!("a{i}: &a{i} [{alias}1]\n");
    }
    assert!(message(&bomb).contains("values; check the file"));
    // A long text repeated by aliases, and a list inside many anchors, each of which keeps a copy.
    let long = format!("a: &a \"{}\"\nb: [{}]\n", "x".repeat(50_000), "*a, ".repeat(5_000));
    assert!(message(&long).contains("values; check the file"));
    let nested = format!("a: {}[{}]{}", "&a [".repeat(25), "1, ".repeat(50_000), "]".repeat(25));
    assert!(message(&nested).contains("values; check the file"));

    let json =
        |keys: usize| format!("{{{}}}", (0..keys).map(|i| format!("\"k{i}\": 1,\n")).collect::<String>());
    assert!(parse(&json(4096)).is_ok());
    assert!(
        message(&json(4097))
            .starts_with("line 4097: expected a calibration, found a map of more than 4096 keys")
    );
}

#[test]
fn nested_values_are_found_and_errors_name_their_path() {
    let text = "{\"a\": [\n{\"b\": [1, 2]},\n{\"b\": {\"c\": 1e999, \"d\": true, \"e\": \"x\\ny\"}}]}";
    let document = parse(text).unwrap();
    let a = document.entry("a").unwrap();
    let items = a.items().unwrap();
    assert_eq!(items[0].entry("b").unwrap().array().unwrap(), [1.0, 2.0]);
    let b = items[1].require("b", "").unwrap();
    assert!(b.entry("d").unwrap().is_true() && !b.entry("e").unwrap().is_true());
    assert_eq!(b.entry("e").unwrap().text().unwrap(), "x\ny");

    let infinite = b.entry("c").unwrap().number().unwrap_err().to_string();
    assert_eq!(infinite, "line 3, `a[1].b.c`: expected finite numbers, found inf; calibrate again");
    let two = items[0].entry("b").unwrap().number().unwrap_err().to_string();
    assert_eq!(two, "line 2, `a[0].b`: expected a single number, found 2; write one");

    let none = b.require("z", "add it").unwrap_err().to_string();
    assert_eq!(none, "line 3, `a[1].b`: expected the key `z`, found the keys c, d, e; add it");
    let scalar = items[0].require("b", "").unwrap().require("z", "add it").unwrap_err().to_string();
    assert_eq!(scalar, "line 2, `a[0].b`: expected the key `z`, found a list of 2; add it");
    let map = b.items().unwrap_err().to_string();
    assert_eq!(map, "line 3, `a[1].b`: expected a list, found the keys c, d, e; write one");
}

#[test]
fn errors_about_the_shape_of_numbers_say_what_was_found() {
    let document = parse(
        "short: {rows: 3, cols: 3, dt: d, data: [1, 2]}\nrows: {cols: 3, data: [1]}\nragged:\n  - [1, 2]\n  - [3]\n\
         word: [1, two]\nflat: [1, 2, 3, 4]\nthree: {rows: 1, cols: 1, dt: 3d, data: [1, 2, 3]}\n",
    )
    .unwrap();

    let says = |key: &str| document.entry(key).unwrap().matrix3().unwrap_err().to_string();
    assert!(
        says("short")
            .starts_with("line 1, `short`: expected 3 x 3 numbers as rows and cols say, found 2 in data")
    );
    assert!(
        says("rows").contains("line 2, `rows`: expected a matrix with `rows`, found the keys cols, data")
    );
    assert!(says("ragged").contains("line 5, `ragged`: expected rows of 2 numbers like the first, found 1"));
    assert!(says("word").contains("line 6, `word`: expected a number, found \"two\""));
    assert!(says("flat").contains("expected 3 x 3 numbers, found 4;"));
    assert_eq!(document.entry("three").unwrap().vector3().unwrap().y, 2.0);
}

#[test]
fn zero_coefficients_of_unused_models_are_ignored() {
    let document = parse(
        "off: [1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\nprism: [1, 2, 0, 0, 0, 0, 0, 0, 0.5, 0, 0, 0]\nodd: [1, 2, 3]\n",
    )
    .unwrap();
    let lens = |key: &str| document.entry(key).unwrap().lens(LensModel::OpenCv);
    assert_eq!(lens("off").unwrap().lens, Distortion::from_opencv(&[1.0, 2.0, 0.0, 0.0]).unwrap().into());
    assert_eq!(lens("prism").unwrap().lens.coefficients()[8], 0.5);
    assert!(lens("odd").unwrap_err().to_string().contains("line 3, `odd`: expected 0, 4, 5, 8, 12 or 14"));
}

#[test]
fn errors_about_invalid_rotations_say_how_far_off_they_are() {
    let document = parse(
        "scaled: [[2, 0, 0], [0, 2, 0], [0, 0, 2]]\nmirror: [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]\ndegrees: [0, 90, 0]\n\
         row: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]\n",
    )
    .unwrap();

    let says = |key: &str| document.entry(key).unwrap().rotation().unwrap_err().to_string();
    assert!(
        says("scaled").contains("found determinant 8.0000 and R^T R 3.0e0 off the identity"),
        "{}",
        says("scaled")
    );
    assert!(says("mirror").contains("found determinant -1.0000"));
    assert!(says("degrees").contains("found one of length 90.0; convert it from degrees"));

    let row = document.entry("row").unwrap().motion().unwrap_err().to_string();
    assert!(
        row.contains(
            "line 4, `row`: expected the last row 0 0 0 1, found [1.0, 2.0, 3.0, 1.0]; transpose it"
        )
    );
}
