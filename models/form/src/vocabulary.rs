//! Lists of words: which words a key takes, what each means, and the variant that it becomes.

/// Declares an enum whose every variant is one word in files.
///
/// The list stands once: the words that a key admits (`WORDS`), the reader (`from_word`) and the
/// variants are all made from it, so that none of them can miss an entry.
#[macro_export]
macro_rules! vocabulary {
    (
        $(#[$outer:meta])*
        $visibility:vis enum $name:ident {
            $($(#[$inner:meta])* $variant:ident = $word:literal,)+
        }
    ) => {
        $(#[$outer])*
        $visibility enum $name {
            $($(#[$inner])* $variant,)+
        }

        impl $name {
            /// The words, in the order in which people are shown them.
            $visibility const WORDS: &'static [&'static str] = &[$(Self::$variant.word()),+];

            /// The word in files.
            $visibility const fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }

            /// The variant of a word; `None` if there is none.
            $visibility fn from_word(word: &str) -> Option<Self> {
                match word {
                    $($word => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }
    };
}
