//! Check sum of the content of a message file, independent of the compression of its records.

use ::mcap::records::MessageHeader;

/// Sum over the header, the messages and the attachments in file order.
#[derive(Clone, Debug)]
pub(super) struct Sum(crc32fast::Hasher);

impl Sum {
    /// Sum of an empty file.
    pub fn new(profile: &str, library: &str) -> Self {
        let mut sum = Self(crc32fast::Hasher::new());
        sum.part(profile.as_bytes());
        sum.part(library.as_bytes());
        sum
    }

    /// Adds a message.
    pub fn message(&mut self, topic: &str, header: &MessageHeader, data: &[u8]) {
        self.0.update(&header.sequence.to_le_bytes());
        self.0.update(&header.log_time.to_le_bytes());
        self.0.update(&header.publish_time.to_le_bytes());
        self.part(topic.as_bytes());
        self.part(data);
    }

    /// Adds an attachment with its times of logging and creation.
    pub fn attachment(&mut self, name: &str, media_type: &str, times: (u64, u64), data: &[u8]) {
        self.0.update(&times.0.to_le_bytes());
        self.0.update(&times.1.to_le_bytes());
        self.part(name.as_bytes());
        self.part(media_type.as_bytes());
        self.part(data);
    }

    /// Present value.
    pub fn value(&self) -> u32 {
        self.0.clone().finalize()
    }

    /// Adds the length of the data and the data.
    fn part(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }
}
