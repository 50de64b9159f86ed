//! Kamencay's method: mean shift, belief propagation, and the whole method.

use crate::{
    cpu::kamencay::{Grid, belief, belief_cost, belief_reduce, belief_select, compute_within, mean_shift},
    dense::{Brightness, Dense, Difference},
    disparity::DisparityRange,
    error::Result,
    gpu::block_on,
    image::{Plane, Size},
    io::Picture,
    kamencay::{
        self, FAR, KamencayConfig, KamencayParameters, LinkWeights, Links, MAX_MESSAGE_BYTES, ModeSeeking, OVERLAP,
        Segmentation, Segments, Smoothness, Strip, WindowCost, described,
        kernels::{Belief, BeliefCost, BeliefReduce, BeliefSelect, GridBuffers, MeanShift, Turn, Winner},
    },
    verify::{
        dice::smooth_noise,
        trial::{Array, Bench, Dice, Subject, Trial},
    },
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("mean_shift", |size, dice| Box::new(MeanShiftTrial::draw(size, dice))),
    Subject::kernel("belief_cost", |size, dice| Box::new(BeliefCostTrial::draw(size, dice))),
    Subject::kernel("belief_reduce", |size, dice| Box::new(BeliefReduceTrial::draw(size, dice))),
    Subject::kernel("belief", |size, dice| Box::new(BeliefTrial::draw(size, dice))),
    Subject::kernel("belief_select", |size, dice| Box::new(BeliefSelectTrial::draw(size, dice))),
    Subject::pipeline("kamencay", |size, dice| Box::new(KamencayTrial::draw(size, dice))),
];

/// Most disparities: CPU drivers are slow with many.
const MOST_DISPARITIES: u32 = 24;

/// Most pixels of a picture with windows of any size.
const FEW_PIXELS: u32 = 4000;

fn colours(size: Size, dice: &mut Dice) -> Picture {
    let channels = [0; 4].map(|_| dice.picture(size));
    Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y)))
}

/// Draws a pair: a slanted plane with some noise in the left view; sometimes views with nothing in common.
fn pair(size: Size, dice: &mut Dice) -> [Picture; 2] {
    let right = colours(size, dice);
    if dice.below(8) == 0 {
        return [colours(size, dice), right];
    }
    let (least, slant, noise) = (i64::from(dice.between(-4, 12)), 1 + dice.below(40), dice.pick(&[1, 4, 16]));
    let left = Plane::from_fn(size, |x, y| {
        let disparity = least + i64::from(y / slant % 12);
        right.get_clamped(i64::from(x) - disparity, y.into()).map(|level| level.saturating_add(dice.below(noise) as u8))
    });
    [left, right]
}

/// The links of a whole view.
fn links(view: &Plane<u32>, segmentation: Segmentation, weights: LinkWeights) -> Links {
    let whole = Strip { first_row: 0, rows: view.height() };
    Links::new(view, &Segments::new(view, segmentation), whole, weights)
}

/// Data costs of all nodes, 0 to `255 scale`, padded to a multiple of four disparities.
fn costs(Size { width, height }: Size, disparities: u32, scale: u16, dice: &mut Dice) -> Vec<u16> {
    let count = disparities.next_multiple_of(4);
    let noise = smooth_noise((width * count, height), dice.word());
    let cost = |(index, &value): (u32, &u8)| {
        if index % count < disparities { scale * u16::from(value) } else { FAR as u16 }
    };
    (0..).zip(noise.data()).map(cost).collect()
}

/// Draws `count` bytes up to `most`, a multiple of four.
fn messages(count: usize, most: u32, dice: &mut Dice) -> Vec<u8> {
    let part = |byte: u8| (u32::from(byte) * (most + 1) / 256) as u8;
    (0..count / 4).flat_map(|_| dice.word().to_le_bytes().map(part)).collect()
}

/// Widens costs to `u32`.
fn words(costs: &[u16]) -> Vec<u32> {
    costs.iter().map(|&cost| cost.into()).collect()
}

/// An output buffer of `costs` costs, filled with neither 0 nor [`FAR`], which a kernel has to write.
fn costs_output(bench: &Bench<'_>, costs: u32) -> Result<wgpu::Buffer> {
    bench.upload(&vec![0xeeee_u16; costs as usize])
}

/// A picture to be filtered.
#[derive(Clone, Debug)]
pub struct MeanShiftTrial {
    /// One `u32` per pixel, red in the lowest byte; the highest byte is ignored.
    pub pixels: Plane<u32>,
    /// Parameters of mean shift.
    pub seeking: ModeSeeking,
}

impl MeanShiftTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (radius, turns) = if size.width * size.height <= FEW_PIXELS { (15, 20) } else { (3, 6) };
        let seeking = ModeSeeking {
            radius: 1 + dice.below(radius),
            range: dice.pick(&[1, 8, 10, 30, 90, 255]),
            turns: 1 + dice.below(turns),
        };
        Self { pixels: colours(size, dice).map(|&pixel| u32::from_le_bytes(pixel)), seeking }
    }
}

impl Trial for MeanShiftTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.seeking)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.pixels.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height }) = (bench.gpu, self.pixels.size());
        let modes = bench.output(width * height)?;
        let pixels = bench.upload(self.pixels.data())?;
        let dispatch = MeanShift::new(gpu, &self.seeking).prepare(Size::new(width, height), &pixels, &modes);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("modes", bench.download::<u32>(&modes)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("modes", mean_shift(&self.pixels, &self.seeking).into_data())])
    }
}

/// Two views, of which a strip is compared.
#[derive(Clone, Debug)]
pub struct BeliefCostTrial {
    /// Left and right view, from [`described`].
    pub views: [Plane<u32>; 2],
    /// The rows whose costs are computed.
    pub strip: Strip,
    /// The data cost.
    pub cost: WindowCost,
    /// The disparities.
    pub range: DisparityRange,
}

impl BeliefCostTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let mut part = || {
            let any = Difference { weight: dice.below(60), limit: dice.below(256) };
            dice.pick(&[any, any, Difference { weight: 0, limit: 0 }, Difference { weight: 4096, limit: 255 }])
        };
        let (color, gradient) = (part(), part());
        let radius = dice.below(if size.width * size.height <= FEW_PIXELS { 8 } else { 2 });
        let mut range = dice.range(MOST_DISPARITIES);
        range.min += dice.pick(&[0, 0, 9, -500, 90]);
        let first_row = dice.below(size.height.min(4));
        let strip = Strip { first_row, rows: size.height - first_row - dice.below((size.height - first_row).min(9)) };
        let views = pair(size, dice).map(|view| described(&view, Brightness::SAME));
        Self { views, strip, cost: WindowCost { radius, color, gradient }, range }
    }
}

impl Trial for BeliefCostTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} {:?}", self.cost, self.range, self.strip)
    }

    fn input(&self) -> Vec<Array> {
        let [left, right] = self.views.each_ref().map(|view| view.data().to_vec());
        vec![Array::exact("left", left), Array::exact("right", right)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Self { views: [left, right], strip, cost, range } = self;
        let (gpu, size) = (bench.gpu, left.size());
        let costs = costs_output(bench, range.count.next_multiple_of(4) * size.width * strip.rows)?;
        let views = [&bench.upload(left.data())?, &bench.upload(right.data())?];
        let dispatch = BeliefCost::new(gpu, cost).prepare(size, *strip, *range, views, &costs);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("costs", words(&bench.download(&costs)?))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Self { views: [left, right], strip, cost, range } = self;
        Ok(vec![Array::exact("costs", words(&belief_cost([left, right], *strip, cost, *range)))])
    }
}

/// A grid to be halved.
#[derive(Clone, Debug)]
pub struct BeliefReduceTrial {
    /// Size of the grid, in nodes.
    pub size: Size,
    /// Data costs of each node, a multiple of four disparities.
    pub costs: Vec<u16>,
}

impl BeliefReduceTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        // The largest sums exceed the range of a cost.
        let (disparities, scale) = (1 + dice.below(MOST_DISPARITIES), dice.pick(&[1, 60, 120, 257]));
        Self { size, costs: costs(size, disparities, scale, dice) }
    }
}

impl Trial for BeliefReduceTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("costs", words(&self.costs))]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height }) = (bench.gpu, self.size);
        let count = self.costs.len() as u32 / (width * height);
        let coarse = costs_output(bench, count * width.div_ceil(2) * height.div_ceil(2))?;
        let fine = bench.upload(&self.costs)?;
        let dispatch = BeliefReduce::new(gpu).prepare(self.size, count / 4, &fine, &coarse);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("costs of half the size", words(&bench.download(&coarse)?))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("costs of half the size", words(&belief_reduce(&self.costs, self.size)))])
    }
}

/// A grid in which half of the nodes send.
#[derive(Clone, Debug)]
pub struct BeliefTrial {
    /// Data costs of each node, a multiple of four disparities.
    pub costs: Vec<u16>,
    /// Links, which give the grid its size.
    pub links: Links,
    /// Previous messages, all four sides with the same number of disparities.
    pub messages: Vec<u8>,
    /// Messages of the grid of half the size.
    pub parents: Vec<u8>,
    /// Smoothness cost.
    pub smoothness: Smoothness,
    /// The senders.
    pub turn: Turn,
}

impl BeliefTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let disparities = 1 + dice.below(MOST_DISPARITIES);
        let limit = 1 + dice.below(255);
        let smoothness = Smoothness { slope: if dice.coin() { limit } else { 1 + dice.below(limit) }, limit };
        let turn = Turn { parity: dice.below(2), from_parents: dice.coin() };
        let weights = LinkWeights {
            halving: 1 + dice.below(30),
            least: dice.below(4),
            inside: dice.below(17),
            across: dice.below(17),
        };
        let view = described(&colours(size, dice), Brightness::SAME);
        let links = links(&view, Segmentation { join: dice.below(30), least: dice.below(4) }, weights);
        // Costs of a pixel, or of a node of a coarse grid, where they can reach FAR.
        let scale = dice.pick(&[1, 3, 257]);
        let costs = costs(size, disparities, scale, dice);
        let parents = costs.len() / (size.width * size.height) as usize
            * (size.width.div_ceil(2) * size.height.div_ceil(2)) as usize;
        let messages = |costs: usize, dice: &mut Dice| messages(4 * costs, limit, dice);
        Self { messages: messages(costs.len(), dice), parents: messages(parents, dice), costs, links, smoothness, turn }
    }

    fn size(&self) -> Size {
        self.links.words().size()
    }
}

impl Trial for BeliefTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?}", self.smoothness, self.turn)
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("costs", words(&self.costs)),
            Array::exact("links", self.links.words().data().to_vec()),
            Array::exact("messages before", self.messages.clone()),
            Array::exact("messages of half the size", self.parents.clone()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.size());
        let fours = self.costs.len() as u32 / (4 * size.width * size.height);
        let messages = bench.upload(&self.messages)?;
        let buffers = GridBuffers {
            costs: &bench.upload(&self.costs)?,
            links: &bench.upload(self.links.words().data())?,
            parents: &bench.upload(&self.parents)?,
            messages: &messages,
        };
        let dispatch = Belief::new(gpu, &self.smoothness, fours).prepare(size, self.turn, buffers);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("messages", bench.download::<u8>(&messages)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let grid = Grid { size: self.size(), costs: &self.costs, links: &self.links };
        let mut messages = self.messages.clone();
        belief(grid, &mut messages, &self.parents, &self.smoothness, self.turn);
        Ok(vec![Array::exact("messages", messages)])
    }
}

/// A grid whose nodes select their disparities.
#[derive(Clone, Debug)]
pub struct BeliefSelectTrial {
    /// Size of the grid, in nodes.
    pub size: Size,
    /// Number of disparities.
    pub disparities: u32,
    /// Data costs of each node, padded to a multiple of four disparities.
    pub costs: Vec<u16>,
    /// Messages of the nodes.
    pub messages: Vec<u8>,
}

impl BeliefSelectTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let disparities = 1 + dice.below(MOST_DISPARITIES);
        let costs = costs(size, disparities, 1, dice);
        // With few different messages many beliefs tie.
        let most = dice.pick(&[1, 100, 255]);
        Self { size, disparities, messages: messages(4 * costs.len(), most, dice), costs }
    }

    fn arrays(winners: &[Winner]) -> Vec<Array> {
        vec![Array::exact("winners", bytemuck::cast_slice::<_, u32>(winners).to_vec())]
    }
}

impl Trial for BeliefSelectTrial {
    fn parameters(&self) -> String {
        format!("{} disparities", self.disparities)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("costs", words(&self.costs)), Array::exact("messages", self.messages.clone())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.size);
        let winners = bench.output(2 * size.width * size.height)?;
        let volumes = [&bench.upload(&self.costs)?, &bench.upload(&self.messages)?];
        let dispatch = BeliefSelect::new(gpu).prepare(size, self.disparities, volumes, &winners);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(Self::arrays(&bench.download(&winners)?))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        // A grid needs links, but the selection does not read them.
        let weights = LinkWeights { halving: 1, least: 0, inside: 0, across: 0 };
        let view = Plane::filled(self.size, 0);
        let links = links(&view, Segmentation { join: 0, least: 0 }, weights);
        let grid = Grid { size: self.size, costs: &self.costs, links: &links };
        Ok(Self::arrays(&belief_select(grid, &self.messages, self.disparities)))
    }
}

/// A pair for Kamencay's method.
#[derive(Clone, Debug)]
pub struct KamencayTrial {
    /// The left view.
    pub left: Picture,
    /// The right view.
    pub right: Picture,
    /// Parameters of the method.
    pub config: KamencayConfig,
    /// Most bytes of a strip's messages.
    pub message_bytes: u64,
}

impl KamencayTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let range = dice.range(MOST_DISPARITIES);
        let defaults = KamencayParameters::default();
        let parameters = KamencayParameters {
            mean_shift: ModeSeeking { radius: 1 + dice.below(4), turns: 1 + dice.below(6), ..defaults.mean_shift },
            levels: 1 + dice.below(6),
            turns: 2 + dice.below(5),
            ..defaults
        };
        let brightness = dice.pick(&[Brightness::SAME, Brightness { gain: 280, offset: -700 }]);
        let config = KamencayConfig { range, reference: dice.view(), brightness, parameters };
        let row_bytes = 16 * u64::from(size.width) * u64::from(range.count.div_ceil(4));
        let strips = u64::from(3 * OVERLAP + dice.below(size.height)) * row_bytes;
        let message_bytes = dice.pick(&[MAX_MESSAGE_BYTES, strips]);
        let [left, right] = pair(size, dice);
        Self { left, right, config, message_bytes }
    }

    fn arrays(dense: Dense) -> Vec<Array> {
        vec![
            Array::exact("disparities", dense.disparity.into_data()),
            Array::exact("confidences", dense.confidence.into_data()),
        ]
    }
}

impl Trial for KamencayTrial {
    fn parameters(&self) -> String {
        format!("{:?} in strips of at most {} bytes", self.config, self.message_bytes)
    }

    fn input(&self) -> Vec<Array> {
        let view = |name, view: &Picture| Array::exact(name, view.rgba().to_vec());
        vec![view("left", &self.left), view("right", &self.right)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (config, bytes) = (&self.config, self.message_bytes);
        let dense = kamencay::compute_within(bench.gpu, &self.left, &self.right, config, bytes);
        Ok(Self::arrays(block_on(dense)?))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(Self::arrays(compute_within(&self.left, &self.right, &self.config, self.message_bytes)?))
    }
}
