//! Flow through the conflict graph: source -> near cells -> conflicts, without limit -> far cells -> sink.
//!
//! Flow goes first where there is room. Then trees grow through the residual graph, one from each cell that still has supply, all at once
//! and breadth first, each far cell in one tree alone; where a tree comes to demand, flow goes along its branch at once, and a tree whose root
//! has no supply left grows no further (Azad, Buluc and Pothen 2017, there for matchings). That is repeated until no tree finds demand:
//! what they then hold is the source's side of a minimum cut, the smallest there is. Forward edges never fill up, and of flows only those that
//! are not 0 are stored: rows of the graph are read as they are, none is written.

use super::bits::Bits;
use super::conflict::Conflicts;
use crate::Result;
use crate::error::{try_reserve, try_vec};
use crate::progress::Progress;

/// No cell, no inflow; of near cells, in no tree.
const NONE: u32 = u32::MAX;

/// Of near cells that are the root of a tree.
const ROOT: u32 = u32::MAX - 1;

/// What flows into a far cell from a near one.
#[derive(Debug, Clone, Copy)]
struct Inflow {
    from: u32,
    to: u32,
    next: u32,
    amount: u64,
}

/// Flow, greatest once it is solved. The near side has the rows.
pub(super) struct Flow<'a> {
    conflicts: &'a Conflicts,
    /// What could still leave a near cell, or reach the sink from a far one.
    supply: Vec<u64>,
    demand: Vec<u64>,
    /// First of a far cell's inflows.
    first: Vec<u32>,
    inflows: Vec<Inflow>,
    /// First of the inflows that are free for use.
    free: u32,
    /// The inflow by which a near cell's tree came to it, ROOT or NONE.
    came_by: Vec<u32>,
    root: Vec<u32>,
    /// The near cell from which a far cell's tree came to it.
    parent: Vec<u32>,
    flow: u64,
}

impl<'a> Flow<'a> {
    /// None yet, among the cells `near` and `far`, with what each may pass on, [n] of all.
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
            first: try_vec(demand.len(), NONE, "the cut")?,
            inflows: Vec::new(),
            free: NONE,
            came_by: try_vec(supply.len(), NONE, "the cut")?,
            root: try_vec(supply.len(), NONE, "the cut")?,
            parent: try_vec(demand.len(), NONE, "the cut")?,
            flow: 0,
        })
    }

    /// The greatest flow. The near cells that supply still reaches, the far ones among `far` that it does not, and how often trees grew.
    pub fn solve(&mut self, near: &Bits, far: &Bits, progress: &mut Progress<'_>) -> Result<(Bits, Bits, usize)> {
        self.fill()?;
        let (mut n_grown, mut left) = (0, far.clone());
        while self.grow(&mut left)? {
            progress.tell(1.0 - 1.0 / (n_grown as f64 + 2.0), "cut")?;
            left.clone_from(far);
            n_grown += 1;
        }
        let mut reached = near.clone();
        near.iter().filter(|&i| self.came_by[i] == NONE).for_each(|i| reached.remove(i));
        Ok((reached, left, n_grown))
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

    /// Calls `take` for each near cell from which something flows into far cell `j`.
    pub fn each_inflow(&self, j: usize, mut take: impl FnMut(usize)) {
        let mut k = self.first[j];
        while k != NONE {
            let Inflow { from, next, amount, .. } = self.inflows[k as usize];
            if amount > 0 {
                take(from as usize);
            }
            k = next;
        }
    }

    /// The far cells that near cells flow into: where each near cell's begin, and they.
    pub fn outflows(&self) -> Result<(Vec<u32>, Vec<u32>)> {
        let n = self.supply.len();
        let used = || self.inflows.iter().filter(|f| f.amount > 0);
        let mut begins: Vec<u32> = try_vec(n + 1, 0, "the cut's flows")?;
        used().for_each(|f| begins[f.from as usize + 1] += 1);
        (0..n).for_each(|i| begins[i + 1] += begins[i]);
        let mut ends: Vec<u32> = try_vec(begins[n] as usize, 0, "the cut's flows")?;
        let mut at = begins.clone();
        for f in used() {
            ends[at[f.from as usize] as usize] = f.to;
            at[f.from as usize] += 1;
        }
        Ok((begins, ends))
    }

    /// Lets flow what can without taking any back: from the cells with the fewest conflicts on, each to those of the fewest. That comes within
    /// a percent of the whole flow, where flow to the first cells with room would leave a tenth to be found by trees.
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
                self.add_inflow(j, i, amount)?;
                if self.demand[j] == 0 {
                    open.remove(j);
                }
            }
        }
        Ok(())
    }

    fn add_inflow(&mut self, j: usize, i: usize, amount: u64) -> Result<()> {
        let inflow = Inflow { from: i as u32, to: j as u32, next: self.first[j], amount };
        if self.free == NONE {
            try_reserve(&mut self.inflows, 1, "the cut's flows")?;
            self.first[j] = self.inflows.len() as u32;
            self.inflows.push(inflow);
        } else {
            let k = self.free;
            self.free = self.inflows[k as usize].next;
            self.first[j] = k;
            self.inflows[k as usize] = inflow;
        }
        Ok(())
    }

    /// Grows trees until none can grow, and lets flow along branches that come to demand; whether any did. Takes out of `unseen` what the
    /// trees hold.
    fn grow(&mut self, unseen: &mut Bits) -> Result<bool> {
        self.came_by.fill(NONE);
        let mut queue: Vec<u32> = (0..self.supply.len() as u32).filter(|&i| self.supply[i as usize] > 0).collect();
        for &i in &queue {
            self.came_by[i as usize] = ROOT;
            self.root[i as usize] = i;
        }
        let (mut head, mut met) = (0, false);
        let conflicts = self.conflicts;
        while let Some(&i) = queue.get(head) {
            head += 1;
            let root = self.root[i as usize];
            for run in conflicts.rows().iter(i as usize) {
                if self.supply[root as usize] == 0 {
                    break;
                }
                while let Some(j) = unseen.first_in(run.clone()) {
                    unseen.remove(j);
                    self.parent[j] = i;
                    if self.demand[j] > 0 {
                        met |= self.push_along_branch(j, root as usize)?;
                    }
                    self.branch_out(j, root, &mut queue)?;
                }
            }
        }
        Ok(met)
    }

    /// Goes on from far cell `j` to the near ones that flow into it, and drops inflows that are 0.
    fn branch_out(&mut self, j: usize, root: u32, queue: &mut Vec<u32>) -> Result<()> {
        let (mut k, mut before) = (self.first[j], NONE);
        while k != NONE {
            let Inflow { from, next, amount, .. } = self.inflows[k as usize];
            if amount == 0 {
                if before == NONE {
                    self.first[j] = next;
                } else {
                    self.inflows[before as usize].next = next;
                }
                self.inflows[k as usize].next = self.free;
                self.free = k;
            } else {
                if self.came_by[from as usize] == NONE {
                    self.came_by[from as usize] = k;
                    self.root[from as usize] = root;
                    try_reserve(queue, 1, "the cut")?;
                    queue.push(from);
                }
                before = k;
            }
            k = next;
        }
        Ok(())
    }

    /// Lets flow from `root` along its branch to `end`, unless an inflow that it takes back is used up by now; whether it did.
    fn push_along_branch(&mut self, end: usize, root: usize) -> Result<bool> {
        let mut amount = self.supply[root].min(self.demand[end]);
        let mut i = self.parent[end] as usize;
        while self.came_by[i] != ROOT {
            let inflow = self.inflows[self.came_by[i] as usize];
            amount = amount.min(inflow.amount);
            i = self.parent[inflow.to as usize] as usize;
        }
        if amount == 0 {
            return Ok(false);
        }
        self.supply[root] -= amount;
        self.demand[end] -= amount;
        self.flow += amount;
        let mut j = end;
        loop {
            let i = self.parent[j] as usize;
            self.add_inflow(j, i, amount)?;
            if self.came_by[i] == ROOT {
                return Ok(true);
            }
            let inflow = &mut self.inflows[self.came_by[i] as usize];
            inflow.amount -= amount;
            j = inflow.to as usize;
        }
    }
}
