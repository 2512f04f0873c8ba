//! What is done with bytes that nobody vouches for. `tests/untrusted` replays the corpus through the same functions without
//! cargo-fuzz.

pub mod targets;

/// The library of Parquet panics on some damaged pages, which `recording` catches and reports as a damaged file. The fuzzer would stop
/// at each: from here on it stops at all other panics only.
pub fn forgive_parquet() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let stop = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !panic.location().is_some_and(|place| place.file().contains("/parquet-")) {
                stop(panic);
            }
        }));
    });
}
