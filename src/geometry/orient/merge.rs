//! Signs of normals, by merging clusters of points, the most sure first: greedy additive edge contraction (Keuper et al. 2015).
//!
//! Each point begins as a cluster. Two clusters whose link, the sum of the agreements between them, is the strongest of both become one,
//! the second turned where the sum is negative. A round merges all such pairs; then the links are those of the new clusters, and so on:
//! about log n rounds, each a sort of the links.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::progress::Progress;

/// Rounds in which two clusters merge where each is the other's strongest; from then on each merges with its strongest.
const MUTUAL_ROUNDS: usize = 60;

/// How strongly two clusters ask for the same sign, or, where negative, for opposite ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// a < b
    pub clusters: [u32; 2],
    /// Sum of the agreements of the pairs between them.
    pub sum: f64,
}

/// What the merging found.
pub struct Signs {
    /// +1 or -1 a point.
    pub sign: Vec<f64>,
    /// Component a point, counted from 0 in the order of their first points.
    pub component: Vec<u32>,
    /// Number of components.
    pub n_components: usize,
}

/// Signs of `n` > 1 points, joined by `links`, a pair at most once. `progress` is told of the fractions from the first to the second.
pub fn merge(n: usize, mut links: Vec<Link>, progress: &mut Progress, [from, until]: [f64; 2]) -> Result<Signs> {
    let mut sign = try_vec(n, 1.0, "the signs of the normals")?;
    let mut cluster = try_with_capacity(n, "the clusters of the points")?;
    cluster.extend(0..n as u32);
    let mut n_clusters = n;
    for round in 0.. {
        let left = (n_clusters as f64).ln() / (n as f64).ln();
        progress.tell(until - (until - from) * left, "signs")?;
        if links.is_empty() {
            break;
        }
        let taken = if round < MUTUAL_ROUNDS { Taken::Mutual } else { Taken::All };
        let roots = Roots::of(&picks(n_clusters, &links)?, &links, taken)?;
        for (sign, cluster) in sign.iter_mut().zip(&mut cluster) {
            let c = *cluster as usize;
            *sign *= roots.sign[c];
            *cluster = roots.label[c];
        }
        for link in &mut links {
            let [a, b] = link.clusters.map(|c| c as usize);
            link.sum *= roots.sign[a] * roots.sign[b];
            let (a, b) = (roots.label[a], roots.label[b]);
            link.clusters = [a.min(b), a.max(b)];
        }
        links.retain(|link| link.clusters[0] != link.clusters[1]);
        combine(&mut links);
        n_clusters = roots.n_labels;
    }
    Ok(Signs { sign, component: cluster, n_components: n_clusters })
}

/// Sums the links of each pair of clusters.
fn combine(links: &mut Vec<Link>) {
    // Equal pairs by their sums: the order of adding, and so the last bit, is then fixed.
    links.sort_unstable_by(|a, b| a.clusters.cmp(&b.clusters).then(a.sum.total_cmp(&b.sum)));
    links.dedup_by(|next, kept| {
        let same = next.clusters == kept.clusters;
        if same {
            kept.sum += next.sum;
        }
        same
    });
}

const NONE: u32 = u32::MAX;

/// The strongest link of each cluster, ties by place in the list; `NONE` for a cluster without any.
fn picks(n_clusters: usize, links: &[Link]) -> Result<Vec<u32>> {
    let mut picks = try_vec(n_clusters, NONE, "the strongest links")?;
    for (l, link) in links.iter().enumerate() {
        for c in link.clusters {
            let pick = &mut picks[c as usize];
            if *pick == NONE || link.sum.abs() > links[*pick as usize].sum.abs() {
                *pick = l as u32;
            }
        }
    }
    Ok(picks)
}

/// Which picks are merged.
#[derive(Clone, Copy, PartialEq)]
enum Taken {
    Mutual,
    All,
}

/// Where each cluster goes.
struct Roots {
    /// The merged cluster, counted from 0 in the order of first clusters.
    label: Vec<u32>,
    /// Beside its root.
    sign: Vec<f64>,
    n_labels: usize,
}

impl Roots {
    fn of(picks: &[u32], links: &[Link], taken: Taken) -> Result<Self> {
        let n = picks.len();
        // The cluster that each follows, itself for a root, and the sign beside it.
        let mut parent = try_with_capacity(n, "the merged clusters")?;
        parent.extend(0..n as u32);
        let mut sign = try_vec(n, 1.0, "the signs of the clusters")?;
        for (c, &pick) in picks.iter().enumerate().filter(|(_, pick)| **pick != NONE) {
            let Link { clusters: [a, b], sum } = links[pick as usize];
            let other = if a as usize == c { b } else { a };
            let mutual = picks[other as usize] == pick;
            // Of a mutual pair the first is the root; all other picks lead to ever stronger links, so never back.
            let follows = if mutual { (other as usize) < c } else { taken == Taken::All };
            if follows {
                parent[c] = other;
                sign[c] = if sum < 0.0 { -1.0 } else { 1.0 };
            }
        }
        follow_to_roots(&mut parent, &mut sign);
        let mut label = try_vec(n, NONE, "the labels of the clusters")?;
        let mut n_labels = 0;
        for c in 0..n {
            let root = parent[c] as usize;
            if label[root] == NONE {
                label[root] = n_labels as u32;
                n_labels += 1;
            }
            label[c] = label[root];
        }
        Ok(Roots { label, sign, n_labels })
    }
}

/// Lets each cluster follow its root itself, with the sign beside that.
fn follow_to_roots(parent: &mut [u32], sign: &mut [f64]) {
    let mut path = Vec::new();
    for c in 0..parent.len() {
        let mut at = c;
        while parent[at] as usize != at {
            path.push(at);
            at = parent[at] as usize;
        }
        // From the root back.
        let mut beside = 1.0;
        while let Some(on_path) = path.pop() {
            beside *= sign[on_path];
            (parent[on_path], sign[on_path]) = (at as u32, beside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::random::SplitMix64;
    use super::*;

    fn link(a: u32, b: u32, sum: f64) -> Link {
        Link { clusters: [a, b], sum }
    }

    #[test]
    fn many_links_outweigh_a_strong_one_that_errs() {
        // Two squares, three links between them: a spanning tree would take the strongest and turn one.
        let square = |first: u32| [[0, 1], [1, 2], [2, 3], [0, 3]].map(|[a, b]| link(first + a, first + b, 1.0));
        let mut links = [square(0), square(4)].concat();
        links.extend([link(0, 4, -0.9), link(1, 5, 0.5), link(2, 6, 0.6)]);
        let signs = merge(8, links, &mut Progress::silent(), [0.0, 1.0]).unwrap();
        assert_eq!((signs.n_components, signs.sign), (1, vec![1.0; 8]));
    }

    #[test]
    fn signs_that_links_agree_on_are_recovered() {
        let n = 200u32;
        let mut random = SplitMix64::new(3);
        let truth: Vec<f64> = (0..n).map(|_| if random.unit() < 0.5 { -1.0 } else { 1.0 }).collect();
        let pairs = (0..n).flat_map(|i| [1, 2, 7].map(|step| [i.min((i + step) % n), i.max((i + step) % n)]));
        let both = |[i, j]: [u32; 2]| truth[i as usize] * truth[j as usize];
        let links = pairs.map(|pair| Link { clusters: pair, sum: both(pair) * random.unit() }).collect();
        let signs = merge(n as usize, links, &mut Progress::silent(), [0.0, 1.0]).unwrap();
        assert_eq!(signs.n_components, 1);
        assert!(signs.sign.iter().zip(&truth).all(|(s, t)| s * t == signs.sign[0] * truth[0]));
    }

    #[test]
    fn parts_without_links_between_them_stay_apart() {
        let links = vec![link(0, 2, -1.0), link(1, 4, 0.5), link(2, 3, 1.0), link(1, 5, 0.0)];
        let signs = merge(6, links, &mut Progress::silent(), [0.0, 1.0]).unwrap();
        assert_eq!((signs.n_components, &signs.component[..]), (2, &[0, 1, 0, 0, 1, 1][..]));
        assert_eq!(signs.sign[2], -signs.sign[0]);
        assert_eq!((signs.sign[3], signs.sign[4], signs.sign[5]), (signs.sign[2], signs.sign[1], signs.sign[1]));
    }

    #[test]
    fn a_chain_of_ever_stronger_links_ends() {
        let n = 500;
        let links = (1..n).map(|i| link(i - 1, i, -f64::from(i))).collect();
        let signs = merge(n as usize, links, &mut Progress::silent(), [0.0, 1.0]).unwrap();
        assert_eq!(signs.n_components, 1);
        assert!(signs.sign.windows(2).all(|pair| pair[0] == -pair[1]));
    }
}
