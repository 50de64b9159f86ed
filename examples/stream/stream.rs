//! Frames in flight: a ring of slots, and what changes while they flow.

use std::{sync::Arc, thread::JoinHandle};

use hsad::{
    Error,
    dense::{Brightness, DenseConfig},
    disparity::DisparityRange,
    gpu::{Gpu, block_on},
    image::Size,
    io::Picture,
    seeding::Seeding,
};

use crate::{
    AnyError,
    engine::Engine,
    slot::{FrameResult, Sent, Slot},
};

/// Number of frames in flight: one is uploaded, one computed, one read.
pub const SLOTS: usize = 3;
/// Seeding runs on one frame out of this many.
const SEEDED: usize = 8;

/// Opens a device, at the beginning and when one is lost.
type Open = fn() -> Result<Gpu, AnyError>;

/// The engine for the next frames, and the frames in flight, each with the engine it was submitted to.
pub struct Stream {
    open: Open,
    size: Size,
    engine: Arc<Engine>,
    brightness: Brightness,
    slots: Vec<Slot>,
    /// Slots of `engine` that replace those of the engine before.
    spare: Vec<Slot>,
    /// Slots for another range, while a thread prepares them.
    next: Option<JoinHandle<hsad::Result<Vec<Slot>>>>,
}

impl Stream {
    pub fn new(open: Open, size: Size, config: DenseConfig) -> Result<Self, AnyError> {
        let brightness = config.brightness;
        let slots = prepared(&open()?, size, config)?;
        let engine = slots[0].engine.clone();
        Ok(Self { open, size, engine, brightness, slots, spare: Vec::new(), next: None })
    }

    /// Submits a frame in a free slot.
    pub fn send(&mut self, index: usize, frame: [Picture; 2]) {
        self.submit(Sent { index, frame, seeded: index.is_multiple_of(SEEDED) });
    }

    fn submit(&mut self, sent: Sent) {
        let slot = &mut self.slots[sent.index % SLOTS];
        if !Arc::ptr_eq(&slot.engine, &self.engine) {
            *slot = self.spare.pop().expect("an engine comes with its slots");
        }
        slot.send(sent);
    }

    /// Waits for the frame in the slot that frame `index` will take, and learns from it. If the device was lost, another one is opened
    /// and gets the frames in flight once more.
    pub fn collect(&mut self, index: usize) -> Result<Option<FrameResult>, AnyError> {
        if self.next.as_ref().is_some_and(JoinHandle::is_finished) {
            self.adopt()?;
        }
        let slot = index % SLOTS;
        let result = match self.slots[slot].collect() {
            Err(Error::DeviceLost(reason)) => {
                println!("the device was lost ({reason}): another one is opened");
                self.reopen()?;
                self.slots[slot].collect()
            }
            result => result,
        }?;
        if let Some(seeding) = result.as_ref().and_then(|result| result.seeding.as_ref()) {
            self.learn(seeding)?;
        }
        Ok(result)
    }

    /// Adopts range and brightness from the seeds of a frame for the following frames. A change of brightness costs
    /// nothing. A change of range needs another engine, which a thread builds while frames flow through this one; frames in flight keep
    /// the engine they were submitted to.
    fn learn(&mut self, seeding: &Seeding) -> hsad::Result<()> {
        if let Some(found) = &seeding.brightness {
            self.brightness = found.equalising();
            self.engine.matcher.set_brightness(self.brightness)?;
        }
        let Ok(found) = seeding.range.map(|found| found.range) else { return Ok(()) };
        let has = self.engine.config.range;
        let too_small = found.min < has.min || found.last() > has.last();
        if self.next.is_none() && (too_small || 4 * found.count < has.count) {
            // A margin of half the range on either side keeps the next frames inside.
            let margin = (found.count / 2).cast_signed();
            let range = DisparityRange::inclusive(found.min - margin, found.last() + margin)?;
            println!("range {} to {} px instead of {} to {}", range.min, range.last(), has.min, has.last());
            let (gpu, size) = (self.engine.gpu.clone(), self.size);
            let config = DenseConfig { range, ..self.engine.config.clone() };
            self.next = Some(std::thread::spawn(move || prepared(&gpu, size, config)));
        }
        Ok(())
    }

    /// Waits for the engine of another range, if one is being built, and takes it for the following frames.
    pub fn adopt(&mut self) -> hsad::Result<()> {
        let Some(next) = self.next.take() else { return Ok(()) };
        match next.join().expect("a build does not panic") {
            // The frames in flight tell so, too.
            Err(Error::DeviceLost(_)) => Ok(()),
            slots => self.take_over(slots?),
        }
    }

    fn take_over(&mut self, slots: Vec<Slot>) -> hsad::Result<()> {
        self.engine = slots[0].engine.clone();
        self.spare = slots;
        self.engine.matcher.set_brightness(self.brightness)
    }

    /// Builds everything anew on another device, and submits the frames in flight there.
    fn reopen(&mut self) -> Result<(), AnyError> {
        // What a thread builds is of the lost device.
        self.next = None;
        let mut in_flight: Vec<Sent> = self.slots.iter_mut().filter_map(Slot::take).collect();
        in_flight.sort_by_key(|sent| sent.index);
        self.take_over(prepared(&(self.open)()?, self.size, self.engine.config.clone())?)?;
        in_flight.into_iter().for_each(|sent| self.submit(sent));
        Ok(())
    }

    /// Loses the device, as a driver's reset does.
    pub fn lose(&self) {
        self.engine.gpu.device.destroy();
    }
}

/// Slots for one configuration, compiled as far as the device compiles ahead.
fn prepared(gpu: &Gpu, size: Size, config: DenseConfig) -> hsad::Result<Vec<Slot>> {
    let engine = Arc::new(Engine::new(gpu, size, config)?);
    let slots = (0..SLOTS).map(|_| Slot::new(&engine, size)).collect::<hsad::Result<Vec<_>>>()?;
    block_on(slots[0].warm_up())?;
    Ok(slots)
}
