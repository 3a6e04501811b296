//! Writes fields in a parallel thread: compressing a frame takes about as long as an iterate, and the solver need not
//! wait.

use std::io;
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};

use super::VtkHdfWriter;
use crate::state::Frame;

/// Writer of fields with at most one frame in progress. With one thread it writes at once.
#[derive(Debug)]
pub(super) struct FieldsBeside {
    /// `None` while a frame is in progress and after [`FieldsBeside::finish`].
    writer: Option<VtkHdfWriter>,
    /// The frame in progress.
    under_way: Option<JoinHandle<(VtkHdfWriter, io::Result<()>)>>,
}

impl FieldsBeside {
    /// Takes a writer that has created its file.
    pub fn new(writer: VtkHdfWriter) -> Self {
        Self {
            writer: Some(writer),
            under_way: None,
        }
    }

    /// The writer, after the frame in progress is written.
    ///
    /// # Errors
    /// This frame or an earlier one could not be written.
    pub fn settled(&mut self) -> io::Result<&mut VtkHdfWriter> {
        if let Some(under_way) = self.under_way.take() {
            let (writer, written) = under_way
                .join()
                .map_err(|_| io::Error::other("its writer came to grief"))?;
            self.writer = Some(writer);
            written?;
        }
        let gone = || io::Error::other("it could not be written before");
        self.writer.as_mut().ok_or_else(gone)
    }

    /// Appends a frame by [`VtkHdfWriter::append`]. With more than one thread it returns before the frame is written;
    /// an error is reported by the next call that needs the writer.
    ///
    /// # Errors
    /// As for [`FieldsBeside::settled`], and with one thread as for [`VtkHdfWriter::append`].
    pub fn append(&mut self, frame: &Arc<Frame>) -> io::Result<()> {
        let writer = self.settled()?;
        if rayon::current_num_threads() == 1 {
            return writer.append(frame);
        }
        if let Some(mut writer) = self.writer.take() {
            let frame = Arc::clone(frame);
            let write = move || {
                let written = writer.append(&frame);
                (writer, written)
            };
            self.under_way = Some(Builder::new().name("fields".to_owned()).spawn(write)?);
        }
        Ok(())
    }

    /// Writes all data and closes the file.
    ///
    /// # Errors
    /// As for [`FieldsBeside::settled`] and [`VtkHdfWriter::finish`].
    pub fn finish(mut self) -> io::Result<()> {
        self.settled()?;
        self.writer.take().map_or(Ok(()), VtkHdfWriter::finish)
    }
}

impl Drop for FieldsBeside {
    /// Waits, so that no thread writes into a folder that another run may have locked.
    fn drop(&mut self) {
        if let Some(under_way) = self.under_way.take() {
            // Best effort: the caller has another error already or does not need the results.
            let _ = under_way.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;
    use crate::results::vtkhdf::read::FieldsFile;

    fn on_threads<R: Send>(n: usize, run: impl FnOnce() -> R + Send) -> R {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.unwrap().install(run)
    }

    #[test]
    fn frames_are_the_same_however_they_are_written() {
        let model = fake::model();
        let written = |threads| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("results.vtkhdf");
            let writer = VtkHdfWriter::create(&path, &model).unwrap();
            on_threads(threads, || {
                let mut fields = FieldsBeside::new(writer);
                for time in [0.5, 1.0, 1.5] {
                    fields.append(&Arc::new(fake::frame(&model, time))).unwrap();
                }
                assert_eq!(fields.settled().unwrap().steps(), 3);
                fields.finish().unwrap();
            });
            let file = FieldsFile::open(&path).unwrap();
            (
                file.times().to_vec(),
                file.field("displacement", 2).unwrap(),
            )
        };
        assert_eq!(written(1), written(3));
        assert_eq!(written(1).0, [0.5, 1.0, 1.5]);
    }

    #[test]
    fn a_write_error_is_reported_by_the_next_call() {
        let model = fake::model();
        let folder = tempfile::tempdir().unwrap();
        let writer = VtkHdfWriter::create(&folder.path().join("results.vtkhdf"), &model).unwrap();
        on_threads(2, || {
            let mut fields = FieldsBeside::new(writer);
            let mut wrong = fake::frame(&model, 0.5);
            wrong.displacement.pop();
            fields.append(&Arc::new(wrong)).unwrap();
            let why = fields.settled().unwrap_err();
            assert!(why.to_string().contains("displacement"), "{why}");
            // The file is unchanged.
            fields.append(&Arc::new(fake::frame(&model, 0.5))).unwrap();
            assert_eq!(fields.settled().unwrap().steps(), 1);
        });
    }
}
