//! The codes of failures of the command line as a whole; those of the contents of files stand in their crates.

/// Names every code once: as a constant for the program that reports it, and with its text for `toolroom explain`.
macro_rules! codes {
    ($($(#[$about:meta])* $name:ident = $code:literal: $text:literal;)*) => {
        $($(#[$about])* pub const $name: &str = $code;)*

        /// Every code of the command line with its explanation.
        pub const CODES: &[(&str, &str)] = &[$(($code, $text)),*];
    };
}

codes! {
    /// The words of the command do not fit together.
    USAGE = "usage": "The command line cannot be understood: an unknown verb or option, a value that is missing, or one too many. Nothing was read and nothing was written. `toolroom VERB --help` shows every option with an example.";
    /// A value or a file of the command line cannot be used.
    ARGUMENT = "argument": "A value or a file that the command line names cannot be used for this verb: a number out of its range, a table without a needed column, a program or a measurement that cannot be followed. Where a file is at fault, `file` and, where known, `line` of the JSON error name the place. The input has to be mended; exit code 2.";
    /// A file is missing, is in no known encoding, or has faults with places.
    UNREADABLE = "unreadable": "A file cannot be opened or decoded: it does not exist, is a directory, must not be read, is binary, or is a text in another encoding than UTF-8. Check the path, or save the file as UTF-8; exit code 2.";
    /// The input is right and the work could not be done.
    WORK = "work": "The input was accepted, and the work failed nevertheless: a model had no solution at a point that it was asked for, a condition of --strict was not met, or the system refused something. The message names the place; exit code 1.";
    /// The work went as far as it could.
    STOPPED = "stopped": "The work failed on the way. What was complete by then is written, and the help names where; exit code 1.";
    /// Written, but too few data for an answer.
    TOO_LITTLE = "too-little": "The work is done and its result is written, but the data do not suffice for the answer that was asked for, so that the result must not be taken for one. Add rows or groups as the message says; exit code 3.";
    /// Written, and something must not be overlooked.
    ALARM = "alarm": "The work is done, and the records say that the shop has changed since its model was fitted. See when and in which channel before the model is used on; exit code 3.";
    /// Ended by a signal or for memory.
    INTERRUPTED = "interrupted": "The work was stopped: by SIGINT (Ctrl-C, exit code 130), by SIGTERM (exit code 143), or because it would have needed more memory than --max-memory allows (exit code 1). The message says what is kept, and the help how to go on, mostly with --resume.";
    /// A place that cannot be written.
    UNWRITABLE = "unwritable": "A file or folder cannot be written: its folder does not exist, the permission is missing (exit code 2), or the disk is full (exit code 1). Choose another place, or make room.";
}
