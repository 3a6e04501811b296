//! `wythe resume`: continues a stopped run in its folder.

use wythe_core::model::Model;
use wythe_core::results::{Resumed, StoppedRun};
use wythe_core::solve;

use crate::arguments::{Progress, Resume};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::run::{record, take_threads};
use crate::say::print;
use crate::terminal::Terminal;

/// Continues a run from its last checkpoint.
pub fn resume(arguments: &Resume) -> Result<(), Failure> {
    let out = &arguments.folder;
    let mut stopped = StoppedRun::open(out)?;
    let deck = stopped.deck(&arguments.with.overrides())?;
    let (model, warnings) = Model::from_deck(&deck)?;
    if stopped.is_complete(&model)? {
        let told = format!(
            "nothing to do: the run in {} is complete; a longer last step (--set) would go on from its \
             end\n",
            out.display()
        );
        let speaks = !arguments.quiet && arguments.progress != Progress::Json;
        return if speaks { print(&told) } else { Ok(()) };
    }
    take_threads(arguments.threads)?;
    let interrupt = Interrupt::listen();
    let Resumed {
        mut directory,
        checkpoint,
        warnings: of_files,
    } = stopped.resume(&model)?;
    // Keep the deck as it is from now on.
    directory.keep_deck(&deck)?;
    let mut all: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    all.extend(of_files);
    let mut terminal = Terminal::new(&model, arguments.progress, arguments.quiet);
    terminal.begin(&model, &all, out);
    if let Some(checkpoint) = &checkpoint {
        terminal.go_on(checkpoint);
    }
    let sinks = (directory, terminal);
    record(
        &model,
        &all,
        sinks,
        &interrupt,
        |recorder| match checkpoint {
            Some(checkpoint) => solve::resume(&model, checkpoint, recorder),
            None => solve::run(&model, recorder),
        },
    )
}
