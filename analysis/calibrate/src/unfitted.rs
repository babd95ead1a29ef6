//! Channels of a calibration that were read and could not be fitted.

use crate::base::Process;
use crate::calibration::Calibration;
use crate::channel::Channel;
use crate::channels::place;

impl Calibration {
    /// Channels that were read and could not be fitted.
    pub(crate) fn unfitted(&self) -> Vec<String> {
        let fitted = |channel: Channel| self.channels.iter().any(|fit| fit.model.channel() == channel);
        let read = |channel: &Channel| {
            let loads = self.measured.loads.iter().map(|loads| &loads[place(*channel)]);
            loads.flatten().filter(|load| load.is_some()).count()
        };
        let told =
            |channel: Channel| fitted(channel) || channel == Channel::SpindlePower && fitted(Channel::CuttingForce);
        let unfitted = |channel: Channel| {
            let count = read(&channel);
            let column = channel.column();
            (count > 0 && !told(channel)).then(|| {
                format!(
                    "{column} is not used: {count} readings on edges whose wear was read are too few for its parameters"
                )
            })
        };
        match self.measured.process {
            Process::Turning => Channel::ALL.into_iter().filter_map(unfitted).collect(),
            Process::Milling => Vec::new(),
        }
    }
}
