//! Flow through the conflict graph: source -> near cells -> conflicts, without limit -> far cells -> sink.
//!
//! Flow goes first where there is room. Then what demand is left is moved about until it meets supply (push and relabel, Goldberg and Tarjan
//! 1988): a far cell with demand takes flow from its nearest near cell, supply if that has any, else what the near cell gives to another far cell,
//! which now has the demand. Near is by label: a lower bound of how many such moves supply is away. Labels are made exact again and again, breadth
//! first from all supply; when no demand has a finite one, the flow is the greatest, and what supply reaches is the source's side of a minimum
//! cut, the smallest there is. Forward edges never fill up, and of flows only those that are not 0 are stored: the graph is read as it is, by rows
//! and by columns, and never written.

use super::bits::Bits;
use super::conflict::Conflicts;
use crate::Result;
use crate::error::{try_reserve, try_vec};
use crate::progress::Progress;
use std::collections::VecDeque;

/// No cell, no way, no label.
const NONE: u32 = u32::MAX;

/// What flows from a near cell into a far one, in the lists of both.
#[derive(Debug, Clone, Copy)]
struct Way {
    from: u32,
    to: u32,
    next_in: u32,
    next_out: u32,
    amount: u64,
}

/// Flow, greatest once it is solved. The near side has the rows.
pub(super) struct Flow<'a> {
    conflicts: &'a Conflicts,
    /// What could still leave a near cell, or reach the sink from a far one.
    supply: Vec<u64>,
    demand: Vec<u64>,
    ways: Vec<Way>,
    /// First of a far cell's ways, and of a near one's.
    first_in: Vec<u32>,
    first_out: Vec<u32>,
    /// Labels: 0 for near cells with supply, odd ones for far cells.
    near_label: Vec<u32>,
    far_label: Vec<u32>,
    flow: u64,
}

impl<'a> Flow<'a> {
    /// None yet, among the cells `near` and `far`, with what each may pass on, `[n]` of all.
    pub fn new(conflicts: &'a Conflicts, near: &Bits, supply: &[u64], far: &Bits, demand: &[u64]) -> Result<Self> {
        let of = |room: &Bits, weights: &[u64]| -> Result<Vec<u64>> {
            let mut vec = try_vec(weights.len(), 0, "the cut")?;
            room.iter().for_each(|i| vec[i] = weights[i]);
            Ok(vec)
        };
        Ok(Flow {
            conflicts,
            supply: of(near, supply)?,
            demand: of(far, demand)?,
            ways: Vec::new(),
            first_in: try_vec(demand.len(), NONE, "the cut")?,
            first_out: try_vec(supply.len(), NONE, "the cut")?,
            near_label: try_vec(supply.len(), NONE, "the cut")?,
            far_label: try_vec(demand.len(), NONE, "the cut")?,
            flow: 0,
        })
    }

    /// The greatest flow. The near cells that supply still reaches, the far ones among `far` that it does not, and how often labels were made.
    pub fn solve(&mut self, near: &Bits, far: &Bits, progress: &mut Progress<'_>) -> Result<(Bits, Bits, usize)> {
        self.fill()?;
        let mut n_labelled = 0;
        loop {
            progress.tell(1.0 - 1.0 / (n_labelled as f64 + 2.0), "cut")?;
            let left = self.label(far)?;
            n_labelled += 1;
            if !self.move_demand()? {
                let mut reached = near.clone();
                near.iter().filter(|&i| self.near_label[i] == NONE).for_each(|i| reached.remove(i));
                return Ok((reached, left, n_labelled));
            }
        }
    }

    /// How much flows.
    pub fn amount(&self) -> u64 {
        self.flow
    }

    /// The graph.
    pub fn conflicts(&self) -> &'a Conflicts {
        self.conflicts
    }

    /// Whether a far cell could take more.
    pub fn has_demand(&self, j: usize) -> bool {
        self.demand[j] > 0
    }

    /// The first of a far cell's ways that are not 0 from `k` on, and its near cell; `None` begins with the first of all.
    pub fn next_inflow(&self, j: usize, k: Option<u32>) -> Option<(u32, usize)> {
        let mut k = k.map_or(self.first_in[j], |k| self.ways[k as usize].next_in);
        while k != NONE {
            let Way { from, next_in, amount, .. } = self.ways[k as usize];
            if amount > 0 {
                return Some((k, from as usize));
            }
            k = next_in;
        }
        None
    }

    /// Calls `take` for the far cells that near cell `i` flows into.
    pub fn each_outflow(&self, i: usize, mut take: impl FnMut(usize)) {
        let mut k = self.first_out[i];
        while k != NONE {
            let Way { to, next_out, amount, .. } = self.ways[k as usize];
            if amount > 0 {
                take(to as usize);
            }
            k = next_out;
        }
    }

    /// Lets flow what can without taking any back: from the cells with the fewest conflicts on, each to those of the fewest. That comes within
    /// a percent of the whole flow, where flow to the first cells with room would leave a tenth to be moved about.
    fn fill(&mut self) -> Result<()> {
        let rows = self.conflicts.rows();
        let mut open = Bits::of(self.demand.len(), |j| self.demand[j] > 0)?;
        // Far cells' conflicts are counted by where runs begin and end; sums make counts of that.
        let mut far_degree: Vec<u32> = try_vec(self.demand.len() + 1, 0, "the cut")?;
        let mut order: Vec<(u32, u32)> = Vec::new();
        for i in (0..self.supply.len()).filter(|&i| self.supply[i] > 0 && !rows.is_empty(i)) {
            let mut degree = 0;
            for run in rows.iter(i) {
                degree += run.len() as u32;
                far_degree[run.start] = far_degree[run.start].wrapping_add(1);
                far_degree[run.end] = far_degree[run.end].wrapping_sub(1);
            }
            try_reserve(&mut order, 1, "the cut")?;
            order.push((degree, i as u32));
        }
        (0..self.demand.len()).for_each(|j| far_degree[j + 1] = far_degree[j + 1].wrapping_add(far_degree[j]));
        order.sort_unstable();
        for i in order.into_iter().map(|(_, i)| i as usize) {
            while self.supply[i] > 0 {
                let mut least = (u32::MAX, usize::MAX);
                for run in rows.iter(i) {
                    open.each_in(run, |j| least = least.min((far_degree[j], j)));
                }
                let (_, j) = least;
                if j == usize::MAX {
                    break;
                }
                let amount = self.supply[i].min(self.demand[j]);
                self.supply[i] -= amount;
                self.demand[j] -= amount;
                self.flow += amount;
                self.add_way(i, j, amount)?;
                if self.demand[j] == 0 {
                    open.remove(j);
                }
            }
        }
        Ok(())
    }

    /// Lets more flow from near cell `i` to far cell `j`.
    fn add_way(&mut self, i: usize, j: usize, amount: u64) -> Result<()> {
        // The way may be there: near cells have few.
        let mut k = self.first_out[i];
        while k != NONE {
            let way = &mut self.ways[k as usize];
            if way.to as usize == j {
                way.amount += amount;
                return Ok(());
            }
            k = way.next_out;
        }
        try_reserve(&mut self.ways, 1, "the cut's flows")?;
        let new = self.ways.len() as u32;
        let (next_in, next_out) = (self.first_in[j], self.first_out[i]);
        self.ways.push(Way { from: i as u32, to: j as u32, next_in, next_out, amount });
        (self.first_in[j], self.first_out[i]) = (new, new);
        Ok(())
    }

    /// Takes ways that are 0 out of all lists.
    fn drop_empty(&mut self) {
        self.ways.retain(|way| way.amount > 0);
        self.first_in.fill(NONE);
        self.first_out.fill(NONE);
        for (k, way) in self.ways.iter_mut().enumerate() {
            way.next_in = std::mem::replace(&mut self.first_in[way.to as usize], k as u32);
            way.next_out = std::mem::replace(&mut self.first_out[way.from as usize], k as u32);
        }
    }

    /// Makes all labels exact; the cells among `far` that supply does not reach.
    fn label(&mut self, far: &Bits) -> Result<Bits> {
        self.drop_empty();
        self.near_label.fill(NONE);
        self.far_label.fill(NONE);
        let mut unseen = far.clone();
        let mut queue: Vec<u32> = (0..self.supply.len() as u32).filter(|&i| self.supply[i as usize] > 0).collect();
        queue.iter().for_each(|&i| self.near_label[i as usize] = 0);
        let (mut head, rows) = (0, self.conflicts.rows());
        while let Some(&i) = queue.get(head) {
            head += 1;
            let label = self.near_label[i as usize] + 1;
            for run in rows.iter(i as usize) {
                while let Some(j) = unseen.first_in(run.clone()) {
                    unseen.remove(j);
                    self.far_label[j] = label;
                    let mut k = self.first_in[j];
                    while k != NONE {
                        let Way { from, next_in, .. } = self.ways[k as usize];
                        if self.near_label[from as usize] == NONE {
                            self.near_label[from as usize] = label + 1;
                            try_reserve(&mut queue, 1, "the cut")?;
                            queue.push(from);
                        }
                        k = next_in;
                    }
                }
            }
        }
        Ok(unseen)
    }

    /// Moves demand towards supply until none is left that could come there, or so much has been done that labels should be made anew. Whether
    /// there was anything to do.
    fn move_demand(&mut self) -> Result<bool> {
        let mut queue: VecDeque<u32> = (0..self.demand.len() as u32)
            .filter(|&j| self.demand[j as usize] > 0 && self.far_label[j as usize] != NONE)
            .collect();
        if queue.is_empty() {
            return Ok(false);
        }
        // How many far cells have each label: none beyond an empty one can come to supply.
        let highest = self.far_label.iter().filter(|&&l| l != NONE).max().map_or(0, |&l| l as usize);
        let mut count = try_vec(highest + 2, 0_u32, "the cut")?;
        self.far_label.iter().filter(|&&l| l != NONE).for_each(|&l| count[l as usize] += 1);
        let mut waits = Bits::none(self.demand.len())?;
        queue.iter().for_each(|&j| waits.insert(j as usize));
        // About as much as making labels takes.
        let mut work = (4 * (self.supply.len() + self.demand.len())).max(1000) as i64;
        while let Some(j) = queue.pop_front() {
            let j = j as usize;
            waits.remove(j);
            while self.demand[j] > 0 && self.far_label[j] != NONE {
                work -= self.meet(j, &mut waits, &mut queue)? as i64;
                if self.demand[j] == 0 {
                    break;
                }
                // No near cell is one label below any more.
                let (old, new) = (self.far_label[j] as usize, self.lowest_label(j));
                work -= 8;
                count[old] -= 1;
                let cut_off = count[old] == 0 || new as usize > highest;
                self.far_label[j] = if cut_off { NONE } else { new };
                if !cut_off {
                    count[new as usize] += 1;
                }
                if count[old] == 0 {
                    for (j, label) in self.far_label.iter_mut().enumerate() {
                        if *label != NONE && *label as usize > old {
                            count[*label as usize] -= 1;
                            *label = NONE;
                            waits.remove(j);
                        }
                    }
                    work -= self.far_label.len() as i64 / 8;
                }
            }
            if work < 0 {
                break;
            }
        }
        Ok(true)
    }

    /// One more than the lowest label of the near cells that far cell `j` conflicts with.
    fn lowest_label(&self, j: usize) -> u32 {
        let labels = self.conflicts.columns().iter(j).flat_map(|run| &self.near_label[run]);
        labels.fold(NONE, |low, &label| low.min(label)).saturating_add(1)
    }

    /// Lets far cell `j` take flow from near cells one label below, as long as it has demand; how much was done.
    fn meet(&mut self, j: usize, waits: &mut Bits, queue: &mut VecDeque<u32>) -> Result<usize> {
        let (label, mut done) = (self.far_label[j] - 1, 0);
        for run in self.conflicts.columns().iter(j) {
            done += 1;
            for i in run {
                // A near cell gives until its label rises.
                while self.near_label[i] == label && self.demand[j] > 0 {
                    done += 4;
                    if self.supply[i] > 0 {
                        let amount = self.supply[i].min(self.demand[j]);
                        self.supply[i] -= amount;
                        self.demand[j] -= amount;
                        self.flow += amount;
                        self.add_way(i, j, amount)?;
                        if self.supply[i] > 0 {
                            break;
                        }
                    }
                    self.take_over(i, j, waits, queue)?;
                    if self.demand[j] > 0 {
                        self.near_label[i] = self.lowest_out(i);
                    }
                }
            }
            if self.demand[j] == 0 {
                break;
            }
        }
        Ok(done)
    }

    /// Lets far cell `j` have what near cell `i` gives to far cells one label below `i`, which get the demand for it.
    fn take_over(&mut self, i: usize, j: usize, waits: &mut Bits, queue: &mut VecDeque<u32>) -> Result<()> {
        let mut k = self.first_out[i];
        while k != NONE && self.demand[j] > 0 {
            let Way { to, next_out, amount, .. } = self.ways[k as usize];
            let other = to as usize;
            if amount > 0 && self.far_label[other] != NONE && self.far_label[other] + 1 == self.near_label[i] {
                let amount = amount.min(self.demand[j]);
                self.ways[k as usize].amount -= amount;
                self.demand[other] += amount;
                self.demand[j] -= amount;
                self.add_way(i, j, amount)?;
                if !waits.has(other) {
                    waits.insert(other);
                    queue.push_back(to);
                }
            }
            k = next_out;
        }
        Ok(())
    }

    /// One more than the lowest label of the far cells that near cell `i` flows into.
    fn lowest_out(&self, i: usize) -> u32 {
        let mut low = NONE;
        self.each_outflow(i, |j| low = low.min(self.far_label[j]));
        low.saturating_add(1)
    }
}
