//! Names for views whose file gives only the paths of their images.

use std::collections::HashSet;

/// A name for each of the `paths`: the file stems where they are unique (`left.png`: left), else the folder names
/// (`left/0001.png`: left), else both joined (left_0001).
pub(super) fn names(paths: &[&str]) -> Vec<String> {
    let parts = |path: &&str| -> Vec<String> {
        let mut parts: Vec<_> = path.split(['/', '\\']).filter(|part| !matches!(*part, "" | ".")).collect();
        if let Some((stem, _)) = parts.last().and_then(|file| file.rsplit_once('.'))
            && let Some(last) = parts.last_mut()
            && !stem.is_empty()
        {
            *last = stem;
        }
        parts.into_iter().map(String::from).collect()
    };
    let parts: Vec<_> = paths.iter().map(parts).collect();

    let nth_from_end = |n: usize| parts.iter().map(move |p| p.iter().rev().nth(n).cloned()).collect();
    let [stems, folders]: [Option<Vec<String>>; 2] = [0, 1].map(nth_from_end);

    let differ = |names: &Vec<String>| names.iter().collect::<HashSet<_>>().len() == names.len();
    let joined = || parts.iter().map(|parts| parts.join("_")).collect();

    stems.filter(differ).or_else(|| folders.filter(differ)).unwrap_or_else(joined)
}

#[cfg(test)]
mod tests {
    use super::names;

    #[test]
    fn names_are_the_shortest_part_of_the_path_that_is_unique() {
        assert_eq!(names(&["a.png", "images/b.c.png", "./d"]), ["a", "b.c", "d"]);
        assert_eq!(names(&["left/0001.png", "right/0001.png"]), ["left", "right"]);
        assert_eq!(names(&["left/1.png", "left/2.png", "right/1.png"]), ["left_1", "left_2", "right_1"]);
        assert_eq!(names(&["a.png", "a.jpg"]), ["a", "a"]);
    }
}
