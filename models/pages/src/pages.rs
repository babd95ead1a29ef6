//! Items in pages.

use crate::source::{Lines, Mark, ReadError, Source};
use std::collections::VecDeque;
use std::ops::{ControlFlow, Deref, Range};
use std::sync::Arc;

/// Makes items of lines.
pub trait Reader: Clone {
    /// What is made of one line, or of several that belong together.
    type Item;

    /// Takes a line, by its number from 1: it adds an item, goes on with the last, or adds nothing. `Break` at a line that ends the
    /// text, which adds nothing.
    fn line(&mut self, number: usize, line: &str, items: &mut Vec<Self::Item>) -> ControlFlow<()>;

    /// Whether the next line goes on with the last item.
    fn goes_on(&self) -> bool {
        false
    }

    /// Whether an item has to stay, since something was written into it or is going to be.
    fn stays(item: &Self::Item) -> bool;
}

/// Items of a page (assumption: few enough to be read again at once).
const PAGE: usize = 1024;
/// Pages that are kept beside those that have to stay: programs of less than so many thousand lines are read once (assumption:
/// some 20 MB of statements).
const WINDOW: usize = 64;

struct Page<I> {
    text: usize,
    mark: Mark,
    /// Index of the first item.
    first: usize,
    count: usize,
    stays: bool,
    items: Option<Arc<Vec<I>>>,
}

struct Text<R> {
    lines: Lines,
    /// The reader as it began.
    reader: R,
    items: Range<usize>,
    end: Mark,
}

/// Items of several texts by their index, those of a text one after the other.
///
/// ```
/// use std::ops::ControlFlow;
/// use toolroom_pages::{Pages, Reader, Source};
/// #[derive(Clone)]
/// struct Numbers;
/// impl Reader for Numbers {
///     type Item = f64;
///     fn line(&mut self, _: usize, line: &str, items: &mut Vec<f64>) -> ControlFlow<()> {
///         items.extend(line.parse::<f64>());
///         ControlFlow::Continue(())
///     }
///     fn stays(_: &f64) -> bool {
///         false
///     }
/// }
/// let text: String = (0..200_000).map(|i| format!("{i}\n")).collect();
/// let mut pages = Pages::new();
/// pages.add(&Source::from(&text), Numbers, |_, _| ()).unwrap();
/// assert_eq!(pages.len(), 200_000);
/// for index in [0, 199_999, 77_777, 3] {
///     assert_eq!(*pages.at(index).unwrap().unwrap(), index as f64);
/// }
/// assert!(pages.at(200_000).unwrap().is_none() && pages.held() < 100_000);
/// ```
pub struct Pages<R: Reader> {
    texts: Vec<Text<R>>,
    pages: Vec<Page<R::Item>>,
    len: usize,
    /// Pages that are kept and may be dropped, the oldest first.
    window: VecDeque<usize>,
    /// The page that was wanted last.
    last: usize,
}

/// An item, which stays for as long as it is held.
pub struct At<I> {
    page: Arc<Vec<I>>,
    offset: usize,
}

impl<I> Deref for At<I> {
    type Target = I;

    fn deref(&self) -> &I {
        &self.page[self.offset]
    }
}

impl<R: Reader> Default for Pages<R> {
    fn default() -> Self {
        Self { texts: Vec::new(), pages: Vec::new(), len: 0, window: VecDeque::new(), last: 0 }
    }
}

impl<R: Reader> Pages<R> {
    /// No text yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no item.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of items in memory.
    pub fn held(&self) -> usize {
        self.pages.iter().filter(|page| page.items.is_some()).map(|page| page.count).sum()
    }

    /// Indices of the items of a text.
    pub fn items(&self, text: usize) -> Range<usize> {
        self.texts.get(text).map_or(0..0, |text| text.items.clone())
    }

    /// The text to which an item belongs; `None` beyond the last.
    pub fn text(&self, index: usize) -> Option<usize> {
        self.texts.iter().position(|text| text.items.contains(&index))
    }

    /// Reads a text behind those that are there, and gives every item to `each` with its index. Items before it that stay can be
    /// changed by what `each` is given.
    ///
    /// # Errors
    /// The text cannot be read.
    pub fn add(
        &mut self,
        source: &Source,
        reader: R,
        mut each: impl FnMut(usize, &mut PageWindow<'_, R::Item>),
    ) -> Result<Range<usize>, ReadError> {
        let (first, text) = (self.len, self.texts.len());
        let mut lines = source.lines();
        let mut reading = reader.clone();
        let mut mark = lines.mark();
        let mut items: Vec<R::Item> = Vec::new();
        // Items that were not given to `each` yet: an item is whole when the next begins.
        let mut given = 0;
        let mut end = lines.mark();
        loop {
            if items.len() >= PAGE && !reading.goes_on() {
                let mut kept = PageWindow { pages: &mut self.pages, items: &mut items, first: self.len };
                while given < kept.items.len() {
                    each(self.len + given, &mut kept);
                    given += 1;
                }
                self.close(text, mark, std::mem::take(&mut items));
                (given, mark) = (0, lines.mark());
            }
            let Some((number, line)) = lines.next()? else { break };
            let flow = reading.line(number, &line, &mut items);
            drop(line);
            if flow.is_break() {
                break;
            }
            end = lines.mark();
            let whole = if reading.goes_on() { items.len().saturating_sub(1) } else { items.len() };
            let mut kept = PageWindow { pages: &mut self.pages, items: &mut items, first: self.len };
            while given < whole {
                each(self.len + given, &mut kept);
                given += 1;
            }
        }
        let mut kept = PageWindow { pages: &mut self.pages, items: &mut items, first: self.len };
        while given < kept.items.len() {
            each(self.len + given, &mut kept);
            given += 1;
        }
        self.close(text, mark, items);
        let range = first..self.len;
        self.texts.push(Text { lines, reader, items: range.clone(), end });
        Ok(range)
    }

    fn close(&mut self, text: usize, mark: Mark, items: Vec<R::Item>) {
        if items.is_empty() {
            return;
        }
        let stays = items.iter().any(R::stays);
        let (first, count) = (self.len, items.len());
        self.len += count;
        self.pages.push(Page { text, mark, first, count, stays, items: Some(Arc::new(items)) });
        if !stays {
            self.hold(self.pages.len() - 1);
        }
    }

    /// A page is in memory; the oldest leaves.
    fn hold(&mut self, page: usize) {
        self.window.push_back(page);
        if self.window.len() > WINDOW
            && let Some(oldest) = self.window.pop_front()
        {
            self.pages[oldest].items = None;
        }
    }

    /// An item that stays, to be changed; `None` where it may be read again.
    pub fn item(&mut self, index: usize) -> Option<&mut R::Item> {
        item(&mut self.pages, index)
    }

    /// The item of an index; `None` beyond the last.
    ///
    /// # Errors
    /// Its page has to be read again and cannot be, or its text has changed.
    pub fn at(&mut self, index: usize) -> Result<Option<At<R::Item>>, ReadError> {
        let holds = |page: &Page<R::Item>| (page.first..page.first + page.count).contains(&index);
        if !self.pages.get(self.last).is_some_and(holds) {
            if index >= self.len {
                return Ok(None);
            }
            self.last = self.pages.partition_point(|page| page.first <= index) - 1;
        }
        let offset = index - self.pages[self.last].first;
        let page = self.page(self.last)?;
        Ok(Some(At { page, offset }))
    }

    fn page(&mut self, number: usize) -> Result<Arc<Vec<R::Item>>, ReadError> {
        if let Some(items) = &self.pages[number].items {
            return Ok(Arc::clone(items));
        }
        let Page { text, mark, count, .. } = self.pages[number];
        let end = self.pages.get(number + 1).filter(|next| next.text == text).map(|next| next.mark);
        let text = &mut self.texts[text];
        let end = end.unwrap_or(text.end);
        text.lines.go(mark)?;
        let mut reader = text.reader.clone();
        let mut items = Vec::with_capacity(count);
        while text.lines.mark().line < end.line {
            let Some((number, line)) = text.lines.next()? else { break };
            // What ends a text ended it before this page or behind it.
            let _ended = reader.line(number, &line, &mut items);
        }
        if items.len() != count {
            return Err(ReadError::Changed);
        }
        let items = Arc::new(items);
        self.pages[number].items = Some(Arc::clone(&items));
        self.hold(number);
        Ok(items)
    }

    /// The first item of a range at which `fits` holds.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn find(
        &mut self,
        range: Range<usize>,
        mut fits: impl FnMut(&R::Item) -> bool,
    ) -> Result<Option<usize>, ReadError> {
        for index in range {
            match self.at(index)? {
                Some(item) if fits(&item) => return Ok(Some(index)),
                Some(_) => {}
                None => return Ok(None),
            }
        }
        Ok(None)
    }

    /// The last item of a range at which `fits` holds.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn find_back(
        &mut self,
        range: Range<usize>,
        mut fits: impl FnMut(&R::Item) -> bool,
    ) -> Result<Option<usize>, ReadError> {
        for index in range.rev() {
            if self.at(index)?.is_some_and(|item| fits(&item)) {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }
}

/// Items while a text is read: the one that was read last, and those before it that stay.
pub struct PageWindow<'a, I> {
    pages: &'a mut [Page<I>],
    items: &'a mut Vec<I>,
    first: usize,
}

impl<I> PageWindow<'_, I> {
    /// An item that stays, or one of the page that is read; `None` where it is gone.
    pub fn item(&mut self, index: usize) -> Option<&mut I> {
        if index >= self.first {
            return self.items.get_mut(index - self.first);
        }
        item(self.pages, index)
    }
}

fn item<I>(pages: &mut [Page<I>], index: usize) -> Option<&mut I> {
    let number = pages.partition_point(|page| page.first <= index).checked_sub(1)?;
    let page = &mut pages[number];
    Arc::get_mut(page.items.as_mut().filter(|_| page.stays)?)?.get_mut(index - page.first)
}
