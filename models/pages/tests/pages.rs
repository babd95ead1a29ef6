//! Items of long texts are the same whether they are kept or read again.

use std::fs;
use std::ops::ControlFlow;
use toolroom_pages::{Pages, ReadError, Reader, Source};

/// Words of lines; a line that ends with `~` goes on in the next, `end` ends the text, and `keep` stays.
#[derive(Clone, Default)]
struct Words {
    continued: bool,
}

impl Reader for Words {
    type Item = String;

    fn line(&mut self, number: usize, line: &str, items: &mut Vec<String>) -> ControlFlow<()> {
        if line == "end" {
            return ControlFlow::Break(());
        }
        let word = line.trim_end_matches('~');
        match items.last_mut().filter(|_| self.continued) {
            Some(last) => last.push_str(word),
            None => items.push(format!("{number} {word}")),
        }
        self.continued = line.ends_with('~');
        ControlFlow::Continue(())
    }

    fn goes_on(&self) -> bool {
        self.continued
    }

    fn stays(item: &String) -> bool {
        item.contains("keep")
    }
}

fn file(name: &str, bytes: &[u8]) -> std::path::PathBuf {
    let path = std::env::temp_dir().join(format!("toolroom-pages-{}-{name}", std::process::id()));
    fs::write(&path, bytes).expect("a file");
    path
}

#[test]
fn a_file_has_the_items_of_its_text_in_any_order() {
    // Every seventh line goes on, some end with a carriage return, one is no UTF-8.
    let mut bytes = Vec::new();
    for i in 0..300_000_u32 {
        bytes.extend(
            format!("line {i}{}{}\n", if i % 7 == 3 { "~" } else { "" }, if i % 5 == 0 { "\r" } else { "" }).bytes(),
        );
    }
    bytes.extend(b"caf\xe9\nend\nbehind it\n");
    let path = file("any-order.nc", &bytes);
    let (mut memory, mut disk) = (Pages::new(), Pages::new());
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let mut all = Vec::new();
    memory
        .add(&Source::from(&text), Words::default(), |index, list| {
            all.extend(list.item(index).map(|item| item.clone()));
        })
        .expect("a text");
    disk.add(&Source::open(&path).expect("a file"), Words::default(), |_, _| ()).expect("a file");
    assert_eq!((memory.len(), disk.len()), (all.len(), all.len()));
    assert_eq!(all.last().map(String::as_str), Some("300001 caf\u{fffd}"));
    assert!(disk.held() < 100_000 && memory.held() < 100_000);
    // Forwards, backwards, and in leaps.
    let count = all.len();
    let leaps = (0..500).map(|i| (i * 104_729) % count);
    for index in (0..count).chain((0..count).rev().step_by(37)).chain(leaps) {
        assert_eq!(*memory.at(index).expect("an item").expect("an item"), all[index]);
        assert_eq!(*disk.at(index).expect("an item").expect("an item"), all[index]);
    }
    assert!(disk.held() < 100_000);
    fs::remove_file(path).expect("it goes");
}

#[test]
fn what_was_written_into_an_item_stays() {
    let text: String =
        (0..200_000).map(|i| if i % 50_000 == 7 { "keep\n".to_owned() } else { format!("{i}\n") }).collect();
    let mut pages = Pages::new();
    pages
        .add(&Source::from(&text), Words::default(), |index, list| {
            if let Some(first) = list.item(7).filter(|_| index % 50_000 == 7) {
                first.push('!');
            }
        })
        .expect("a text");
    assert_eq!(*pages.at(7).expect("an item").expect("an item"), "8 keep!!!!");
    pages.item(150_007).expect("it stays").push('?');
    for index in (0..pages.len()).step_by(1000) {
        assert!(pages.at(index).expect("an item").is_some());
    }
    assert_eq!(*pages.at(150_007).expect("an item").expect("an item"), "150008 keep?");
    assert!(pages.item(120_000).is_none());
}

#[test]
fn a_file_that_changes_while_it_is_read_is_noticed() {
    let path = file("changes.nc", "a line\n".repeat(200_000).as_bytes());
    let mut pages = Pages::new();
    pages.add(&Source::open(&path).expect("a file"), Words::default(), |_, _| ()).expect("a file");
    // Written into the file that is open, not into a new one.
    let file = fs::OpenOptions::new().write(true).open(&path).expect("a file");
    file.set_len(100).expect("it shrinks");
    assert!(matches!(pages.at(0), Err(ReadError::Changed)));
    fs::remove_file(path).expect("it goes");
}

#[test]
fn texts_follow_each_other() {
    let mut pages = Pages::new();
    let first = pages.add(&Source::from("a\nb\n"), Words::default(), |_, _| ()).expect("a text");
    let second = pages.add(&Source::from("c"), Words::default(), |_, _| ()).expect("a text");
    assert_eq!((first, second.clone()), (0..2, 2..3));
    assert_eq!((pages.text(1), pages.text(2), pages.text(3)), (Some(0), Some(1), None));
    assert_eq!(pages.items(1), second);
    assert_eq!(pages.find(0..9, |item| item == "1 c").expect("a text"), Some(2));
    assert_eq!(pages.find_back(0..3, |item| item.ends_with('b')).expect("a text"), Some(1));
}
